// Falls drawn from their seeds.
#include "ragdoll_sim/falls/fall.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "falls/random.h"
#include "ragdoll_sim/core/error.h"

namespace ragdoll::falls {
namespace {

constexpr std::uint64_t kBlock = 4000;      ///< seeds until scenes change
constexpr double kHeight = 1.75, kMass = 75;  ///< of the models that come with the package
constexpr std::uint64_t kOfScenes = 0x5ce9e;  ///< tells streams of scenes from those of falls

struct Kind {
  const char *kind, *start;
};

/// seed % 10.
constexpr std::array<Kind, 10> kKinds = {{{"push", "standing"},
                                          {"trip", "standing"},
                                          {"slip", "standing"},
                                          {"faint", "standing"},
                                          {"faint", "sitting"},
                                          {"push", "chair"},
                                          {"push", "bed"},
                                          {"push", "stairs"},
                                          {"trip", "stairs"},
                                          {"faint", "stairs"}}};

/// What falls of one scene share.
void drawScene(Random& random, Fall& fall) {
  // Heights of adults, both sexes: mean and deviation, cut where models are no longer adults.
  fall.height = std::clamp(1.69 + 0.095 * random.normal(), 1.45, 1.98);
  fall.scale = fall.height / kHeight;
  fall.mass = kMass * fall.scale * fall.scale * fall.scale;
  fall.friction = random.uniform(0.4, 0.9);
  if (fall.kind == "trip" || fall.kind == "slip")
    fall.foot = random.uniform(0, 1) < 0.5 ? "left_foot" : "right_foot";
  if (fall.kind == "trip") fall.hold = 0.005 * std::round(random.uniform(0.08, 0.25) / 0.005);
  if (fall.kind == "slip") fall.foot_friction = random.uniform(0.02, 0.1);
  if (fall.start == "sitting") fall.place = random.uniform(0, 1) < 0.5 ? -1 : 1;
}

void drawPush(Random& random, double least, double most, Fall& fall) {
  constexpr std::array<const char*, 5> kBodies = {"torso", "head", "left_shoulder",
                                                  "right_shoulder", "pelvis"};
  constexpr double kPi = 3.14159265358979323846;
  // Down the stairs; out of a chair, whose back holds: forward or to a side.
  const double spread = fall.start == "stairs" ? 0.5 : fall.start == "chair" ? 1.2 : kPi;
  const double direction = random.uniform(-spread, spread);
  const double weight = fall.mass / kMass;  // as easy to push over as the usual body
  const double force = weight * random.uniform(least, most);
  fall.push_body = kBodies[static_cast<std::size_t>(random.uniform(0, 5))];
  fall.push = force * Vec3(std::cos(direction), std::sin(direction), 0);
  fall.push_duration = random.uniform(0.1, 0.3);
}

void drawStart(Random& random, Fall& fall) {
  const bool free = fall.start == "standing" && fall.kind != "slip";
  fall.yaw = free ? random.uniform(-180, 180) : random.uniform(-8, 8);
  fall.pitch = random.uniform(-4, 4);
  fall.roll = random.uniform(-4, 4);
  if (fall.start == "sitting") {
    fall.pitch = fall.place < 0 ? random.uniform(-25, -8) : random.uniform(3, 12);
    fall.roll = random.uniform(-12, 12);
  }
  if (fall.start == "bed") {
    fall.pitch = random.uniform(0, 1) < 0.5 ? -90 : 90;  // on its back or front
    fall.roll = 0;
    fall.place = random.uniform(0.2, 0.32);
  }
  if (fall.kind == "trip") {
    fall.speed = random.uniform(0.7, 1.8);
    fall.pitch = random.uniform(0, 8);
  }
  if (fall.kind == "slip") {
    fall.speed = random.uniform(0.7, 1.6);
    fall.pitch = random.uniform(-12, -3);
  }
}

}  // namespace

std::uint64_t sceneOf(std::uint64_t seed) { return seed / kBlock * kScenes + seed % kScenes; }

Fall drawFall(std::uint64_t seed) {
  if (seed > kLastSeed)
    throw Error("seed", "is " + std::to_string(seed) + "; 0 ... " + std::to_string(kLastSeed) +
                            " is expected");
  Fall fall;
  fall.seed = seed;
  fall.kind = kKinds[seed % kKinds.size()].kind;
  fall.start = kKinds[seed % kKinds.size()].start;
  Random shared(sceneOf(seed), kOfScenes);
  drawScene(shared, fall);
  Random random(seed, 0);
  drawStart(random, fall);
  if (fall.kind == "push" && fall.start == "bed") {  // rolled over the edge
    fall.push_body = "torso";
    fall.push = Vec3(0, fall.mass / kMass * random.uniform(200, 400), 0);
    fall.push_duration = random.uniform(0.3, 0.5);
  } else if (fall.kind == "push") {
    drawPush(random, fall.start == "chair" ? 300 : 100, 500, fall);
  }
  fall.onset = 0.01 * std::round(random.uniform(0.3, 1.0) / 0.01);
  return fall;
}

int stepsPerSample(double rate, double step) {
  if (!(rate > 0 && rate <= 10000)) throw Error("--rate", "must be in (0, 10000] Hz");
  const double steps = 1 / (rate * step);
  const double each = std::max(1.0, std::round(steps));
  if (std::abs(steps - each) <= 1e-6 * each) return static_cast<int>(each);
  const auto text = [step](double n) {
    char buffer[32];
    std::snprintf(buffer, sizeof buffer, "%.6g", 1 / (n * step));
    return std::string(buffer);
  };
  const double below = std::max(1.0, std::floor(steps));
  char given[96];
  std::snprintf(given, sizeof given, "%g Hz does not fit steps of %g s: it can be ", rate, step);
  throw Error("--rate", given + (steps < 1 ? "" : text(below + 1) + " or ") + text(below) + " Hz");
}

}  // namespace ragdoll::falls
