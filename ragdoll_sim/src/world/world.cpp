#include "ragdoll_sim/world/world.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "ragdoll_sim/core/bounds.h"
#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/names.h"
#include "ragdoll_sim/core/pull.h"
#include "ragdoll_sim/core/sleep.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace ragdoll {
namespace {

constexpr double kMaxAhead = 1e15;  ///< steps: more than any clock tells, and exact as a double
constexpr double kFollowPeriod = 0.004;  ///< [s] of simulated time; frames follow at least so often

bool isOver(const Poke& poke, double time, double h) {
  if (poke.duration < 0) return false;
  const double first = std::max(0.0, std::round(poke.start / h));
  return std::round(time / h) >= first + std::max(1.0, std::round(poke.duration / h));
}

bool samePins(const std::vector<Pin>& a, const std::vector<Pin>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Pin& p, const Pin& q) {
    return p.particle == q.particle && p.frame == q.frame && p.target == q.target;
  });
}

std::string particleName(const Model& model, int particle) {
  for (const Ragdoll& r : model.ragdolls) {
    const Skeleton& s = model.skeletonOf(r);
    if (particle < r.first + s.size()) return r.name + "/" + s.particles[particle - r.first];
  }
  return "";
}

/// The one particle that `body` names.
BodyRef findParticle(const Model& model, const std::string& body) {
  const BodyRef ref = findBody(model, body);
  if (ref.particles.size() == 1) return ref;
  std::vector<std::string> names;
  for (const int p : ref.particles) names.push_back(particleName(model, p));
  throw Error("", "'" + body + "' is a segment; a particle is held, of this one: " + joined(names));
}

}  // namespace

World::World(Scene scene, std::string source, const std::string& frame_prefix)
    : source_(std::move(source)),
      scene_(std::make_shared<Scene>(std::move(scene))),
      model_(std::make_shared<Model>(buildModel(*scene_))),
      state_(startState(*model_)),
      tracker_(*model_, frame_prefix),
      start_pins_(model_->pins) {
  for (const ObstacleSpec& o : scene_->obstacles) checkForeign(o.where + ": frame", o.frame);
  for (const PinSpec& p : scene_->pins) checkForeign(p.where + ": frame", p.frame);
  checkSensorNames();
  setPokes(model_->pokes);
  follow_.restart(*model_, state_);
  restart();
}

void World::checkSensorNames() const {
  for (const Sensor& s : model_->sensors) {
    const std::string own = s.name.substr(s.name.find('/') + 1);
    if (tracker_.tree(s.ragdoll).frame(own) < 0) continue;
    throw Error(s.where + ".name", "'" + s.name +
                                       "' is a frame of the body already; another name is right, "
                                       "such as '" +
                                       own + "_imu'");
  }
}

void World::advance() {
  for (std::size_t i = 0; i < clearings_.size();) {
    if (clearings_[i].step != state_.step) {
      ++i;
      continue;
    }
    clear(clearings_[i].order);
    clearings_.erase(clearings_.begin() + static_cast<std::ptrdiff_t>(i));
  }
  gatherPokes();
  followFrames();
  // Each once between two looks: when it begins, or in the first step after a look.
  const double h = stepLength();
  for (const Poke& poke : inputs_.pokes)
    if (isActive(poke, state_.time, h) && (acted_taken_ || !isActive(poke, state_.time - h, h)))
      acted_.push_back(poke);
  acted_taken_ = false;
  addPulls();
  workspace_.keepContacts(contacts_ ? &contacts_->log() : nullptr);
  if (contacts_) contacts_->begin(state_);
  report_ = step(*model_, inputs_, workspace_, state_);
  if (contacts_) contacts_->end(*model_, inputs_, state_);
  if (state_.step % steps_per_follow_ == 0) {
    tracker_.update(state_);
    followed_step_ = state_.step;
  }
  if (imus_) imus_->update(*model_, state_, imu_samples_);
  ++revision_;
}

void World::followFrames() {
  const auto due = glides_.find(state_.step);
  if (due != glides_.end()) {
    for (const Glide& glide : due->second) follow_.repeat(glide, *model_, state_);
    glides_.erase(due);
  }
  for (Glide& glide : follow_.takeChanges()) {
    for (Glide::Particle& p : glide.held) p.name = particleName(*model_, p.particle);
    followed_.push_back({state_.step, run_, ++followed_count_, std::move(glide)});
  }
  follow_.apply(*model_, stepLength(), state_, inputs_);
}

void World::reset() {
  endRun();
  if (!samePins(model_->pins, start_pins_)) changePins(start_pins_);
  state_ = startState(*model_);
  setPokes(model_->pokes);
  follow_.restart(*model_, state_);
  restart();
  beginRun(true);
}

void World::replaceBy(World& other) {
  endRun();
  const std::uint64_t revision = std::max(revision_, other.revision_) + 1;
  const std::uint32_t run = std::max(run_, other.run_) + 1;
  other.keepContacts(keepsContacts());
  other.setMaxFrameSpeed(follow_.maxFrameSpeed());
  std::swap(*this, other);
  std::swap(events_, other.events_);  // what this one accepted is still to be told
  std::swap(followed_, other.followed_);
  revision_ = revision;
  run_ = run;
}

void World::restart() {
  // Scratch memory might carry something over; a run that starts again must give the same bits.
  workspace_ = Workspace();
  keepContacts(keepsContacts());
  report_ = StepReport();
  takeActed();
  inputs_ = Inputs();
  pokes_changed_ = true;
  steps_per_follow_ =
      std::max<std::uint64_t>(1, static_cast<std::uint64_t>(kFollowPeriod / stepLength()));
  tracker_.reset(state_);
  followed_step_ = state_.step;
  imus_.reset();
  imu_samples_.clear();
  if (!model_->sensors.empty()) {
    imus_.emplace(*model_);
    imus_->reset(state_);
  }
  ++revision_;
}

void World::endRun() {
  for (Stream& stream : streams_) {
    tellStream(stream);
    stream.first = state_.step;
    for (Poke& poke : stream.pokes) poke.start = state_.time;
  }
}

RunMark World::mark() const {
  RunMark mark{run_, state_.step, followed_count_};
  for (const Stream& stream : streams_) mark.told = std::min(mark.told, stream.first);
  return mark;
}

void World::beginRun(bool at_start) {
  ++run_;
  pokes_changed_ = true;
  followed_count_ = 0;
  follow_.tellAll();
  beginning_.reset();
  if (at_start) return;
  // Streams that go on and clearings to come are told as events of the new run.
  const std::vector<Stream> streams = std::exchange(streams_, {});
  beginning_ = std::make_shared<Bytes>(save());
  streams_ = streams;
  for (const Clearing& clearing : clearings_) events_.push_back({clearing.step, {}, run_});
}

void World::configure(const std::shared_ptr<const Scene>& before,
                      std::shared_ptr<const Scene> scene, std::shared_ptr<const Model> model) {
  if (scene_ != before)
    throw Error("", "another scene or state was loaded meanwhile; set it again");
  endRun();
  const std::vector<Pin> pins = model_->pins;
  const bool other_step = model->solver.step != stepLength();
  scene_ = std::move(scene);
  model_ = std::move(model);
  changePins(pins);
  if (other_step) restart();
  beginRun(false);
}

Bytes World::save() const {
  Moment moment{state_, {}, model_->pins, model_->gravity, model_->solver};
  for (const Accepted& a : pokes_) moment.pokes.push_back(a.poke);
  for (const auto& [start, a] : to_come_) moment.pokes.push_back(a.poke);
  for (const Stream& s : streams_)
    for (Poke poke : s.pokes) {
      poke.duration = std::max(0.0, s.end - poke.start);
      moment.pokes.push_back(poke);
    }
  return toBytes(*model_, moment);
}

void World::restore(const Bytes& bytes) {
  Moment moment = fromBytes(*model_, bytes);
  Scene scene = *scene_;
  scene.solver = moment.solver;
  scene.gravity = moment.gravity;
  scene.text = toYaml(scene);
  if (scene.text == scene_->text) {
    endRun();
    if (!samePins(model_->pins, moment.pins)) changePins(moment.pins);
  } else {
    Model model = buildModel(scene);
    setPins(model, moment.pins);
    endRun();
    model_ = std::make_shared<Model>(std::move(model));
    scene_ = std::make_shared<Scene>(std::move(scene));
  }
  state_ = std::move(moment.state);
  setPokes(moment.pokes);
  follow_.restart(*model_, state_);
  restart();
  beginRun(false);
}

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

void World::attach(const std::string& body, const std::string& frame) {
  const BodyRef ref = findParticle(*model_, body);
  if (frame.empty()) throw Error("frame", "must name a TF frame");
  checkForeign("frame", frame);
  std::vector<Pin> pins = model_->pins;
  const int p = ref.particles[0];
  pins.erase(
      std::remove_if(pins.begin(), pins.end(), [&](const Pin& q) { return q.particle == p; }),
      pins.end());
  pins.push_back({ref.ragdoll, p, state_.x.col(p), frame});
  endRun();
  changePins(pins);
  beginRun(false);
}

void World::detach(const std::string& body) {
  const int p = findParticle(*model_, body).particles[0];
  std::vector<Pin> pins;
  std::vector<std::string> held;
  for (const Pin& pin : model_->pins) {
    if (pin.particle != p) pins.push_back(pin);
    held.push_back(particleName(*model_, pin.particle));
  }
  if (pins.size() == model_->pins.size())
    throw Error("", "'" + body + "' is not held; " +
                        (held.empty() ? "nothing is" : "held are " + joined(held)));
  endRun();
  changePins(pins);
  beginRun(false);
}

void World::changePins(const std::vector<Pin>& pins) {
  auto model = std::make_shared<Model>(*model_);
  setPins(*model, pins);
  model_ = std::move(model);
  for (const Pin& pin : pins) state_.v.col(pin.particle).setZero();
  // Multipliers belong to the sticks that can move, and those are others now.
  state_.multipliers = startState(*model_).multipliers;
  wakeAll(state_);
  workspace_ = Workspace();
  keepContacts(keepsContacts());
  inputs_.pins.clear();
  inputs_.obstacles.clear();
  follow_.setPins(*model_);
}

void World::checkForeign(const std::string& where, const std::string& frame) const {
  if (hasFrame(!frame.empty() && frame[0] == '/' ? frame.substr(1) : frame))
    throw Error(where, "'" + frame + "' is one of the ragdolls' own; it must be another node's");
}

bool World::hasFrame(const std::string& name) const {
  for (int i = 0; i < tracker_.size(); ++i)
    if (tracker_.name(i) == name) return true;
  return false;
}

std::vector<std::string> World::frameNames() const {
  std::vector<std::string> names;
  for (int i = 0; i < tracker_.size(); ++i) names.push_back(tracker_.name(i));
  return names;
}

std::optional<Pose> World::frame(const std::string& name) const {
  for (int i = 0; i < tracker_.size(); ++i) {
    if (tracker_.name(i) != name) continue;
    if (followed_step_ == state_.step) return tracker_.now().frames[i];
    FrameTracker present = tracker_;
    present.update(state_);
    return present.now().frames[i];
  }
  return std::nullopt;
}

std::vector<Poke> World::takeActed() {
  acted_taken_ = true;
  return std::exchange(acted_, {});
}

std::vector<Event> World::takeEvents() { return std::exchange(events_, {}); }

std::vector<FollowedFrame> World::takeFollowed() { return std::exchange(followed_, {}); }

void World::keepContacts(bool keep) {
  contacts_.reset();
  if (keep) contacts_.emplace(*model_);
}

std::optional<ContactReport> World::takeContacts() {
  if (!contacts_) return std::nullopt;
  return contacts_->take();
}

std::vector<std::string> World::pinNames() const {
  std::vector<std::string> names;
  for (const Pin& pin : model_->pins) {
    const bool scenes = std::any_of(start_pins_.begin(), start_pins_.end(), [&](const Pin& other) {
      return other.particle == pin.particle && other.frame == pin.frame;
    });
    std::string name = particleName(*model_, pin.particle);
    const std::size_t slash = name.find('/');
    if (pin.ragdoll == 0)
      name = name.substr(slash + 1);
    else
      name[slash] = '_';
    names.push_back((scenes ? "pin_" : "attach_") + name);
  }
  return names;
}

std::vector<ImuSample> World::takeImuSamples() { return std::exchange(imu_samples_, {}); }

}  // namespace ragdoll
