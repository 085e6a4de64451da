// Contacts of a pack: rows in tangent coordinates, normal and friction (the round Coulomb cone) at
// once. A contact's z are its point's motions along x, y and z, so that one code serves any normal.
// docs/fast.md#contacts.
#pragma once

#include "core/fast/lane_work.h"

namespace ragdoll::fast {

/// Of the feature's point, three values per particle in `of`.
template <class R>
RAGDOLL_INLINE V3<R> atFeature(const Feature& f, const R& weight, const R* of) {
  using N = typename tree::NumberOf<R>::Type;
  const V3<R> a = load3(of + 3 * f.a);
  if (f.b < 0) return a;
  return (N(1) - weight) * a + weight * load3(of + 3 * f.b);
}

/// A unit force on the feature's point, as its link feels it.
template <class L>
RAGDOLL_INLINE V3<typename L::R> leverOf(const FastBody& b, const L& w, const Feature& f,
                                         const typename L::R& weight) {
  using R = typename L::R;
  using N = typename L::N;
  if (f.link < 0) return V3<R>{};
  V3<R> sum{};
  for (int k = 0; k < (f.b < 0 ? 1 : 2); ++k) {
    if (f.at[k] < 0) continue;
    V3<R> r;
    if (b.tree.links[f.link].kind == TreeLink::Kind::kPointer)
      r = {R{} + N(b.tree.points[f.at[k]].at[0]), R{}, R{}};
    else
      r = load3(w.tree.lever + 3 * f.at[k]);
    sum = sum + (f.b < 0 ? R{} + N(1) : k == 0 ? N(1) - weight : weight) * r;
  }
  return sum;
}

/// The three z of a row's feature, and what they answer with.
template <class L>
RAGDOLL_SECTION void setAnswer(const FastBody& b, L& w, ContactRow<typename L::R>& row,
                               bool known) {
  using R = typename L::R;
  using N = typename L::N;
  const Feature& f = *row.feature;
  const int size = static_cast<int>(f.index.size());
  if (!known) {
    row.z = w.z_next;
    w.z_next += 3 * size;
    const V3<R> r = leverOf(b, w, f, row.weight);
    const bool pointer = f.link >= 0 && b.tree.links[f.link].kind == TreeLink::Kind::kPointer;
    R* part = w.part;
    for (int c = 0; c < 3; ++c) {
      const R one = R{} + N(1);
      const V3<R> n{c == 0 ? one : R{}, c == 1 ? one : R{}, c == 2 ? one : R{}};
      tree::spread(b.tree, w.tree, f.link, pointer ? r.x * n : cross(r, n), n, 0, b.identity.data(),
                   part);
      for (const int k : f.index) w.row[3 * k + c] = part[k];
    }
    eliminate<3>(b, w, f.index.data(), size, row.z);
  }
  R xx{}, yy{}, zz{}, xy{}, xz{}, yz{};
  for (int k = 0; k < size; ++k) {
    const R* z = row.z + 3 * k;
    xx += z[0] * z[0];
    yy += z[1] * z[1];
    zz += z[2] * z[2];
    xy += z[0] * z[1];
    xz += z[0] * z[2];
    yz += z[1] * z[2];
  }
  const V3<R>& n = row.normal;
  const R own = n.x * n.x * xx + n.y * n.y * yy + n.z * n.z * zz +
                N(2) * (n.x * n.y * xy + n.x * n.z * xz + n.y * n.z * yz);
  // The tangents' 2 x 2 block: its trace and, by the adjugate, its determinant.
  const R trace = xx + yy + zz - own;
  const R determinant = n.x * n.x * (yy * zz - yz * yz) + n.y * n.y * (xx * zz - xz * xz) +
                        n.z * n.z * (xx * yy - xy * xy) +
                        N(2) * (n.x * n.y * (xz * yz - xy * zz) + n.x * n.z * (xy * yz - xz * yy) +
                                n.y * n.z * (xy * xz - yz * xx));
  const R largest =
      N(0.5) * (trace + squareRoot(atLeast(trace * trace - N(4) * determinant, N(0))));
  const auto here = less(R{}, row.inverse_normal);  // 1 where there is a contact
  row.inverse_normal = select(here, N(1) / atLeast(own, N(1e-12)), R{});
  row.inverse_tangent = select(here, N(1) / atLeast(largest, N(1e-12)), R{});
}

template <class L>
RAGDOLL_INLINE ContactRow<typename L::R>& newRow(const FastBody& b, L& w, int feature, int slot) {
  using R = typename L::R;
  w.row_of[feature * w.slots + slot] = w.contact_count;
  for (int l = 0; l < L::W; ++l) w.obstacle_of[w.contact_count * L::W + l] = -1;
  ContactRow<R>& row = w.contacts[w.contact_count++];
  row.feature = &b.features[feature];
  row.normal = {R{}, R{}, R{} + typename L::N(1)};
  row.motion = row.pull = row.base = V3<R>{};
  row.weight = row.start = row.friction = row.restitution = row.inverse_normal = R{};
  row.allowed = row.press = row.approach = R{};
  return row;
}

/// Planes that stand still, for all lanes at once. w is where the free motion leads.
template <class L>
RAGDOLL_SECTION void setPlaneRows(const FastBody& b, const PackStep& step, L& w, int feature) {
  using R = typename L::R;
  using N = typename L::N;
  const Feature& f = b.features[feature];
  if (f.link < 0 && b.tree.roots[0].pinned) return;
  for (int p = 0; p < step.plane_count; ++p) {
    const StillPlane& plane = step.planes[p];
    R offset;
    for (int l = 0; l < L::W; ++l)
      setLane(
          offset, l,
          N(plane.offset - (plane.normal[0] * w.origin[l][0] + plane.normal[1] * w.origin[l][1] +
                            plane.normal[2] * w.origin[l][2])));
    const V3<R> n = spread3<L>(plane.normal);
    const R start = dot(n, load3(w.x + 3 * f.a)) - offset - N(f.radius[0]);
    const R there = start + dot(n, load3(w.dx + 3 * f.a));
    const auto near = either(less(start, w.margin), less(there, w.margin));
    if (!any(near)) continue;
    ContactRow<R>& row = newRow(b, w, feature, p);
    row.normal = n;
    row.start = -offset - N(f.radius[0]);
    row.friction = R{} + N(plane.friction);
    row.restitution = R{} + N(plane.restitution);
    row.inverse_normal = select(near, R{} + N(1), R{});
    for (int l = 0; l < L::W; ++l) w.obstacle_of[(w.contact_count - 1) * L::W + l] = plane.obstacle;
  }
}

/// One lane's part of a row.
template <class L>
RAGDOLL_INLINE void setLaneContact(const LaneContact& c, int l, const L& w,
                                   ContactRow<typename L::R>& row, double share) {
  using N = typename L::N;
  const double* n = c.normal;
  const double offset =
      c.offset - (n[0] * w.origin[l][0] + n[1] * w.origin[l][1] + n[2] * w.origin[l][2]);
  setLane(row.normal.x, l, N(n[0]));
  setLane(row.normal.y, l, N(n[1]));
  setLane(row.normal.z, l, N(n[2]));
  setLane(row.motion.x, l, N(c.motion[0]));
  setLane(row.motion.y, l, N(c.motion[1]));
  setLane(row.motion.z, l, N(c.motion[2]));
  setLane(row.weight, l, N(c.weight));
  setLane(row.start, l, N(-offset - c.radius));
  setLane(row.friction, l, N(c.friction));
  setLane(row.restitution, l, N(c.restitution));
  setLane(row.inverse_normal, l, N(1));
  const double along = n[0] * c.impulse[0] + n[1] * c.impulse[1] + n[2] * c.impulse[2];
  if (!(along > 0)) return;  // it did not press along this normal
  setLane(row.press, l, N(share * along));
  setLane(row.pull.x, l, N(share * (c.impulse[0] - along * n[0])));
  setLane(row.pull.y, l, N(share * (c.impulse[1] - along * n[1])));
  setLane(row.pull.z, l, N(share * (c.impulse[2] - along * n[2])));
}

/// Starts rows on planes at the last step's impulses; what other contacts start at came with them.
template <class L>
RAGDOLL_INLINE void warmPlanes(const PackStep& step, const Lane* lanes, L& w) {
  using R = typename L::R;
  for (int l = 0; l < L::W; ++l)
    for (int k = 0; k < lanes[l].impulse_count; ++k) {
      const LaneImpulse& press = lanes[l].impulses[k];
      for (int p = 0; p < step.plane_count; ++p) {
        const int at = w.row_of[press.feature * w.slots + p];
        if (step.planes[p].obstacle != press.obstacle || at < 0) continue;
        ContactRow<R>& row = w.contacts[at];
        if (!(lane(row.inverse_normal, l) > 0)) continue;
        const double* n = step.planes[p].normal;
        const double* f = press.impulse;
        const double share = lanes[l].pull * step.h * step.h;
        const double along = n[0] * f[0] + n[1] * f[1] + n[2] * f[2];
        if (!(along > 0)) continue;
        setLane(row.press, l, typename L::N(share * along));
        setLane(row.pull.x, l, typename L::N(share * (f[0] - along * n[0])));
        setLane(row.pull.y, l, typename L::N(share * (f[1] - along * n[1])));
        setLane(row.pull.z, l, typename L::N(share * (f[2] - along * n[2])));
      }
    }
}

/// All rows, in the order of features, then slots, whichever lanes have them.
template <class L>
RAGDOLL_SECTION void setContacts(const FastBody& b, const PackStep& step, const Lane* lanes, L& w) {
  using R = typename L::R;
  using N = typename L::N;
  w.contact_count = 0;
  const int features = static_cast<int>(b.features.size());
  for (int i = 0; i < features * w.slots; ++i) w.row_of[i] = -1;
  for (int l = 0; l < L::W; ++l)
    for (int k = 0; k < lanes[l].contact_count; ++k)
      w.row_of[lanes[l].contacts[k].feature * w.slots + lanes[l].contacts[k].slot] = -2;
  for (int f = 0; f < features; ++f) {
    const int first = w.contact_count;
    if (f < b.particles) setPlaneRows(b, step, w, f);
    for (int slot = step.plane_count; slot < w.slots; ++slot)
      if (w.row_of[f * w.slots + slot] == -2) newRow(b, w, f, slot);
    for (int l = 0; l < L::W && w.contact_count > first; ++l)
      for (int k = 0; k < lanes[l].contact_count; ++k) {
        const LaneContact& c = lanes[l].contacts[k];
        if (c.feature != f) continue;
        const int at = w.row_of[f * w.slots + c.slot];
        setLaneContact(c, l, w, w.contacts[at], lanes[l].pull * step.h * step.h);
        w.obstacle_of[at * L::W + l] = c.obstacle;
      }
    for (int i = first; i < w.contact_count; ++i) {
      ContactRow<R>& row = w.contacts[i];
      const bool shared = f < b.particles && i > first;  // a particle's z serve all its contacts
      if (shared) row.z = w.contacts[first].z;
      setAnswer(b, w, row, shared);
    }
  }
  warmPlanes(step, lanes, w);
  for (int i = 0; i < w.contact_count; ++i) {
    ContactRow<R>& row = w.contacts[i];
    row.start += dot(row.normal, atFeature(*row.feature, row.weight, w.x));
    const R before = row.start + dot(row.normal, row.motion);
    row.allowed = N(1 - kRecovery) * select(less(before, R{}), before, R{});
    const V3<R> speed = atFeature(*row.feature, row.weight, w.v);
    row.approach = N(1 / step.h) * dot(row.normal, row.motion) - dot(row.normal, speed);
  }
}

/// Where the rows' points are at the present coordinates (w.dx).
template <class L>
RAGDOLL_SECTION void measureContacts(L& w) {
  for (int i = 0; i < w.contact_count; ++i) {
    ContactRow<typename L::R>& row = w.contacts[i];
    row.base = atFeature(*row.feature, row.weight, w.dx);
  }
}

/// y += z force.
template <class L>
RAGDOLL_INLINE void push(L& w, const ContactRow<typename L::R>& row, const V3<typename L::R>& f) {
  const int* index = row.feature->index.data();
  const int size = static_cast<int>(row.feature->index.size());
  for (int k = 0; k < size; ++k) {
    const typename L::R* z = row.z + 3 * k;
    w.y[index[k]] += z[0] * f.x + z[1] * f.y + z[2] * f.z;
  }
}

/// z . y: what the point moves by beyond the present coordinates.
template <class L>
RAGDOLL_INLINE V3<typename L::R> motionOf(const L& w, const ContactRow<typename L::R>& row) {
  const int* index = row.feature->index.data();
  const int size = static_cast<int>(row.feature->index.size());
  V3<typename L::R> sum{};
  for (int k = 0; k < size; ++k) sum = sum + w.y[index[k]] * load3(row.z + 3 * k);
  return sum;
}

template <class L>
RAGDOLL_SECTION void sweepContacts(L& w) {
  using R = typename L::R;
  using N = typename L::N;
  for (int i = 0; i < w.contact_count; ++i) {
    ContactRow<R>& row = w.contacts[i];
    const V3<R> moved = row.base + motionOf(w, row);
    const R gap = row.start + dot(row.normal, moved) - row.allowed;
    const R press = larger(row.press - gap * row.inverse_normal, R{});
    if (!any(either(less(R{}, press), less(R{}, row.press)))) continue;  // nothing changes
    V3<R> slip = moved - row.motion;
    slip = slip - dot(row.normal, slip) * row.normal;
    const V3<R> wanted = row.pull - row.inverse_tangent * slip;
    const R size2 = dot(wanted, wanted), most = row.friction * press;
    const R share = most / squareRoot(atLeast(size2, N(1e-30)));
    const V3<R> pull = select(less(share, R{} + N(1)), share, R{} + N(1)) * wanted;
    push(w, row, (press - row.press) * row.normal + (pull - row.pull));
    row.press = press;
    row.pull = pull;
  }
}

}  // namespace ragdoll::fast
