// Contacts of a pack: rows in tangent coordinates, normal and friction (the round Coulomb cone) at
// once. docs/fast.md#contacts.
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
    if (f.at[k] == -1) continue;
    V3<R> r;
    if (f.at[k] == Feature::kOnAxis)
      r = N(b.tree.links[f.link].base_reach) * load3(w.tree.axes + 9 * f.link);
    else if (b.tree.links[f.link].kind == TreeLink::Kind::kPointer)
      r = {R{} + N(b.tree.points[f.at[k]].at[0]), R{}, R{}};
    else
      r = load3(w.tree.lever + 3 * f.at[k]);
    sum = sum + (f.b < 0 ? R{} + N(1) : k == 0 ? N(1) - weight : weight) * r;
  }
  return sum;
}

/// The three z of a row.
template <class L>
RAGDOLL_INLINE void setRows(const FastBody& b, L& w, ContactRow<typename L::R>& row) {
  using R = typename L::R;
  const Feature& f = *row.feature;
  R* z = w.z_next;
  row.z = z;
  w.z_next += 3 * f.row.size();
  const V3<R> r = leverOf(b, w, f, row.weight);
  const bool pointer = f.link >= 0 && b.tree.links[f.link].kind == TreeLink::Kind::kPointer;
  V3<R> l[3];
  for (int c = 0; c < 3; ++c) l[c] = pointer ? r.x * row.axes[c] : cross(r, row.axes[c]);
  R* const out[3] = {z, z + 1, z + 2};
  tree::spread<3, 3>(b.tree, w.tree, f.link, l, row.axes, 0, b.depth.data(), out);
  eliminate<3>(w, f.row, z);
}

/// What a push along a row's axes answers with: z . z.
template <class R>
struct Answer {
  R own{}, first{}, second{}, mixed{}, couple[2]{};

  /// share: 1, or -1 to take away.
  template <class N>
  RAGDOLL_INLINE void add(N share, const R* a, const R* b) {
    own += share * (a[0] * b[0]);
    first += share * (a[1] * b[1]);
    second += share * (a[2] * b[2]);
    mixed += share * (a[1] * b[2]);
    for (int c = 0; c < 2; ++c) couple[c] += share * (a[0] * b[c + 1]);
  }
};

/// The inverse of the whole block, which stops a point. A point that some push hardly moves, as one
/// on a rod that a pin holds, has none: 0.
template <class R>
RAGDOLL_INLINE void setGrip(const Answer<R>& sum, ContactRow<R>& row) {
  using N = typename tree::NumberOf<R>::Type;
  const R n = sum.own, s = sum.first, t = sum.second;
  const R ns = sum.couple[0], nt = sum.couple[1], st = sum.mixed;
  R* c = row.grip;
  c[0] = s * t - st * st;
  c[1] = nt * st - ns * t;
  c[2] = ns * st - nt * s;
  c[3] = n * t - nt * nt;
  c[4] = ns * nt - n * st;
  c[5] = n * s - ns * ns;
  const R whole = n * c[0] + ns * c[1] + nt * c[2];
  const R inverse =
      select(less(N(kHeld) * (n * s * t), whole), N(1) / atLeast(whole, N(1e-30)), R{});
  for (int k = 0; k < 6; ++k) c[k] = inverse * c[k];
}

/// The larger eigenvalue of the tangents' block.
template <class R>
RAGDOLL_INLINE void setAnswer(const Answer<R>& sum, ContactRow<R>& row) {
  using N = typename tree::NumberOf<R>::Type;
  setGrip(sum, row);
  for (int c = 0; c < 2; ++c) row.couple[c] = sum.couple[c];
  const R apart = sum.first - sum.second;
  const R largest =
      N(0.5) * (sum.first + sum.second + squareRoot(apart * apart + N(4) * sum.mixed * sum.mixed));
  row.answer_normal = sum.own;
  row.answer_tangent = largest;
}

/// The three z of a row, and what they answer with.
template <class L>
RAGDOLL_SECTION void setAnswer(const FastBody& b, L& w, ContactRow<typename L::R>& row) {
  using R = typename L::R;
  setRows(b, w, row);
  const int size = row.feature->row.size();
  const R* z = row.z;
  Answer<R> sum;
  for (int k = 0; k < size; ++k) {
    sum.own += z[3 * k] * z[3 * k];
    sum.first += z[3 * k + 1] * z[3 * k + 1];
    sum.second += z[3 * k + 2] * z[3 * k + 2];
    sum.mixed += z[3 * k + 1] * z[3 * k + 2];
    sum.couple[0] += z[3 * k] * z[3 * k + 1];
    sum.couple[1] += z[3 * k] * z[3 * k + 2];
  }
  setAnswer(sum, row);
}

template <class L>
RAGDOLL_INLINE ContactRow<typename L::R>& newRow(const FastBody& b, L& w, int feature, int slot) {
  using R = typename L::R;
  w.row_of[feature * w.slots + slot] = w.contact_count;
  for (int l = 0; l < L::W; ++l) w.obstacle_of[w.contact_count * L::W + l] = -1;
  ContactRow<R>& row = w.contacts[w.contact_count++];
  row.feature = &b.features[feature];
  row.axes[0] = {R{}, R{}, R{} + typename L::N(1)};
  row.axes[1] = row.motion = V3<R>{};  // axes[1]: the last step's impulse, until there are tangents
  row.weight = row.start = row.friction = row.restitution = row.waits = R{};
  row.inverse_normal = row.inverse_tangent = R{};
  row.z = nullptr;
  return row;
}

/// Planes that stand still, for all lanes at once. w is where the free motion leads.
template <class L>
RAGDOLL_INLINE void setPlaneRows(const FastBody& b, const PackStep& step, L& w, int feature) {
  using R = typename L::R;
  using N = typename L::N;
  const Feature& f = b.features[feature];
  const V3<R> x = load3(w.x + 3 * f.a), there = x + load3(w.dx + 3 * f.a);
  for (int p = 0; p < step.plane_count; ++p) {
    const StillPlane& plane = step.planes[p];
    const V3<R> n = spread3<L>(plane.normal);
    const R reach = w.offset[p] + N(f.radius[0]);
    const R at = dot(n, x), then = dot(n, there), nearer = select(less(at, then), at, then);
    const auto near = less(nearer - reach, w.margin);
    if (!any(near)) continue;
    if (f.link < 0 && b.tree.roots[0].pinned) continue;
    ContactRow<R>& row = newRow(b, w, feature, p);
    row.axes[0] = n;
    row.start = -reach;
    row.friction = R{} + N(plane.friction);
    row.restitution = R{} + N(plane.restitution);
    row.waits = select(near, R{} + N(1), R{});
    for (int l = 0; l < L::W; ++l) w.obstacle_of[(w.contact_count - 1) * L::W + l] = plane.obstacle;
  }
}

/// One lane's part of a row. share: of what it pressed with, [N] -> [kg m].
template <class L>
RAGDOLL_INLINE void setLaneContact(const LaneContact& c, int l, ContactRow<typename L::R>& row,
                                   double share) {
  using N = typename L::N;
  const double* n = c.normal;
  setLane(row.axes[0].x, l, N(n[0]));
  setLane(row.axes[0].y, l, N(n[1]));
  setLane(row.axes[0].z, l, N(n[2]));
  setLane(row.motion.x, l, N(c.motion[0]));
  setLane(row.motion.y, l, N(c.motion[1]));
  setLane(row.motion.z, l, N(c.motion[2]));
  setLane(row.weight, l, N(c.weight));
  setLane(row.start, l, N(-c.offset - c.radius));
  setLane(row.friction, l, N(c.friction));
  setLane(row.restitution, l, N(c.restitution));
  setLane(row.waits, l, N(1));
  setLane(row.axes[1].x, l, N(share * c.impulse[0]));
  setLane(row.axes[1].y, l, N(share * c.impulse[1]));
  setLane(row.axes[1].z, l, N(share * c.impulse[2]));
}

/// What rows on planes pressed with in the last step; that of other contacts came with them.
template <class L>
RAGDOLL_INLINE void warmPlanes(const PackStep& step, const Lane* lanes, L& w) {
  using N = typename L::N;
  for (int l = 0; l < L::W; ++l)
    for (int k = 0; k < lanes[l].impulse_count; ++k) {
      const LaneImpulse& press = lanes[l].impulses[k];
      const double share = 0.5 * lanes[l].h * lanes[l].h;
      for (int p = 0; p < step.plane_count; ++p) {
        const int at = w.row_of[press.feature * w.slots + p];
        if (step.planes[p].obstacle != press.obstacle || at < 0) continue;
        V3<typename L::R>& impulse = w.contacts[at].axes[1];
        setLane(impulse.x, l, N(share * press.impulse[0]));
        setLane(impulse.y, l, N(share * press.impulse[1]));
        setLane(impulse.z, l, N(share * press.impulse[2]));
      }
    }
}

/// Tangents, and the impulse that the row starts at: the last step's (axes[1]), where it pressed
/// along the normal.
template <class R>
RAGDOLL_INLINE void setTangents(ContactRow<R>& row) {
  const V3<R> n = row.axes[0], impulse = row.axes[1];
  tree::basis(n, row.axes[1], row.axes[2]);
  const R along = dot(n, impulse);
  const auto pressed = both(less(R{}, along), less(R{}, row.waits));
  row.press = select(pressed, along, R{});
  for (int c = 0; c < 2; ++c) row.pull[c] = select(pressed, dot(row.axes[c + 1], impulse), R{});
  row.last = row.press;
}

/// Tangents; where the row starts, and at which impulse.
template <class L>
RAGDOLL_SECTION void setStart(const L& w, ContactRow<typename L::R>& row) {
  using R = typename L::R;
  setTangents(row);
  const V3<R> n = row.axes[0];
  row.start += dot(n, atFeature(*row.feature, row.weight, w.x));
  const R moved = dot(n, row.motion), before = row.start + moved;
  row.allowed = allowedOf(before, w.opens, w.recovery);
  row.approach = w.rate * moved - dot(n, atFeature(*row.feature, row.weight, w.v));
}

/// All rows, in the order of features, then slots, whichever lanes have them.
template <class L>
RAGDOLL_SECTION void setContacts(const FastBody& b, const PackStep& step, const Lane* lanes, L& w) {
  using R = typename L::R;
  w.contact_count = w.awake_count = 0;
  const int features = static_cast<int>(b.features.size());
  w.met = less(R{}, R{});
  bool others = false;
  for (int l = 0; l < L::W; ++l) others = others || lanes[l].contact_count > 0;
  if (step.plane_count == 0 && !others) return;
  for (int i = 0; i < features * w.slots; ++i) w.row_of[i] = -1;
  for (int l = 0; l < L::W && others; ++l)
    for (int k = 0; k < lanes[l].contact_count; ++k)
      w.row_of[lanes[l].contacts[k].feature * w.slots + lanes[l].contacts[k].slot] = -2;
  for (int f = 0; f < (others ? features : b.particles); ++f) {
    if (f < b.particles) setPlaneRows(b, step, w, f);
    for (int slot = step.plane_count; slot < w.slots && others; ++slot)
      if (w.row_of[f * w.slots + slot] == -2) newRow(b, w, f, slot);
  }
  if (w.contact_count == 0) return;
  for (int l = 0; l < L::W; ++l)
    for (int k = 0; k < lanes[l].contact_count; ++k) {
      const LaneContact& c = lanes[l].contacts[k];
      const int at = w.row_of[c.feature * w.slots + c.slot];
      setLaneContact<L>(c, l, w.contacts[at], 0.5 * lanes[l].h * lanes[l].h);
      w.obstacle_of[at * L::W + l] = c.obstacle;
    }
  warmPlanes(step, lanes, w);
  for (int i = 0; i < w.contact_count; ++i) {
    ContactRow<R>& row = w.contacts[i];
    setStart(w, row);
    w.met = either(w.met, less(R{}, row.waits));
  }
}

}  // namespace ragdoll::fast
