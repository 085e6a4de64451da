#include "core/contact/pair_detect.h"

#include <algorithm>
#include <numeric>

#include "core/contact/capsule_pairs.h"
#include "core/contact/compliance.h"
#include "core/contact/constants.h"
#include "core/contact/first_touch.h"

namespace ragdoll {
namespace {

Bounds searchedBounds(const SweptCapsule& c, PairSearch search) {
  if (search.at_end) {
    const double radius = std::max(c.ra, c.rb);
    return {c.a1.cwiseMin(c.b1).array() - radius, c.a1.cwiseMax(c.b1).array() + radius};
  }
  // Each of two bodies brings half the margin and its own travel, which bounds their relative one.
  const double travel = std::max((c.a1 - c.a0).norm(), (c.b1 - c.b0).norm());
  const double pad = std::max(c.ra, c.rb) + 0.5 * search.margin + kSpeculative * travel;
  return {c.a0.cwiseMin(c.b0).cwiseMin(c.a1).cwiseMin(c.b1).array() - pad,
          c.a0.cwiseMax(c.b0).cwiseMax(c.a1).cwiseMax(c.b1).array() + pad};
}

Bounds unionOf(const std::vector<Bounds>& all, std::size_t begin, std::size_t end) {
  Bounds b = all[begin];
  for (std::size_t k = begin + 1; k < end; ++k) {
    b.lo = b.lo.cwiseMin(all[k].lo);
    b.hi = b.hi.cwiseMax(all[k].hi);
  }
  return b;
}

/// Where the contact was at the start.
void setStart(const CapsuleAxis& first, const CapsuleAxis& second, const AxisPoints& at,
              Contact& c) {
  c.runs = std::max(std::abs(at.s - c.weight[1]), std::abs(at.t + c.weight[3])) > kSamePlace;
  if (c.runs) return;
  c.start_normal = (first.at(at.s) - second.at(at.t)).normalized();
  c.start_weight = {1 - at.s, at.s, at.t - 1, -at.t};
  c.touches_at_start = c.start_normal.dot(c.normal) > kSameSide;
}

SweptCapsule swept(const Model& model, const Ragdoll& r, const Capsule& c, const Points& x0,
                   const Points& x1) {
  const int a = r.first + c.a, b = r.first + c.b;
  return {x0.col(a), x0.col(b), x1.col(a), x1.col(b), model.radius[a], model.radius[b]};
}

}  // namespace

void PairDetector::bound(const Model& model, const Body& body, const Points& x0, const Points& x1,
                         PairSearch search, std::vector<Bounds>& out) const {
  for (const Capsule& c : body.skeleton->capsules)
    out.push_back(searchedBounds(swept(model, *body.ragdoll, c, x0, x1), search));
}

void PairDetector::appendPair(const Model& model, const Body& p, int i, const Body& q, int j,
                              const Points& x0, const Points& x1, PairSearch search,
                              std::vector<Contact>& contacts) const {
  const Capsule &c = p.skeleton->capsules[i], &d = q.skeleton->capsules[j];
  const Compliance give = inSeries(giveOf(*p.ragdoll, p.skeleton->capsule_contact, i),
                                   giveOf(*q.ragdoll, q.skeleton->capsule_contact, j));
  std::array<CapsuleTouch, 2> touches;
  const SweptCapsule first = swept(model, *p.ragdoll, c, x0, x1),
                     second = swept(model, *q.ragdoll, d, x0, x1);
  const int count = search.at_end ? findOverlaps(first, second, -search.margin, touches)
                                  : findTouches(first, second, search.margin, touches);
  for (int k = 0; k < count; ++k) {
    const CapsuleTouch& touch = touches[k];
    Contact contact;
    contact.particle = {p.ragdoll->first + c.a, p.ragdoll->first + c.b, q.ragdoll->first + d.a,
                        q.ragdoll->first + d.b};
    contact.weight = {1 - touch.at.s, touch.at.s, touch.at.t - 1, -touch.at.t};
    contact.count = 4;
    contact.normal = touch.normal;
    contact.offset = touch.radii;
    contact.friction = kBodyFriction;
    contact.give = give;
    contact.ragdoll = p.index;
    contact.other = p.index == q.index ? -1 : q.index;
    contact.gap_start = touch.gap_start;
    if (touchesAtStart(give, contact.gap_start))
      setStart(first.at(0), second.at(0), touch.start, contact);
    contact.runs = contact.runs && !contact.isSoft();
    contacts.push_back(contact);
  }
}

void PairDetector::appendSelf(const Model& model, const Points& x0, const Points& x1, int ragdoll,
                              PairSearch search, std::vector<Contact>& contacts) {
  const Ragdoll& r = model.ragdolls[ragdoll];
  const Body body{ragdoll, &r, &model.skeletonOf(r)};
  own_.clear();
  bound(model, body, x0, x1, search, own_);
  for (const CapsulePair& pair : body.skeleton->self_pairs)
    if (overlap(own_[pair.first], own_[pair.second]))
      appendPair(model, body, pair.first, body, pair.second, x0, x1, search, contacts);
}

void PairDetector::appendBetween(const Model& model, const State& state, const Points& x0,
                                 const Points& x1, PairSearch search,
                                 std::vector<Contact>& contacts, const std::vector<int>* group_of) {
  all_.resize(model.ragdolls.size());
  std::iota(all_.begin(), all_.end(), 0);
  appendBetween(model, state, all_, x0, x1, search, contacts, group_of);
}

void PairDetector::appendBetween(const Model& model, const State& state,
                                 const std::vector<int>& ragdolls, const Points& x0,
                                 const Points& x1, PairSearch search,
                                 std::vector<Contact>& contacts, const std::vector<int>* group_of) {
  capsules_.clear();
  bodies_.clear();
  first_.clear();
  const auto bodyOf = [&](int k) {
    const Ragdoll& r = model.ragdolls[ragdolls[k]];
    return Body{ragdolls[k], &r, &model.skeletonOf(r)};
  };
  for (int k = 0; k < static_cast<int>(ragdolls.size()); ++k) {
    first_.push_back(static_cast<int>(capsules_.size()));
    bound(model, bodyOf(k), x0, x1, search, capsules_);
    bodies_.push_back(unionOf(capsules_, first_.back(), capsules_.size()));
  }
  for (const auto& [i, j] : grid_.findPairs(bodies_)) {
    const Body p = bodyOf(i), q = bodyOf(j);
    if (state.asleep[p.index] && state.asleep[q.index]) continue;
    if (group_of && (*group_of)[p.index] == (*group_of)[q.index]) continue;
    const Bounds* of_p = capsules_.data() + first_[i];
    const Bounds* of_q = capsules_.data() + first_[j];
    const std::size_t found = contacts.size();
    near_.clear();
    for (std::size_t l = 0; l < q.skeleton->capsules.size(); ++l)
      if (overlap(of_q[l], bodies_[i])) near_.push_back(static_cast<int>(l));
    for (std::size_t k = 0; k < p.skeleton->capsules.size(); ++k) {
      if (!overlap(of_p[k], bodies_[j])) continue;
      for (const int l : near_)
        if (overlap(of_p[k], of_q[l]))
          appendPair(model, p, static_cast<int>(k), q, l, x0, x1, search, contacts);
    }
    for (std::size_t k = found; k < contacts.size(); ++k)
      contacts[k].moves = {!state.asleep[p.index], !state.asleep[q.index]};
  }
}

}  // namespace ragdoll
