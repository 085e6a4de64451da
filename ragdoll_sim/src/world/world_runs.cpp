// Where runs of a world begin and end.
#include "ragdoll_sim/world/world.h"

#include <algorithm>
#include <utility>

#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace ragdoll {
namespace {

constexpr double kFollowPeriod = 0.004;  ///< [s] of simulated time; frames follow at least so often

bool samePins(const std::vector<Pin>& a, const std::vector<Pin>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Pin& p, const Pin& q) {
    return p.particle == q.particle && p.frame == q.frame && p.target == q.target;
  });
}

}  // namespace

void World::reset() {
  endRun();
  if (!samePins(model_->pins, start_pins_)) changePins(start_pins_);
  state_ = startState(*model_, &energy_taken_);
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
    if (contacts_) contacts_->forget();
  }
  state_ = std::move(moment.state);
  setPokes(moment.pokes);
  follow_.restart(*model_, state_);
  restart();
  beginRun(false);
}

}  // namespace ragdoll
