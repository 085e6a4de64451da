#include "core/relaxation/projection.h"

#include <algorithm>
#include <cmath>

#include "core/direct/constants.h"
#include "core/direct/penetration.h"

namespace ragdoll {
void ContactProjection::addResponse(const Model& model, int ragdoll, const Contact& c) {
  const Ragdoll& r = model.ragdolls[ragdoll];
  const System& s = model.systemOf(r);
  const int n = model.skeletonOf(r).size();
  const auto mine = [&](int k) { return c.particle[k] >= r.first && c.particle[k] < r.first + n; };
  if (s.lumped) {
    for (int k = 0; k < c.count; ++k) {
      const int i = c.particle[k] - r.first;
      if (mine(k)) responses_.push_back({c.particle[k], c.weight[k] * s.W(i, i)});
    }
    return;
  }
  for (int j = 0; j < n; ++j) {
    double weight = 0;
    for (int k = 0; k < c.count; ++k)
      if (mine(k)) weight += c.weight[k] * s.W(c.particle[k] - r.first, j);
    responses_.push_back({r.first + j, weight});
  }
}

void ContactProjection::prepare(const Model& model, const std::vector<Contact>& contacts,
                                const Points& x0, const Points& x1, const Points& v1, double h) {
  contacts_.clear();
  responses_.clear();
  for (const Contact& c : contacts) {
    ProjectedContact p;
    p.contact = c;
    p.begin = static_cast<int>(responses_.size());
    if (c.moves[0]) addResponse(model, c.ragdoll, c);
    if (c.other >= 0 && c.moves[1]) addResponse(model, c.other, c);
    p.end = static_cast<int>(responses_.size());
    for (int e = p.begin; e < p.end; ++e)
      for (int k = 0; k < c.count; ++k)
        if (responses_[e].column == c.particle[k]) p.w += c.weight[k] * responses_[e].weight;
    if (!(p.w > 0)) continue;  // all pinned: nothing to move
    if (c.gap_start < 0) p.contact.offset -= std::max(0.0, -c.gap_start - recoverySpeed(c) * h);

    const Vec3& n = c.normal;
    const double gap = n.dot(c.of(x1)) - c.offset;
    const double gravity = -n.dot(model.gravity);
    const double speed = -n.dot(c.of(v1) - c.surface_motion / h);
    double free_share = 0;  // of the step, before it touches
    if (c.restitution > 0 && gap < 0 && c.gap_start > gap &&
        speed > kRestSteps * std::max(gravity, 0.0) * h) {
      const double before = std::clamp(c.gap_start / (c.gap_start - gap), 0.0, 1.0);  // share of h
      const double out = c.restitution * speed - (1 + c.restitution) * gravity * (1 - before) * h;
      free_share = before;
      p.contact.offset += c.restitution * -gap;
      p.bounce_speed = std::max(0.0, out) + n.dot(c.surface_motion) / h;
    }
    p.inverse_w = 1 / p.w;
    p.held = c.of(x0) + c.surface_motion;
    p.held += free_share * (c.of(x1) - p.held);
    contacts_.push_back(p);
  }
}

void ContactProjection::apply(const ProjectedContact& p, const Vec3& impulse, Points& x) const {
  for (int e = p.begin; e < p.end; ++e)
    x.col(responses_[e].column) += responses_[e].weight * impulse;
}

Vec3 ContactProjection::impulse(ProjectedContact& p, const Vec3& point) const {
  const Vec3& n = p.contact.normal;
  const double gap = n.dot(point) - p.contact.offset;
  const double lambda_n = std::max(0.0, p.lambda_n - gap * p.inverse_w);
  Vec3 out = (lambda_n - p.lambda_n) * n;
  p.lambda_n = lambda_n;
  if (!(p.contact.friction > 0)) return out;
  const Vec3 slip = point - p.held;
  Vec3 lambda_t = p.lambda_t - p.inverse_w * (slip - n.dot(slip) * n);
  const double limit = p.contact.friction * lambda_n, size2 = lambda_t.squaredNorm();
  if (size2 > limit * limit) lambda_t *= limit / std::sqrt(size2);
  out += lambda_t - p.lambda_t;
  p.lambda_t = lambda_t;
  return out;
}

void ContactProjection::sweep(Points& x) {
  for (ProjectedContact& p : contacts_) {
    const Contact& c = p.contact;
    if (p.end - p.begin == 1) {  // a particle with a mass of its own: most contacts
      auto position = x.col(c.particle[0]);
      if (p.lambda_n == 0 && c.normal.dot(position) >= c.offset) continue;
      position += responses_[p.begin].weight * impulse(p, position);
    } else {
      const Vec3 point = c.of(x);
      if (p.lambda_n == 0 && c.normal.dot(point) >= c.offset) continue;
      apply(p, impulse(p, point), x);
    }
  }
}

void ContactProjection::bounce(double h, Points& v) const {
  for (const ProjectedContact& p : contacts_) {
    if (p.bounce_speed <= 0 || p.lambda_n <= 0) continue;
    const Vec3 &n = p.contact.normal, velocity = p.contact.of(v);
    const double impact = (p.bounce_speed - n.dot(velocity)) / p.w;  // [N s] beside the sweeps'
    Vec3 impulse = impact * n;
    if (p.contact.friction > 0) {
      // Those of the sweeps grow with the part of the step beyond the contact, as the way does.
      const Vec3 slip = velocity - p.contact.surface_motion / h, given = p.lambda_t / h;
      Vec3 friction = given - p.inverse_w * (slip - n.dot(slip) * n);
      const double most = p.contact.friction * std::max(0.0, p.lambda_n / h + impact);
      if (friction.squaredNorm() > most * most) friction *= most / friction.norm();
      impulse += friction - given;
    }
    apply(p, impulse, v);
  }
}

void ContactProjection::markPressed(Supports& supports) const {
  for (const ProjectedContact& p : contacts_) {
    if (p.lambda_n <= 0) continue;
    const Contact& c = p.contact;
    const bool grips = isInsideCone(c.friction, p.lambda_n, p.lambda_t.norm());
    if (c.obstacle >= 0) supports.pressed[c.ragdoll] = 1;
    if (c.obstacle >= 0 && grips) supports.gripped[c.ragdoll] = 1;
    if (c.other >= 0) supports.pressing.push_back({c.ragdoll, c.other, grips});
  }
}

void ContactProjection::addPairForces(int first, int n, double h, Points& force) const {
  for (const ProjectedContact& p : contacts_) {
    if (p.contact.other < 0 || p.lambda_n <= 0) continue;
    const Vec3 pressed = (p.lambda_n * p.contact.normal + p.lambda_t) / (h * h);
    for (int k = 0; k < p.contact.count; ++k) {
      const int column = p.contact.particle[k];
      if (column >= first && column < first + n) force.col(column) += p.contact.weight[k] * pressed;
    }
  }
}

int ContactProjection::pressing() const {
  return static_cast<int>(std::count_if(contacts_.begin(), contacts_.end(),
                                        [](const ProjectedContact& p) { return p.lambda_n > 0; }));
}

}  // namespace ragdoll
