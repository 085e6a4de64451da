// What a fall of the data sets is: drawn from its seed alone, and made into a scene. The one place
// that defines it; `ragdoll_lab falls` and scripts/fall_dataset.py both ask here.
//
// A fall begins at its onset, when what holds the body lets go: the scene's time is 0 there. What
// stands before it in a record is the body as it starts, held, or carried at its walking speed.
//
// Seeds are strata: ten kinds in turn, seed % 10, in four scenes each, seed % 40; body, friction and
// furniture of a scene change every 4000 seeds. So any forty seeds have every kind, and falls of one
// scene can be simulated in packs. docs/data.md.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "ragdoll_sim/core/scene.h"

namespace ragdoll::falls {

constexpr std::uint64_t kLastSeed = 99999999;  ///< as names of groups have eight digits
constexpr int kScenes = 40;                    ///< in turn

/// What is drawn.
struct Fall {
  std::uint64_t seed = 0;
  std::string kind;   ///< push | trip | slip | faint
  std::string start;  ///< standing | sitting | chair | bed | stairs
  double height = 1.75, mass = 75;       ///< [m], [kg] of the body
  double scale = 1;                      ///< of the model's lengths
  double yaw = 0, pitch = 0, roll = 0;   ///< [deg] at the start
  double friction = 0.6;                 ///< of what it falls on
  double speed = 0;                      ///< [m/s] it walks along +x of its own
  std::string push_body;                 ///< empty: none
  Vec3 push = Vec3::Zero();              ///< [N] world
  double push_duration = 0;              ///< [s] from the onset on
  std::string foot;                      ///< trip: which is held; slip: under which it is smooth
  double hold = 0;                       ///< [s] trip: from the onset on
  double foot_friction = 0;              ///< slip: under that foot
  double onset = 0;                      ///< [s] of quiet before it, in a record
  /// bed: [m] from its middle towards the edge; sitting: on the seat's rear (-1) or front (1) edge
  double place = 0;
};

/// Throws Error if the seed is beyond kLastSeed.
Fall drawFall(std::uint64_t seed);

/// Which falls are of one scene: those that Batch may step together.
std::uint64_t sceneOf(std::uint64_t seed);

/// The model with all lengths times `scale`, masses times its cube, inertias its fifth power.
std::shared_ptr<const SkeletonSpec> scaledModel(const SkeletonSpec& model, double scale);

struct FallScene {
  Scene scene;
  int floors = 1;  ///< so many of the obstacles, the first ones, are what it falls on; others: furniture
  double release = 0;  ///< [s] when the pins let go: a faint's at the onset, a trip's after Fall::hold

  std::vector<std::string> held() const;  ///< particles that pins hold until then; empty: none
};

/// `model`: scaledModel; as the same pointer for falls of one scene. step [s]. Joint damping is that
/// of flesh; bodies do not pass through themselves but by `fast`, which has no packs for that. What
/// the scene needs of the model (its particles' names) is checked: throws Error.
FallScene fallScene(const Fall& fall, const std::shared_ptr<const SkeletonSpec>& model, double step);

/// Whole steps [s] in a sample at the rate [Hz]. Throws Error("--rate", ...) that names rates that fit.
int stepsPerSample(double rate, double step);

}  // namespace ragdoll::falls
