// What touched what, how hard: per contact over an interval of steps, as impacts that begin and
// end, and what is left for pins.
//
// The step tells what its contacts gave (core/contact_log.h). What a body's momentum changed by
// beyond that, gravity and pokes (energy that the step guard took out; all of it where a method
// keeps no account of its own) is spread over its contacts, the smallest change where each gives by
// its share and stays within friction's cone (cone_balance.h): so the sum of forces is exact. A
// body with pins has that rest on its pins. A sleeper is told what its state has of when it fell
// asleep, from other sleepers what is left of its weight, and its sum carries its weight. A
// function of states and inputs: the same whenever one begins to listen. docs/body.md#forces.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ragdoll_sim/core/contact_log.h"
#include "ragdoll_sim/core/inputs.h"
#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/state.h"

namespace ragdoll {

/// A contact over an interval; `impulse` of it is the sum, the rest is of the last step.
struct Touch {
  ContactImpulse contact;
  double peak_force = 0;  ///< [N] largest of a step
};

/// A touch that began fast; told when it begins, and once more when it is over: the touch ends, or
/// goes on for Contacts::kSettled since its largest force; what comes then is rest.
struct ImpactReport {
  std::uint32_t id = 0;  ///< by the step at whose end it began, whenever one began to listen
  bool over = false;
  std::uint64_t step = 0;  ///< at whose end this is told
  double time = 0;         ///< [s] the same
  ContactImpulse contact;  ///< as it began; once over: with the sum of its impulses
  double peak_force = 0;   ///< [N]
  double duration = 0;     ///< [s]
};

/// What was since the last one.
struct ContactReport {
  std::uint64_t step = 0;  ///< the last
  double time = 0;         ///< [s]
  double interval = 0;     ///< [s]
  std::vector<Touch> touches;
  std::vector<ImpactReport> impacts;
  std::vector<Vec3> on_obstacles, moments;  ///< [N s], [N m s] on each, about the world's origin
  std::vector<Vec3> on_pins;                ///< [N s] by the body on each pin
};

class Contacts {
 public:
  /// [s] after its largest force an impact is over.
  static constexpr double kSettled = 0.1;

  explicit Contacts(const Model& model);

  /// For Workspace::keepContacts.
  ContactLog& log() { return log_; }

  /// Before and after every step.
  void begin(const State& state);
  void end(const Model& model, const Inputs& inputs, const State& state);

  /// Of the last step.
  const std::vector<ContactImpulse>& last() const { return step_; }
  const std::vector<Vec3>& pinImpulses() const { return pins_; }

  ContactReport take();

  /// Where pins have changed, and velocities with them: the interval begins anew. Impacts go on.
  void restart(const Model& model);

  /// The model has changed, its bodies and obstacles have not.
  void forget() { still_.reset(); }

 private:
  struct Open {
    ImpactReport report;
    bool touched = false;
    bool pressed = false, told = false;
    std::uint64_t first = 0, hardest = 0;  ///< steps
  };

  bool nothingHappened(const Model& model, const Inputs& inputs, const State& state) const;
  Vec3 momentumOf(const Model& model, int ragdoll, const State& state) const;
  void merge();
  void balance(const Model& model, const Inputs& inputs, const State& state);
  void spread(const Model& model, const std::vector<Vec3>& rest);
  void putOnPins(const Model& model, const Inputs& inputs, const State& state);
  void collect(const Model& model, const State& state);
  void follow(const Model& model, const State& state);

  std::vector<Eigen::VectorXd> masses_;  ///< [kg] per ragdoll: row sums of M
  Points places_, before_;               ///< [m], [m/s] positions and velocities before the step
  std::vector<std::uint8_t> slept_;      ///< per ragdoll: when the step began; then all of it
  ContactLog log_;
  std::vector<ContactImpulse> step_;
  std::optional<State> still_;  ///< that step_ is of, where all slept and nothing happened
  std::vector<Vec3> pins_;
  std::vector<Open> open_;
  ContactReport report_;
};

/// [N] of a contact of a step of h [s]: of a spring also within it, else the mean.
double peakForce(const ContactImpulse& contact, double h);
/// A later part of a contact that `all`, in an order of its own, has already, or another one.
void addTouch(std::vector<Touch>& all, const Touch& next);
/// "left_foot", or "left_knee-left_foot" of a stick.
std::string particlesName(const Model& model, int ragdoll, const std::array<int, 2>& particles);
/// The segment that has the particles: "left_shank"; else their name.
std::string regionName(const Model& model, int ragdoll, const std::array<int, 2>& particles);
/// What the contact is with: the obstacle's name, or "ragdoll" and `body` of the other side.
std::string otherName(const Model& model, const ContactImpulse& contact,
                      std::string* body = nullptr);

}  // namespace ragdoll
