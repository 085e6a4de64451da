// A scene as its file says it: by name, nothing resolved. The io library fills it from YAML, tests
// and programs may fill it by hand; buildModel (model.h) checks it and turns names into indices.
// Every part carries `where`, the place in the user's file that an error message names.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ragdoll_sim/core/types.h"

namespace ragdoll {

struct ParticleSpec {
  std::string name;
  Vec3 position = Vec3::Zero();  ///< [m] rest pose in the model's frame: standing, facing +x, z up
  double mass = 0;               ///< [kg] lumped mass, added to what segments give
  double radius = 0;  ///< [m] collision sphere; sticks are capsules between their ends' radii
  std::string where;
};

struct StickSpec {
  std::string a, b;
  std::optional<double> length;  ///< [m]; from the rest positions if not given
  std::string where;
};

/// A spring and a damper between two surfaces.
struct ContactSpec {
  double stiffness = std::numeric_limits<double>::infinity();  ///< [N/m] infinite: rigid
  double damping = 0;                                          ///< [N s/m] with a stiffness only
};

/// A bone (two particles, from and to) or a rigid group (three or more).
struct SegmentSpec {
  std::string name;
  std::vector<std::string> particles;
  bool group = false;
  double mass = 0;   ///< [kg]; 0: only the name counts
  double com = 0.5;  ///< bone: centre of mass as a fraction of the length, from `from`
  double gyration =
      0;  ///< bone: radius of gyration about the centre of mass, fraction of the length
  Vec3 com_point = Vec3::Zero();  ///< group: centre of mass [m] in the model's frame
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< group: about its centre of mass [kg m^2]
  ContactSpec contact;  ///< of the body region, where the ragdoll is compliant
  std::string where;
};

struct AngleRange {
  double begin = 0, end = 0;  ///< [rad]
};

struct JointSpec {
  enum class Type { kHinge, kCone, kPlanes };
  std::string name;
  Type type = Type::kHinge;
  std::string parent, child;    ///< segments
  Vec3 axis = Vec3::UnitZ();    ///< hinge, cone: fixed in the parent, given in the rest pose
  AngleRange range;             ///< hinge
  double half_angle = 0;        ///< cone [rad]
  std::optional<double> twist;  ///< hinge [rad]: how far its plane may turn about the parent bone
  std::array<std::optional<AngleRange>, 3> planes;  ///< planes: XY, YZ, XZ of the parent
  double stiffness =
      std::numeric_limits<double>::infinity();  ///< [N m/rad]; infinite: a hard limit
  double damping = 0;                           ///< [N m s/rad], soft limits only
  std::string where;
};

struct SkeletonSpec {
  std::string name;  ///< "human", or the file's name
  std::vector<ParticleSpec> particles;
  std::vector<StickSpec> sticks;
  std::vector<SegmentSpec> segments;
  std::vector<JointSpec> joints;
  std::string where;
};

struct RagdollSpec {
  std::string name = "ragdoll";
  std::shared_ptr<const SkeletonSpec> skeleton;
  Pose pose;                                        ///< of the model's origin
  Vec3 velocity = Vec3::Zero();                     ///< [m/s]
  Vec3 angular_velocity = Vec3::Zero();             ///< [rad/s] about the centre of mass
  std::vector<std::pair<std::string, Vec3>> place;  ///< start of single particles [m], world
  int count = 0;                 ///< 0: one, named `name`; n: name_0 ... name_<n-1> on a grid
  Vec3 spacing = Vec3(2, 2, 0);  ///< [m] of that grid
  bool compliant = false;        ///< the model's contact regions give way; else they are rigid
  std::string where;
};

struct ObstacleSpec {
  std::string name;  ///< empty: "<type>_<number in the scene>"
  enum class Type { kPlane, kBox, kSphere, kCapsule };
  Type type = Type::kPlane;
  Pose pose;                    ///< box, sphere, plane (position only): in the world, or in `frame`
  Vec3 normal = Vec3::UnitZ();  ///< plane, unit, out of the solid
  Vec3 size = Vec3::Ones();     ///< box: edge lengths [m]
  double radius = 0;            ///< sphere, capsule [m]
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();  ///< capsule axis [m]
  double friction = 0.6;                        ///< Coulomb coefficient
  double restitution = 0;                       ///< in [0, 1]
  ContactSpec contact;
  std::string frame;  ///< TF frame it follows; empty: fixed in the world
  std::string where;
};

struct PinSpec {
  std::string particle;  ///< "ragdoll/right_hand", or "right_hand" of the first ragdoll
  std::string frame;     ///< TF frame it follows; empty: held where it starts
  std::string where;
};

struct PokeSpec {
  double at = 0;              ///< [s]
  std::string body;           ///< particle or segment, "ragdoll/right_hand" or "right_hand"
  Vec3 force = Vec3::Zero();  ///< [N] world
  Vec3 point = Vec3::Zero();  ///< [m] offset from the body's own point, world axes
  double duration = 0;        ///< [s]; 0: one step; < 0: for ever
  std::string where;
};

/// A virtual inertial measurement unit that sits on a segment.
struct SensorSpec {
  std::string name;
  std::string segment;                  ///< "torso" of the first ragdoll, or "ragdoll/torso"
  Vec3 position = Vec3::Zero();         ///< [m] in the segment's frame, see Sensor
  Quat orientation = Quat::Identity();  ///< sensor -> segment's frame
  double rate = 60;                     ///< [Hz]; a whole number of steps apart
  double accelerometer_noise = 0, gyroscope_noise = 0;  ///< standard deviation [m/s^2], [rad/s]
  double accelerometer_range = std::numeric_limits<double>::infinity();  ///< [m/s^2] each axis
  double gyroscope_range = std::numeric_limits<double>::infinity();      ///< [rad/s] each axis
  std::uint64_t seed = 0;
  std::string where;
};

enum class Method { kJakobsen, kShake, kRk, kFast };
enum class Numbers { kDouble, kFloat };
enum class Integrator { kVerlet, kEuler, kSymplecticEuler, kMidpoint, kVelocityVerlet };

/// Every knob of the solver; presets are values of this struct (solver_presets.h).
struct SolverSpec {
  std::string preset = "balanced";
  Method method = Method::kJakobsen;
  Integrator integrator = Integrator::kVerlet;  ///< jakobsen: free motion
  double step = 1.0 / 60;                       ///< [s] in (0, 1]
  int sweeps = 10;                              ///< jakobsen: relaxation sweeps per step, >= 1
  double tolerance = 0;  ///< shake, rk: [m] of error per simulated second; 0: fixed step
  bool events = false;   ///< rk: from event to event through limits and contacts, at 20x the cost
  double damping = 0;    ///< [1/s] velocity decay rate, >= 0
  double joint_damping = 0;  ///< [1/s] decay rate of motion within a body (joint_damping.h), >= 0
  bool sleep = true;         ///< bodies at rest stop moving and costing until disturbed (sleep.h)
  Numbers numbers = Numbers::kDouble;  ///< fast: what it computes with
  int threads = 1;  ///< of one step of the whole scene, 0: all cores; the same bits for any number
  std::string where;
};

struct Scene {
  Vec3 gravity = Vec3(0, 0, -9.81);  ///< [m/s^2]
  std::vector<RagdollSpec> ragdolls;
  std::vector<ObstacleSpec> obstacles;
  std::vector<PinSpec> pins;
  std::vector<PokeSpec> pokes;
  std::vector<SensorSpec> sensors;
  bool self_collision = false;
  bool ragdoll_collision = false;
  SolverSpec solver;
  std::string coat = "capsules";  ///< none | sticks | boxes | capsules | skin
  std::string text;   ///< the scene's full YAML, models inlined, so that it stands alone
  std::string where;  ///< file
};

}  // namespace ragdoll
