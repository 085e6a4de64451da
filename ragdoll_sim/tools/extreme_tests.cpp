#include "extreme_tests.h"

#include <cmath>
#include <sstream>

#include "extreme_scenes.h"
#include "ragdoll_sim/core/bounds.h"

namespace ragdoll::lab {
namespace {

class Tests {
 public:
  explicit Tests(bool quick) : quick_(quick) {}

  std::vector<Extreme> all() {
    steps();
    massRatios();
    forces();
    drops();
    gravities();
    placed();
    flatBodies();
    sizes();
    farFromTheOrigin();
    fewSweeps();
    longRuns();
    wedges();
    squeezed();
    overlapping();
    return std::move(tests_);
  }

 private:
  /// The values of a row, fewer if it has to be quick.
  std::vector<double> some(const std::vector<double>& all, const std::vector<double>& few) const {
    return quick_ ? few : all;
  }

  Extreme& add(const std::string& group, const std::string& name, Scene scene, double seconds) {
    Extreme e;
    e.group = group;
    e.name = name;
    e.scene = std::move(scene);
    e.seconds = seconds;
    tests_.push_back(std::move(e));
    return tests_.back();
  }

  void steps() {
    for (const double h :
         some({1e-6, 1e-5, 1e-4, 1e-3, 1.0 / 240, 1.0 / 60, 1.0 / 30, 0.1, 0.2, 0.5},
              {1e-5, 1.0 / 60, 0.1, 0.5})) {
      const bool tiny = h < 5e-4;  // only the impact: a run of seconds would take minutes
      const std::string name = shortNumber(h) + " s, ";
      Extreme& fall = add("step", name + "falls 1 m",
                          humanScene(tiny ? "position: [0, 0, 1.03], velocity: [0, 0, -4.4]"
                                          : "position: [0, 0, 1.95], rpy_deg: [10, 30, 0]",
                                     kFloor),
                          tiny ? std::min(0.1, 3e4 * h) : 15);
      fall.step = h;
      fall.laws.rest = !tiny;
      if (tiny) fall.laws.joined = 0;
      Extreme& swing =
          add("step", name + "swings by a hand",
              humanScene("position: [0, 0, 0], rpy_deg: [0, 80, 0]", "pins: [right_hand]\n"),
              tiny ? std::min(0.1, 3e4 * h) : 10);
      swing.step = h;
      if (tiny) swing.laws.joined = 0;
    }
  }

  void massRatios() {
    for (const double ratio : some({1, 10, 100, 1e3, 1e4, 1e5, 1e6}, {1, 1e3, 1e6})) {
      std::vector<double> every(6, 1.0);
      for (std::size_t i = 2; i < every.size(); i += 2) every[i] = ratio;
      const std::string name = "1:" + shortNumber(ratio);
      add("mass ratio", name + ", hung", massRatioChain(ratio, 0), 5).sleep = false;
      add("mass ratio", name + ", swung", massRatioChain(ratio, kMassRatioTilt), 5);
      add("mass ratio", name + ", every other particle, swung",
          chainScene(every, 0.3, kMassRatioTilt), 5);
    }
    std::vector<double> heavy(11, 0.1);
    heavy.back() = 100;
    for (const double tilt : {0.0, 0.5}) {
      Extreme& chain = add("mass ratio",
                           tilt > 0 ? "100 kg on 10 links of 0.1 kg, tilted 0.5 rad"
                                    : "100 kg on 10 links of 0.1 kg, at rest",
                           chainScene(heavy, 0.1, tilt), 10);
      chain.step = 1.0 / 60;
      chain.sleep = false;
      chain.laws.joined = 0;
      if (tilt == 0) chain.laws.drift = 1e-3;
    }
  }

  void forces() {
    for (const double force :
         some({1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12}, {1e3, 1e6, 1e12})) {
      const std::string newtons = shortNumber(force);
      add("force for one step", newtons + " N on a hand, weightless",
          humanScene("position: [0, 0, 0]",
                     "gravity: [0, 0, 0]\n"
                     "pokes: [{at: 0.1, body: right_hand, force: [0, " +
                         newtons + ", 0]}]\n"),
          2)
          .laws.joined = 1.1;
      Extreme& down = add("force for one step", newtons + " N on the head, towards the floor",
                          humanScene("position: [0, 0, 1.2]",
                                     kFloor + ("pokes: [{at: 0.1, body: head, force: [0, 0, -" +
                                               newtons + "]}]\n")),
                          2);
      down.laws.joined = 1.1;
      down.laws.lowest = -0.005;
    }
  }

  void drops() {
    for (const double speed : some({1, 3, 10, 30, 100, 300, 1000}, {1, 100, 1000})) {
      const std::string metres = shortNumber(speed);
      const double seconds = speed > 100 ? 60 : 15;  // rebounds of a limp body rise to 130 m
      const std::string start =
          "position: [0, 0, 1.3], rpy_deg: [20, 40, 0], velocity: [0, 0, -" + metres + "]";
      Extreme& plane = add("drop", metres + " m/s on a plane", humanScene(start, kFloor), seconds);
      plane.laws.lowest = -0.005;
      plane.laws.rest = true;
      Extreme& box = add("drop", metres + " m/s on a 0.2 m box",
                         humanScene(start,
                                    "obstacles: [{type: box, position: [0, 0, -0.1], "
                                    "size: [2e5, 2e5, 0.2], friction: 0.6}]\n"),
                         seconds);
      box.laws.lowest = -0.005;
      box.laws.rest = true;
    }
  }

  void gravities() {
    for (const double g : some({0, 0.1, 1, 10, 100, 1000}, {0, 1000})) {
      Extreme& e =
          add("gravity", shortNumber(g) + " m/s^2",
              humanScene("position: [0, 0, 1.2], rpy_deg: [10, 30, 0], velocity: [0, 0, -1]",
                         kFloor + ("gravity: [0, 0, -" + shortNumber(g) + "]\n")),
              g > 0 && g < 1 ? 60 : 15);
      e.laws.rest = g > 0;
    }
  }

  void placed() {
    const auto place = [&](const std::string& name, const std::string& where, double speed) {
      Extreme& e =
          add("placed apart", name,
              humanScene("position: [0, 0, 0], place: {" + where + "}", "gravity: [0, 0, 0]\n"), 5);
      e.laws.energy_rise = kUnbounded;  // the energy is that of where its sticks want it
      e.laws.speed = speed;
    };
    place("a hand at its elbow", "right_hand: [-0.01, -0.2583, 0.1727]", 20);
    place("both hands at one point", "left_hand: [0.4, 0, 0], right_hand: [0.4, 0, 0]", 20);
    std::string all;
    const Scene human = humanScene("position: [0, 0, 0]", "");
    for (const ParticleSpec& p : human.ragdolls[0].skeleton->particles)
      all += (all.empty() ? "" : ", ") + p.name + ": [0, 0, 0]";
    place("all particles at one point", all, 20);
    place("a hand 1 m off", "right_hand: [-0.01, -1.346, -0.1545]", 20);
    if (!quick_) place("a hip 1 m off", "right_hip: [0, -1.11, 0]", 20);
    place("a hand 100 m off", "right_hand: [-0.01, -100.346, -0.1545]", 20);
  }

  void flatBodies() {
    const std::string tumble = "position: [0, 0, 0], angular_velocity: [1, 2, 3]";
    const std::string fall = "position: [0, 0, 1.95], rpy_deg: [10, 30, 0]";
    const std::string weightless = "gravity: [0, 0, 0]\n";
    Scene flat = humanScene(tumble, weightless), falling = humanScene(fall, kFloor);
    flattenModel(flat);
    flattenModel(falling);
    add("flat and symmetric", "mirror-symmetric human, tumbles", humanScene(tumble, weightless),
        10);
    add("flat and symmetric", "flat human, tumbles", flat, 10);
    add("flat and symmetric", "flat human, falls", falling, 15).laws.rest = true;
    if (quick_) return;
    add(
        "flat and symmetric", "flat human on its back in its own plane",
        [&] {
          Scene s = humanScene("position: [0, 0, 0.3], rpy_deg: [0, -90, 0]", kFloor);
          flattenModel(s);
          return s;
        }(),
        10)
        .laws.rest = true;
  }

  void sizes() {
    for (const double height : some({1e-3, 1e-2, 0.1, 1, 10, 100}, {1e-3, 100})) {
      const double scale = height / 1.75;
      Scene scene = humanScene("position: [0, 0, 0], rpy_deg: [10, 30, 0]", kFloor);
      scaleModel(scene, scale, 1);
      scene.ragdolls[0].pose.position.z() = 1.2 * scale;
      Extreme& e = add("size", shortNumber(height) + " m tall, falls", scene,
                       15 * std::max(1.0, std::sqrt(scale)));
      e.laws.depth = 5e-3 * scale;
      e.laws.rest = true;
    }
    for (const double mass : some({1e-6, 1e-3, 1, 1e3, 1e6}, {1e-6, 1e6})) {
      Scene scene = humanScene("position: [0, 0, 1.95], rpy_deg: [10, 30, 0]", kFloor);
      scaleModel(scene, 1, mass / 75);
      add("mass", shortNumber(mass) + " kg, falls 1 m", scene, 15).laws.rest = true;
    }
  }

  void farFromTheOrigin() {
    for (const double far : {1e6, kFarthest}) {
      const std::string out = shortNumber(far), name = ", " + out + " m out";
      add("far from the origin", "falls 1 m" + name,
          humanScene("position: [" + out + ", -" + out + ", 1.95], rpy_deg: [10, 30, 0]", kFloor),
          15)
          .laws.rest = true;
      add("far from the origin", "tumbles" + name,
          humanScene(
              "position: [" + out + ", " + out + ", " + out + "], angular_velocity: [1, 2, 3]",
              "gravity: [0, 0, 0]\n"),
          10);
    }
  }

  void fewSweeps() {
    Extreme& e = add("one sweep", "falls 1 m",
                     humanScene("position: [0, 0, 1.95], rpy_deg: [10, 30, 0]", kFloor), 15);
    e.sweeps = 1;
    Extreme& hung =
        add("one sweep", "swings by a hand",
            humanScene("position: [0, 0, 0], rpy_deg: [0, 80, 0]", "pins: [right_hand]\n"), 10);
    hung.sweeps = 1;
  }

  void longRuns() {
    const double seconds = quick_ ? 60 : 3600;
    const std::string time = quick_ ? "a minute" : "an hour";
    tests_.reserve(tests_.size() + 2);  // both are referred to
    Extreme& rest = add("long", time + " of rest, sleep off",
                        humanScene("position: [0, 0, 1.2], rpy_deg: [10, 30, 0]", kFloor), seconds);
    rest.sleep = false;
    rest.laws.rest = true;
    rest.laws.drift = 1e-3;
    Extreme& tumble =
        add("long", time + " of tumbling",
            humanScene("position: [0, 0, 0], angular_velocity: [1, 2, 3]", "gravity: [0, 0, 0]\n"),
            seconds);
    tumble.laws.energy_rise = 1e-3;
    rest.only_default = tumble.only_default = !quick_;
  }

  void wedges() {
    for (const double angle : some({10, 30, 60, 90}, {10, 60})) {
      const double half = 0.5 * angle * M_PI / 180;
      const std::string x = std::to_string(std::cos(half)), z = std::to_string(std::sin(half));
      Extreme& e = add("wedge of two planes", shortNumber(angle) + " degrees",
                       humanScene("position: [0, 0, " + shortNumber(1.2 + 0.8 / std::tan(half)) +
                                      "], rpy_deg: [10, 30, 0]",
                                  "obstacles: [{type: plane, normal: [" + x + ", 0, " + z +
                                      "]}, {type: plane, normal: [-" + x + ", 0, " + z + "]}]\n"),
                       20);
      e.laws.rest = true;
      e.laws.joined = 0;
    }
  }

  /// Two walls that close at `speed` to `gap`, hold for 1 s, and open again.
  void squeeze(const std::string& name, double gap, double speed) {
    constexpr double kOpen = 1.2;  ///< [m] between the walls
    const double closing = (kOpen - gap) / (2 * speed);
    Extreme& e = add("closing walls", name,
                     humanScene("position: [0, 0, 0.96]",
                                "obstacles: [{type: plane, friction: 0.6}, "
                                "{type: box, position: [-1.6, 0, 2], size: [2, 8, 8]}, "
                                "{type: box, position: [1.6, 0, 2], size: [2, 8, 8]}]\n"),
                     2 * closing + 16);
    e.drive = [=](double time, std::vector<Pose>& obstacles) {
      double way = std::min(time, closing);
      if (time > closing + 1) way = std::max(0.0, closing - (time - closing - 1));
      obstacles[1].position.x() = -1 - kOpen / 2 + speed * way;
      obstacles[2].position.x() = 1 + kOpen / 2 - speed * way;
    };
    e.laws.joined = 2 * closing + 2;
    e.laws.energy_rise = kUnbounded;  // the walls give energy
    e.laws.speed = 30 + 10 * speed;
    e.laws.rest = true;
  }

  void squeezed() {
    squeeze("to 0.4 m at 0.5 m/s", 0.4, 0.5);
    squeeze("to 0.25 m at 0.5 m/s", 0.25, 0.5);
    squeeze("to 0.1 m, less than the head, at 0.5 m/s", 0.1, 0.5);
    if (!quick_) squeeze("to nothing at 0.5 m/s", 0, 0.5);
    squeeze("to nothing at 5 m/s", 0, 5);
  }

  /// Bodies that start inside something.
  void overlapping() {
    const auto start = [&](const std::string& name, const std::string& pose,
                           const std::string& obstacle, double depth) {
      Extreme& e =
          add("overlapping at the start", name,
              humanScene(pose, "obstacles: [{type: plane, friction: 0.6}" + obstacle + "]\n"), 15);
      e.laws.energy_rise = kUnbounded;  // opening an overlap lifts
      e.laws.speed = 10;
      e.laws.depth = depth;
      e.laws.rest = true;
    };
    start("knee-deep in the floor", "position: [0, 0, 0.5]", "", 5e-3);
    // Chest and pelvis are rigid: what pushes their halves apart has no way out.
    start("a ball in its chest, no way out", "position: [0, 0, 0.98]",
          ", {type: sphere, position: [0.02, 0, 1.2], radius: 0.15}", 0.06);
    start("astride a box, no way out", "position: [0, -0.2, 0.13], rpy_deg: [0, -90, 90]",
          ", {type: box, position: [0, 0, 0], size: [0.1, 0.6, 0.3]}", 0.06);
  }

  bool quick_;
  std::vector<Extreme> tests_;
};

}  // namespace

std::vector<Extreme> extremeTests(bool quick) { return Tests(quick).all(); }

}  // namespace ragdoll::lab
