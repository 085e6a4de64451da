// Pokes, streams and pulls of a world: accepted, acting, over, told.
#include "ragdoll_sim/world/world.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "ragdoll_sim/core/bounds.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/pull.h"
#include "world_names.h"

namespace ragdoll {
namespace {

constexpr double kMaxAhead = 1e15;  ///< steps: more than any clock tells, and exact as a double

bool isOver(const Poke& poke, double time, double h) {
  if (poke.duration < 0) return false;
  const double first = std::max(0.0, std::round(poke.start / h));
  return std::round(time / h) >= first + std::max(1.0, std::round(poke.duration / h));
}

}  // namespace

void World::setPokes(const std::vector<Poke>& pokes) {
  pokes_.clear();
  to_come_.clear();
  streams_.clear();
  clearings_.clear();
  pulls_.clear();
  for (const Poke& poke : pokes) to_come_.insert({poke.start, {poke, next_order_++}});
  pokes_changed_ = true;
}

Poke World::rounded(Poke poke, std::uint64_t& first) const {
  const double h = stepLength();
  const double wait = std::max(0.0, std::round((poke.start - state_.time) / h));
  first = state_.step + static_cast<std::uint64_t>(wait);
  poke.start = state_.time + wait * h;
  if (poke.duration >= 0) poke.duration = std::max(1.0, std::round(poke.duration / h)) * h;
  return poke;
}

std::uint64_t World::addPoke(Poke poke) {
  checkRoom(pokes_.size() + to_come_.size());
  checkForce(*model_, poke);
  Event event;
  event.run = run_;
  event.poke = rounded(std::move(poke), event.step);
  to_come_.insert({event.poke.start, {event.poke, next_order_++}});
  events_.push_back(std::move(event));
  return events_.back().step;
}

std::size_t World::clearPokes() {
  const std::size_t ended = clear(next_order_++);
  events_.push_back({state_.step, {}, run_});
  return ended;
}

std::size_t World::clear(std::uint64_t order) {
  const std::size_t before = pokes_.size() + to_come_.size() + streams_.size();
  pokes_.erase(std::remove_if(pokes_.begin(), pokes_.end(),
                              [&](const Accepted& a) { return a.order < order; }),
               pokes_.end());
  for (auto i = to_come_.begin(); i != to_come_.end();)
    i = i->second.order < order ? to_come_.erase(i) : std::next(i);
  for (Stream& s : streams_) tellStream(s);
  streams_.clear();
  pulls_.clear();
  takeActed();
  pokes_changed_ = true;
  return before - pokes_.size() - to_come_.size();
}

void World::checkToCome(std::uint64_t step) const {
  if (step < state_.step)
    throw Error("", "the step " + std::to_string(step) + " is past; this is step " +
                        std::to_string(state_.step) + ": reset and pause before a replay");
  if (static_cast<double>(step - state_.step) > kMaxAhead)
    throw Error("", "the step " + std::to_string(step) + " is too far ahead of step " +
                        std::to_string(state_.step));
}

void World::checkRoom(std::size_t pokes) const {
  if (pokes >= max_pokes_)
    throw Error("",
                "there are " + std::to_string(pokes) +
                    " pokes that act or are to come, which is the most; ~clear_pokes ends them");
}

void World::replay(const FollowedFrame& followed) {
  checkToCome(followed.step);
  glides_[followed.step].push_back(followed.glide);
}

void World::replay(const Event& event) {
  checkToCome(event.step);
  if (event.poke.body_name.empty()) {
    checkRoom(clearings_.size());
    clearings_.push_back({event.step, next_order_++});
    events_.push_back({event.step, {}, run_});
    return;
  }
  Poke poke = event.poke;
  poke.start = state_.time + static_cast<double>(event.step - state_.step) * stepLength();
  addPoke(std::move(poke));
}

void World::stream(const std::string& source, std::vector<Poke> pokes, double seconds) {
  for (const Poke& poke : pokes) checkForce(*model_, poke);
  auto s = std::find_if(streams_.begin(), streams_.end(),
                        [&](const Stream& other) { return other.source == source; });
  pokes_changed_ = true;
  if (s != streams_.end()) {
    tellStream(*s);
    streams_.erase(s);
  }
  if (pokes.empty()) return;
  for (Poke& poke : pokes) {
    poke.start = state_.time;
    poke.duration = -1;
  }
  const double h = stepLength();
  streams_.push_back({source, state_.step, state_.time + std::max(1.0, std::round(seconds / h)) * h,
                      std::move(pokes)});
}

void World::tellStream(const Stream& s) {
  if (s.first == state_.step) return;  // it never acted
  for (Poke poke : s.pokes) {          // in a new run the stream itself goes on without an end
    poke.duration = static_cast<double>(state_.step - s.first) * stepLength();
    events_.push_back({s.first, poke, run_});
  }
}

/// Those whose first step this is; with so many to come that a look at each would take long.
void World::beginPokes() {
  const double h = stepLength(), now = std::round(state_.time / h);
  while (!to_come_.empty() && std::round(to_come_.begin()->first / h) <= now) {
    pokes_.push_back(std::move(to_come_.begin()->second));
    to_come_.erase(to_come_.begin());
    pokes_changed_ = true;
  }
}

void World::gatherPokes() {
  beginPokes();
  const double h = stepLength();
  const auto over = [&](const Accepted& a) { return isOver(a.poke, state_.time, h); };
  const auto ended = std::remove_if(pokes_.begin(), pokes_.end(), over);
  pokes_changed_ |= ended != pokes_.end();
  pokes_.erase(ended, pokes_.end());
  for (std::size_t i = 0; i < streams_.size();) {
    if (state_.time < streams_[i].end - h / 2) {
      ++i;
      continue;
    }
    tellStream(streams_[i]);
    streams_.erase(streams_.begin() + static_cast<std::ptrdiff_t>(i));
    pokes_changed_ = true;
  }
  if (!pokes_changed_) return;
  pokes_changed_ = false;
  inputs_.pokes.clear();
  for (const Accepted& a : pokes_) inputs_.pokes.push_back(a.poke);
  for (const Stream& s : streams_)
    inputs_.pokes.insert(inputs_.pokes.end(), s.pokes.begin(), s.pokes.end());
  sortPokes();
}

void World::sortPokes() {
  std::stable_sort(
      inputs_.pokes.begin(), inputs_.pokes.end(),
      [h = stepLength()](const Poke& a, const Poke& b) { return actsBefore(a, b, h); });
}

void World::pull(const std::string& body, const Vec3& target) {
  const BodyRef ref = findParticle(*model_, body);
  const auto known = std::find_if(pulls_.begin(), pulls_.end(),
                                  [&](const Pull& p) { return p.body.particles == ref.particles; });
  if (known != pulls_.end())
    known->target = target;
  else
    pulls_.push_back({particleName(*model_, ref.particles[0]), ref, target});
}

void World::release(const std::string& body) {
  pulls_.erase(std::remove_if(pulls_.begin(), pulls_.end(),
                              [&](const Pull& p) { return p.body_name == body; }),
               pulls_.end());
}

void World::addPulls() {
  for (const Pull& pull : pulls_) {
    Poke poke;
    poke.body = pull.body;
    poke.body_name = pull.body_name;
    poke.start = state_.time;
    poke.duration = stepLength();
    poke.force = pullForce(*model_, state_, pull.body.particles[0], pull.target);
    if (poke.force.isZero(0)) continue;
    inputs_.pokes.push_back(poke);
    events_.push_back({state_.step, std::move(poke), run_});
    pokes_changed_ = true;  // the next step has others
  }
  if (pokes_changed_) sortPokes();
}

std::vector<Poke> World::takeActed() {
  acted_taken_ = true;
  return std::exchange(acted_, {});
}

std::vector<Event> World::takeEvents() { return std::exchange(events_, {}); }

}  // namespace ragdoll
