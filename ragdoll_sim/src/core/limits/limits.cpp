#include "ragdoll_sim/core/limits.h"

#include <algorithm>
#include <cmath>

#include "core/limits/limit_value.h"
#include "ragdoll_sim/core/direction.h"
#include "ragdoll_sim/core/plane_limits.h"

namespace ragdoll {
namespace {

constexpr double kPole = 1e-9;  ///< [-] sine below which an angle has no direction to grow in

/// Square to d: what stands for the missing direction at a pole.
Vec3 anySquare(const Vec3& d) {
  int least;
  d.cwiseAbs().minCoeff(&least);
  return d.cross(Vec3::Unit(least)).normalized();
}

const double* bodyOf(const Model& model, const Points& x, int ragdoll) {
  return x.data() + 3 * model.ragdolls[ragdoll].first;
}

/// C = angle - angle(r, w); its derivatives are unit vectors square to r and w.
void fillWithin(double angle, const Direction& reference, const Direction& child, const Vec3& r,
                const Vec3& w, const double* x, int first, LimitRow& row) {
  const double cosine = r.dot(w);
  const double sine = r.cross(w).norm();
  row.value = angle - std::atan2(sine, cosine);
  Vec3 on_w, on_r;
  if (sine > kPole) {
    on_w = (r - cosine * w) / sine;
    on_r = (w - cosine * r) / sine;
  } else {
    on_r = anySquare(r);
    on_w = cosine < 0 ? on_r : Vec3(-on_r);
  }
  addGradient(child, on_w, x, first, row);
  addGradient(reference, on_r, x, first, row);
}

/// C = (angle - |phi|) r, with w . reference = r cos phi, w . normal = r sin phi.
void fillTurn(const Limit& limit, const Vec3& z, const Vec3& w, const double* x, int first,
              LimitRow& row) {
  const Vec3 n = valueOf(limit.normal, x);
  const double c = w.dot(z), s = w.dot(n);
  const double r = std::max(std::hypot(c, s), kPole);
  const double phi = std::atan2(s, c), side = phi < 0 ? -1 : 1;
  const double room = limit.angle - std::abs(phi);
  row.value = room * r;
  const double on_c = (room * c + side * s) / r, on_s = (room * s - side * c) / r;
  addGradient(limit.child, on_c * z + on_s * n, x, first, row);
  addGradient(limit.reference, on_c * w, x, first, row);
  addGradient(limit.normal, on_s * w, x, first, row);
}

/// Of kWedge: sin C = w . n, with n the pole of the nearer border on the inside; along it from the
/// forbidden wedge's tip on: r, the sine of the angle to the axis.
struct Wedge {
  double sine = 0, on_c = 0, on_s = 0;  ///< and its derivatives with respect to c and s
};

int nearerSide(double s) { return s < 0 ? -1 : 1; }

/// How far along the border of a side, from the tip on.
double alongBorder(const Limit& limit, double c, double s, int side) {
  return limit.cos_angle * c + limit.sin_angle * side * s;
}

/// border: as LimitRow::border.
Wedge wedgeOf(const Limit& limit, double c, double s, int border) {
  const int side = border != 0 ? border : nearerSide(s);
  const double across = limit.sin_angle * c - limit.cos_angle * side * s;
  const double r = std::hypot(c, s);
  if (border != 0 || r == 0 || alongBorder(limit, c, s, side) >= 0)
    return {across, limit.sin_angle, -limit.cos_angle * side};
  return {r, c / r, s / r};
}

/// C = asin(sine of the wedge).
void fillWedge(const Limit& limit, const Vec3& z, const Vec3& w, const double* x, int first,
               LimitRow& row) {
  const Vec3 n = valueOf(limit.normal, x);
  const Wedge wedge = wedgeOf(limit, w.dot(z), w.dot(n), row.border);
  const double cosine = std::sqrt(std::max(1 - wedge.sine * wedge.sine, kPole));
  const double on_c = wedge.on_c / cosine, on_s = wedge.on_s / cosine;
  row.value = std::asin(std::clamp(wedge.sine, -1.0, 1.0));
  addGradient(limit.child, on_c * z + on_s * n, x, first, row);
  addGradient(limit.reference, on_c * w, x, first, row);
  addGradient(limit.normal, on_s * w, x, first, row);
}

/// C = -angle(last allowed, child) outside the regions, else 0. Whoever was outside once goes all
/// the way back, but for a spring.
void fillReturn(const PlaneLimit& limit, const double* x, int first, LimitRow& row) {
  row.count = 0;
  row.value = 0;
  if (!row.returns && isAllowed(limit, childInParent(limit, x))) return;
  row.returns = limit.compliance == 0;
  const Direction reference = returnDirection(limit, row.allowed);
  fillWithin(0, reference, limit.child, valueOf(reference, x), valueOf(limit.child, x), x, first,
             row);
}

double turnValue(const Limit& limit, const Vec3& z, const Vec3& w, const double* x) {
  const double c = w.dot(z), s = w.dot(valueOf(limit.normal, x));
  return (limit.angle - std::abs(std::atan2(s, c))) * std::hypot(c, s);
}

double wedgeValue(const Limit& limit, const Vec3& z, const Vec3& w, const double* x, int border) {
  const Wedge wedge = wedgeOf(limit, w.dot(z), w.dot(valueOf(limit.normal, x)), border);
  return std::asin(std::clamp(wedge.sine, -1.0, 1.0));
}

double withinValue(const Limit& limit, const Vec3& r, const Vec3& w) {
  return limit.angle - std::atan2(r.cross(w).norm(), r.dot(w));
}

}  // namespace

void evaluateLimit(const Limit& limit, const Vec3& r, const Vec3& w, const double* x, int first,
                   LimitRow& row) {
  row.count = 0;
  if (limit.kind == Limit::Kind::kTurn) return fillTurn(limit, r, w, x, first, row);
  if (limit.kind == Limit::Kind::kWedge) return fillWedge(limit, r, w, x, first, row);
  fillWithin(limit.angle, limit.reference, limit.child, r, w, x, first, row);
}

double limitValue(const Limit& limit, const double* x) {
  return limitValue(limit, valueOf(limit.reference, x), valueOf(limit.child, x), x);
}

double limitValue(const Limit& limit, const Vec3& r, const Vec3& w, const double* x) {
  if (limit.kind == Limit::Kind::kWithin) return withinValue(limit, r, w);
  return limit.kind == Limit::Kind::kTurn ? turnValue(limit, r, w, x)
                                          : wedgeValue(limit, r, w, x, 0);
}

namespace {

struct Polar {
  double c = 0, s = 0;
};

Polar polarOf(const Limit& limit, const double* x) {
  const Vec3 w = valueOf(limit.child, x);
  return {w.dot(valueOf(limit.reference, x)), w.dot(valueOf(limit.normal, x))};
}

}  // namespace

int nearerBorder(const Limit& limit, const double* x) {
  if (limit.kind != Limit::Kind::kWedge) return 0;
  const auto [c, s] = polarOf(limit, x);
  const int side = nearerSide(s);
  return alongBorder(limit, c, s, side) >= 0 ? side : 0;
}

double limitAtBorder(const Limit& limit, const double* x, int border) {
  if (border == 0) return limitValue(limit, x);
  return wedgeValue(limit, valueOf(limit.reference, x), valueOf(limit.child, x), x, border);
}

double roomAtBorder(const Limit& limit, const double* x, int border) {
  const auto [c, s] = polarOf(limit, x);
  return std::min(alongBorder(limit, c, s, border), border * s);
}

bool isAtTip(const Limit& limit, const double* x) {
  if (limit.kind != Limit::Kind::kWedge) return false;
  const auto [c, s] = polarOf(limit, x);
  return std::hypot(c, s) < kPole;
}

void evaluateLimit(const Limit& limit, const double* x, const double* ahead, int first,
                   LimitRow& row) {
  if (row.border == 0) row.border = nearerBorder(limit, ahead);
  const double* at = row.border == 0 && isAtTip(limit, x) ? ahead : x;
  evaluateLimit(limit, valueOf(limit.reference, at), valueOf(limit.child, at), at, first, row);
}

LimitRow limitRow(const Model& model, int ragdoll, int limit) {
  const Limit& what = model.skeletonOf(model.ragdolls[ragdoll]).limits[limit];
  LimitRow row;
  row.ragdoll = ragdoll;
  row.limit = limit;
  row.joint = what.joint;
  row.compliance = what.compliance;
  row.damping = what.damping;
  return row;
}

namespace {

/// Of hinges and cones.
void findAngles(const Model& model, const Points& x, int ragdoll, double margin,
                std::vector<LimitRow>& rows) {
  const double sine = std::sin(margin), cosine = std::cos(margin);
  const std::vector<Limit>& limits = model.skeletonOf(model.ragdolls[ragdoll]).limits;
  const double* body = bodyOf(model, x, ragdoll);
  for (std::size_t k = 0; k < limits.size(); ++k) {
    const Limit& limit = limits[k];
    if (limit.region) continue;
    const Vec3 r = valueOf(limit.reference, body), w = valueOf(limit.child, body);
    double value;
    if (limit.kind == Limit::Kind::kWithin) {
      // Most are far inside, which the cosine alone shows: cos(angle(r, w)) > cos(angle - margin).
      const double far = limit.cos_angle * cosine + limit.sin_angle * sine;
      if (limit.angle > margin && r.dot(w) > far) continue;
      value = withinValue(limit, r, w);
    } else {
      value = limitValue(limit, body);
      if (value >= margin) continue;
    }
    rows.push_back(limitRow(model, ragdoll, static_cast<int>(k)));
    rows.back().value = value;
  }
}

/// Of planes, not evaluated; column: of the first in State::allowed.
void planesOf(const std::vector<PlaneLimit>& limits, int ragdoll, const State& state,
              Eigen::Index column, std::vector<LimitRow>& rows) {
  for (std::size_t k = 0; k < limits.size(); ++k) {
    rows.emplace_back();
    LimitRow& row = rows.back();
    row.ragdoll = ragdoll;
    row.limit = -1 - static_cast<int>(k);
    row.joint = limits[k].joint;
    row.compliance = limits[k].compliance;
    row.damping = limits[k].damping;
    row.allowed = state.allowed.col(column + static_cast<Eigen::Index>(k));
  }
}

}  // namespace

void listPlanes(const Model& model, const State& state, std::vector<LimitRow>& rows) {
  Eigen::Index column = 0;
  for (std::size_t i = 0; i < model.ragdolls.size(); ++i) {
    const std::vector<PlaneLimit>& limits = model.skeletonOf(model.ragdolls[i]).plane_limits;
    if (!state.asleep[i]) planesOf(limits, static_cast<int>(i), state, column, rows);
    column += static_cast<Eigen::Index>(limits.size());
  }
}

void findLimits(const Model& model, const Points& x, const State& state, double margin,
                std::vector<LimitRow>& rows) {
  rows.clear();
  for (std::size_t i = 0; i < model.ragdolls.size(); ++i)
    if (!state.asleep[i]) findAngles(model, x, static_cast<int>(i), margin, rows);
}

void evaluateLimit(const Model& model, const Points& x, LimitRow& row) {
  const Ragdoll& ragdoll = model.ragdolls[row.ragdoll];
  const Skeleton& skeleton = model.skeletonOf(ragdoll);
  const double* body = bodyOf(model, x, row.ragdoll);
  if (row.limit < 0)
    return fillReturn(skeleton.plane_limits[-1 - row.limit], body, ragdoll.first, row);
  const Limit& limit = skeleton.limits[row.limit];
  evaluateLimit(limit, valueOf(limit.reference, body), valueOf(limit.child, body), body,
                ragdoll.first, row);
}

double valueAt(const Model& model, const Points& x, const LimitRow& row) {
  if (row.limit >= 0)
    return limitValue(model.skeletonOf(model.ragdolls[row.ragdoll]).limits[row.limit],
                      bodyOf(model, x, row.ragdoll));
  LimitRow there = row;
  evaluateLimit(model, x, there);
  return there.value;
}

void startLimit(const Model& model, const Points& x, LimitRow& row) {
  if (row.compliance == 0) return;
  row.start = std::min(0.0, valueAt(model, x, row));
}

LimitRow::Softness LimitRow::eulerSoftness(double h) const {
  if (compliance == 0) return {};
  const double spring = 1 / compliance, damper = damping / h;
  return {1 / (h * h * (spring + damper)), -damper / (spring + damper) * start};
}

void keepAllowed(const Model& model, State& state) {
  Eigen::Index column = 0;
  for (std::size_t i = 0; i < model.ragdolls.size(); ++i)
    for (const PlaneLimit& limit : model.skeletonOf(model.ragdolls[i]).plane_limits) {
      const Vec3 now = childInParent(limit, bodyOf(model, state.x, static_cast<int>(i)));
      if (isAllowed(limit, now)) state.allowed.col(column) = now.normalized();
      ++column;
    }
}

Points startAllowed(const Model& model) {
  std::vector<Vec3> out;
  for (std::size_t i = 0; i < model.ragdolls.size(); ++i)
    for (const PlaneLimit& limit : model.skeletonOf(model.ragdolls[i]).plane_limits) {
      const double* body = bodyOf(model, model.start_position, static_cast<int>(i));
      const Points& rest = model.skeletonOf(model.ragdolls[i]).rest;
      const Vec3 now = childInParent(limit, body);
      out.push_back((isAllowed(limit, now) ? now : childInParent(limit, rest.data())).normalized());
    }
  Points allowed(3, out.size());
  for (std::size_t k = 0; k < out.size(); ++k) allowed.col(k) = out[k];
  return allowed;
}

double limitViolation(const Model& model, const Points& x, int ragdoll) {
  const Skeleton& skeleton = model.skeletonOf(model.ragdolls[ragdoll]);
  const double* body = bodyOf(model, x, ragdoll);
  double worst = 0;
  for (const Limit& limit : skeleton.limits)
    if (!limit.region) worst = std::max(worst, -limitValue(limit, body));
  for (const PlaneLimit& limit : skeleton.plane_limits)
    worst = std::max(worst, planeViolation(limit, body));
  return worst;
}

}  // namespace ragdoll
