// ragdoll_lab replay: simulates the runs of a bag again, from ~model, ~pokes and ~followed, and
// compares every recorded state with its step, bit for bit.
#include <cstring>
#include <iomanip>
#include <iostream>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <sstream>

#include "arguments.h"
#include "commands.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/core/names.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "ragdoll_sim/ros/convert.h"
#include "ragdoll_sim/world/sense_csv.h"
#include "ragdoll_sim/world/world.h"
#include "recording.h"
#include "rows.h"

namespace ragdoll::lab {
namespace {

constexpr std::uint64_t kMaxGap = 1000000000;  ///< steps between two states; more is damage

bool same(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

/// "position x is 1.5, simulated 1.25" for the first of three numbers that differs, else empty.
template <class Vector>
std::string difference(const char* what, const Vector& recorded, const Vec3& simulated) {
  const double numbers[] = {recorded.x, recorded.y, recorded.z};
  for (int i = 0; i < 3; ++i) {
    if (same(numbers[i], simulated[i])) continue;
    std::ostringstream out;
    out << std::setprecision(17) << what << " "
        << "xyz"[i] << " is " << numbers[i] << ", simulated " << simulated[i];
    return out.str();
  }
  return "";
}

/// What differs first between a recorded state and the simulated one; empty: nothing.
std::string firstDifference(const World& world, const ragdoll_msgs::State& recorded) {
  const Model& model = *world.model();
  const State& state = world.state();
  if (!same(recorded.time, state.time)) return "time differs";
  for (std::size_t r = 0; r < model.ragdolls.size(); ++r) {
    const ragdoll_msgs::RagdollState& body = recorded.ragdolls[r];
    const Ragdoll& ragdoll = model.ragdolls[r];
    for (std::size_t i = 0; i < body.positions.size(); ++i) {
      const Eigen::Index p = ragdoll.first + static_cast<Eigen::Index>(i);
      std::string what = difference("position", body.positions[i], state.x.col(p));
      if (what.empty()) what = difference("velocity", body.velocities[i], state.v.col(p));
      if (!what.empty())
        return "particle " + ragdoll.name + "/" + model.skeletonOf(ragdoll).particles[i] + ": " +
               what;
    }
    if ((body.asleep != 0) != (state.asleep[r] != 0))
      return "ragdoll " + ragdoll.name + ": asleep differs";
  }
  return "";
}

/// One run: a world that began where it did, and how far it has been compared.
struct Run {
  std::uint32_t number = 0;
  std::unique_ptr<World> world;
  std::optional<Ticks> ticks;  ///< of the contacts' rows
  std::string hindrance;       ///< why it cannot be replayed
  std::string difference;      ///< the first that was found
  std::uint64_t first = 0;     ///< step of its first state
  std::uint32_t followed = 0;  ///< so many of ~followed are there, without a gap
  bool gap = false;            ///< there are more, after a gap
  std::size_t states = 0, compared = 0, events = 0;
};

struct Outcome {
  std::size_t states = 0, differing = 0, hindered = 0;
};

/// All runs of one node, a state at a time.
class Replay {
 public:
  Replay(const std::string& path, const Recording& recording, const NodeTopics& node,
         RowFile& contacts, double rate)
      : contacts_(contacts),
        rate_(rate),
        where_(path + ": " + node.state),
        node_(node),
        models_(recording.models(node)),
        pokes_(recording.pokes(node)),
        followed_(recording.followed(node)) {
    recording.forEachState(node, [this](const ragdoll_msgs::State& s) {
      last_ = {s.run, s.told, s.followed};
    });
  }

  void compare(const ragdoll_msgs::State& recorded) {
    if (!run_ || recorded.run != run_->number) {
      finish();
      begin(recorded);
    }
    ++run_->states;
    if (!run_->hindrance.empty() || !run_->difference.empty()) return;
    if (recorded.run == last_.run && recorded.step > last_.told) return;  // not yet told what acted
    if (recorded.followed > run_->followed) {
      if (recorded.run != last_.run || run_->followed == 0 || run_->gap)
        run_->hindrance = missingFollowed(recorded);
      return;
    }
    World& world = *run_->world;
    checkFits(world, recorded);
    while (world.state().step < recorded.step) {
      world.advance();
      writeContacts(false);
    }
    world.takeEvents();
    world.takeActed();
    ++run_->compared;
    const std::string what = firstDifference(world, recorded);
    if (!what.empty()) run_->difference = "step " + std::to_string(recorded.step) + ": " + what;
  }

  /// Tells of the run that was compared last.
  void finish() {
    if (!run_) return;
    writeContacts(true);
    Run& run = *run_;
    if (run.compared == 0 && run.hindrance.empty())
      run.hindrance =
          "none of its " + std::to_string(run.states) +
          " states can be compared: a ~wrench or a frame acts on them, and the bag ends before "
          "~pokes or ~followed tells of it";
    std::cout << node_.name << " run " << run.number << ": ";
    if (!run.hindrance.empty()) {
      std::cout << "cannot be replayed: " << run.hindrance << "\n";
      ++outcome_.hindered;
    } else if (!run.difference.empty()) {
      std::cout << "differs at " << run.difference << "\n";
      if (run.compared == 1 && run.first > 0)
        std::cout << "  the recording begins at step " << run.first
                  << ": what ~pokes told before is not in the bag\n";
      ++outcome_.differing;
    } else {
      std::cout << "identical in " << run.compared << " states, steps " << run.first << " to "
                << run.world->state().step << ", " << run.events << " pokes\n";
      outcome_.states += run.compared;
      if (run.compared < run.states)
        std::cout
            << "  " << run.states - run.compared
            << " states at the end are not compared: a ~wrench or a frame acts on them, and the "
               "bag ends before ~pokes or ~followed tells of it\n";
    }
    run_.reset();
  }

  const Outcome& outcome() const { return outcome_; }

 private:
  void begin(const ragdoll_msgs::State& first) {
    if (first.run < next_) throw Error(where_, restarted(first));
    next_ = first.run + 1;
    auto after = models_.upper_bound(first.run);
    if (after == models_.begin())
      throw Error(where_, "run " + std::to_string(first.run) +
                              " has no ragdoll_msgs/Model: record ~model together with ~state");
    const ragdoll_msgs::Model& model = std::prev(after)->second;
    run_ = std::make_unique<Run>();
    run_->number = first.run;
    run_->first = first.step;
    try {
      build(model);
    } catch (const Error& e) {
      throw Error(where_ + ": run " + std::to_string(first.run), e.what());
    }
  }

  /// The world of the present run at its beginning, with all its pokes to come.
  void build(const ragdoll_msgs::Model& model) {
    run_->world = std::make_unique<World>(parseScene(model.scene_yaml, node_.model));
    World& world = *run_->world;
    world.setMaxPokes(std::numeric_limits<std::size_t>::max());  // all of the run's are to come
    if (model.run == run_->number && !model.snapshot.empty()) world.restore(model.snapshot);
    for (const ragdoll_msgs::PokeEvent& message : pokes_[run_->number]) {
      const Event event = fromPokeEvent(*world.model(), message);
      if (!event.poke.body_name.empty()) ++run_->events;
      world.replay(event);
    }
    for (const ragdoll_msgs::FollowedFrame& message : followed_[run_->number]) {
      run_->gap = message.number != run_->followed + 1;
      if (run_->gap) break;
      ++run_->followed;
      world.replay(fromFollowedMsg(*world.model(), message));
    }
    if (!contacts_.wanted()) return;
    world.keepContacts(true);
    run_->ticks.emplace(*world.model(), rate_);
    run_->ticks->due(static_cast<double>(world.state().step) * world.stepLength());
  }

  /// What touched in the time of a tick, or since the last one.
  void writeContacts(bool rest) {
    if (!contacts_.wanted() || !run_->world->keepsContacts()) return;
    World& world = *run_->world;
    const double time = static_cast<double>(world.state().step) * world.stepLength();
    if (run_->ticks->due(time) == 0 && !rest) return;
    writeContactRows(*world.model(), *world.takeContacts(), contacts_.out());
  }

  std::string missingFollowed(const ragdoll_msgs::State& state) const {
    const std::string what = "obstacles or pins follow " + joined(run_->world->followedFrames()) +
                             " of another node, and ";
    if (node_.followed.empty()) return what + "~followed was not recorded";
    return what + "of the " + std::to_string(state.followed) +
           " messages of ~followed up to step " + std::to_string(state.step) + " number " +
           std::to_string(run_->followed + 1) +
           " is missing: record ~followed from before the run begins";
  }

  std::string restarted(const ragdoll_msgs::State& state) const {
    return "goes back to step " + std::to_string(state.step) + " of run " +
           std::to_string(state.run) +
           ": the node was started again; record each start into a bag of its own";
  }

  void checkFits(const World& world, const ragdoll_msgs::State& recorded) const {
    const Model& model = *world.model();
    bool fits = recorded.ragdolls.size() == model.ragdolls.size();
    for (std::size_t r = 0; fits && r < model.ragdolls.size(); ++r) {
      const auto n = static_cast<std::size_t>(model.skeletonOf(model.ragdolls[r]).named);
      const ragdoll_msgs::RagdollState& body = recorded.ragdolls[r];
      fits = body.positions.size() == n && body.velocities.size() == n;
    }
    const std::string step = "step " + std::to_string(recorded.step);
    if (!fits) throw Error(where_, step + " has other particles than its model");
    if (recorded.step < world.state().step) throw Error(where_, restarted(recorded));
    if (recorded.step - world.state().step > kMaxGap)
      throw Error(where_, step + " comes after step " + std::to_string(world.state().step) +
                              ": the bag is damaged");
  }

  RowFile& contacts_;
  double rate_;  ///< [Hz]
  std::string where_;
  const NodeTopics& node_;
  std::map<std::uint32_t, ragdoll_msgs::Model> models_;
  std::map<std::uint32_t, std::vector<ragdoll_msgs::PokeEvent>> pokes_;
  std::map<std::uint32_t, std::vector<ragdoll_msgs::FollowedFrame>> followed_;
  RunMark last_;            ///< of the node's last state
  std::uint32_t next_ = 0;  ///< the smallest number that the next run may have
  std::unique_ptr<Run> run_;
  Outcome outcome_;
};

int replay(const std::string& path, const std::string& contacts, double rate) {
  RowFile rows(contacts);
  if (rows.wanted()) writeContactHeader(rows.out());
  const Recording recording(path);
  Outcome all;
  for (const NodeTopics& node : recording.nodes()) {
    Replay replay(path, recording, node, rows, rate);
    recording.forEachState(node, [&](const ragdoll_msgs::State& s) { replay.compare(s); });
    replay.finish();
    all.states += replay.outcome().states;
    all.differing += replay.outcome().differing;
    all.hindered += replay.outcome().hindered;
  }
  rows.close();
  if (all.differing > 0) return kCheckFailed;
  return all.hindered > 0 ? kBadInput : kOk;
}

}  // namespace

int replayCommand(const Words& words) {
  std::string bag, contacts;
  double rate = 60;
  CommandLine line{
      "replay BAG",
      "Simulates the runs of a bag with ~model, ~pokes, ~followed and ~state again and "
      "compares every\nstate, bit for bit. Status 1: one differs; 2: a run cannot be replayed.",
      {},
      "BAG",
      "the bag file"};
  line.options.add_options()("contacts", po::value(&contacts),
                             "Write a row per contact and tick to this file, as of run")(
      "rate", positive("--rate", rate), "Ticks of --contacts [Hz]");
  return parse(line, words, bag) ? replay(bag, contacts, rate) : kOk;
}

}  // namespace ragdoll::lab
