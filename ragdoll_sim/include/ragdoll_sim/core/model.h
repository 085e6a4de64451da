// The world's constants: what a Scene becomes once names are indices and everything that can be
// computed before the first step has been. Nothing here changes during a step.
//
// One formulation carries every method and every kind of inertia (docs/equations.md#formulation):
// X is 3 x n (one body's particles), M a constant n x n scalar mass matrix (times I3), W its
// inverse on the motions that are free (pins and rigid groups taken out), B one row per stick (d =
// X b^T). Then a stick impulse lambda moves the body by d lambda (b W), and J W J^T = G o (D^T D)
// with G = B W B^T.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ragdoll_sim/core/limit.h"
#include "ragdoll_sim/core/scene.h"
#include "ragdoll_sim/core/types.h"

namespace ragdoll {

struct Stick {
  int a = 0, b = 0;   ///< particles of the skeleton
  double length = 0;  ///< [m]
};

/// A stick between particles with their own masses.
struct RelaxedStick {
  int a, b;                 ///< columns
  double length;            ///< [m]
  double share_a, share_b;  ///< of the correction: w_a / (w_a + w_b), w_b / (w_a + w_b)
};

/// How a surface gives way.
struct Compliance {
  double compliance = 0;  ///< [m/N] 1 / stiffness; 0: rigid
  double damping = 0;     ///< [N s/m]
};

struct Segment {
  std::string name;
  std::vector<int> particles;  ///< a bone's from and to, or a group's
  bool group = false;
  Compliance contact;
  int carrier = -1;  ///< the unnamed particle that carries a flat group's inertia across its plane

  /// particles, and the carrier if there is one.
  std::vector<int> allParticles() const {
    std::vector<int> all = particles;
    if (carrier >= 0) all.push_back(carrier);
    return all;
  }
};

/// Particles that sticks (or a segment with mass) hold as one rigid body.
struct RigidGroup {
  std::vector<int> particles;  ///< ascending
  int rank = 3;                ///< 1: on a line, 2: in a plane, 3: a solid
};

/// A joint between two segments; constants of the rest pose are derived where it is evaluated.
struct Joint {
  std::string name;
  JointSpec::Type type;
  int parent = 0, child = 0;  ///< segments
  Vec3 axis;                  ///< rest pose, unit
  AngleRange range;           ///< [rad]
  double half_angle = 0;      ///< [rad]
  double twist = 0;           ///< [rad] hinge: how far the plane of bending may turn, <= pi / 2
  std::array<std::optional<AngleRange>, 3> planes;
  double stiffness, damping;  ///< [N m/rad], [N m s/rad]
};

/// A stick as a body that touches others, with the radii of its ends; a == b: a sphere.
struct Capsule {
  int a = 0, b = 0;  ///< particles of the skeleton
};

struct CapsulePair {
  int first = 0, second = 0;  ///< of Skeleton::capsules, first < second
};

struct LeftOutPair {
  enum class Why { kSharedParticle, kRigidGroup, kOverlapAtRest };
  int first = 0, second = 0;  ///< of Skeleton::capsules, first < second
  Why why = Why::kSharedParticle;
};

/// One model file, resolved. Shared by all ragdolls made from it.
struct Skeleton {
  std::string name;
  std::vector<std::string> particles;  ///< names
  Points rest;                         ///< [m] 3 x n
  Eigen::VectorXd radius;              ///< [m] n
  std::vector<Stick> sticks;           ///< in relaxation order (neighbours share no particle)
  std::vector<int>
      stick_order;  ///< sticks[k] is the k-th relaxed; stick_order[k] its place in the file
  std::vector<Stick>
      hidden_sticks;  ///< not in the file: hold what a group with mass needs beside them
  std::vector<Segment> segments;
  std::vector<Compliance> particle_contact;  ///< of the region of each that the file names
  std::vector<Compliance> stick_contact;     ///< as sticks
  std::vector<Joint> joints;
  std::vector<Limit> limits;             ///< of hinges and cones
  std::vector<PlaneLimit> plane_limits;  ///< of the thesis's planes
  std::vector<RigidGroup> groups;        ///< four particles or more, or fewer that are degenerate
  std::vector<Capsule> capsules;         ///< if the scene lets bodies touch each other
  std::vector<Compliance> capsule_contact;  ///< as capsules
  std::vector<CapsulePair> self_pairs;      ///< that may touch; if the scene has self_collision
  std::vector<LeftOutPair> left_out_pairs;
  Eigen::MatrixXd M;   ///< [kg] n x n, symmetric, positive definite
  bool lumped = true;  ///< M is diagonal

  /// All particles: the file's own first, then those added to carry a flat group's inertia.
  int size() const { return static_cast<int>(particles.size()); }
  int named = 0;                                ///< how many of them the file names: what users see
  std::vector<std::string> warnings;            ///< what the checks found and mended
  int particle(const std::string& name) const;  ///< index, -1 if there is none
  int segment(const std::string& name) const;   ///< index, -1 if there is none
  int joint(const std::string& name) const;     ///< index, -1 if there is none
  /// The segment that a contact of a particle (b < 0) or of a stick is of: of a particle the bone
  /// that ends there (a head, a hand, a foot), else the first that has it; -1: none.
  int region(int a, int b) const;
};

struct StickRows;  // stick_solver.h

/// Constants of the direct methods: rigid groups are held by frames, so that the sticks left are
/// independent (docs/equations.md#rigid-groups). s sticks, n particles.
struct DirectSystem {
  Eigen::MatrixXd B;           ///< s x n; stick vectors D = X B^T (3 x s)
  Eigen::MatrixXd W;           ///< [1/kg] n x n; keeps groups affine and pins still
  Eigen::MatrixXd BW;          ///< [1/kg] s x n
  Eigen::MatrixXd G;           ///< [1/kg] s x s; J W J^T = G o (D^T D)
  Eigen::VectorXd length;      ///< [m] s
  Eigen::RowVectorXd gravity;  ///< n; as System::gravity
  Eigen::MatrixXd pin_motion;  ///< p x n; as System::pin_motion
  Eigen::MatrixXd affine;      ///< n x n; X affine^T puts rigid groups back into affine shape
  double condition = 1;        ///< of G o (D^T D) at rest, scaled to a unit diagonal
  std::shared_ptr<const StickRows> rows;  ///< the same constants as the kernels want them
};

/// What a skeleton with a set of pinned particles gives the solvers. Shared by equal (skeleton,
/// pins).
struct System {
  int skeleton = 0;
  std::vector<int> pins;  ///< pinned particles of the skeleton, ascending
  Eigen::MatrixXd W;      ///< [1/kg] n x n inverse mass of the free motions; 0 rows at pins
  Eigen::RowVectorXd
      gravity;  ///< n; share of the gravity that each particle feels: 1, or 0 if pinned
  Eigen::MatrixXd
      pin_motion;      ///< p x n: how a displacement of each pin carries the particles along
  bool lumped = true;  ///< W is diagonal
  std::vector<RelaxedStick> relaxed;  ///< lumped: sticks that can move, in relaxation order
  std::vector<Stick> coupled;         ///< else: all sticks, in relaxation order,
  Eigen::MatrixXd relaxed_BW;         ///< else: B W of the skeleton's sticks (b - a)
  Eigen::VectorXd relaxed_G;          ///< and the diagonal of B W B^T
  DirectSystem direct;
};

struct Ragdoll {
  std::string name;
  int skeleton = 0;        ///< index into Model::skeletons
  int system = 0;          ///< index into Model::systems
  int first = 0;           ///< its particles are columns first ... first + n - 1 of the state
  bool compliant = false;  ///< the skeleton's contact regions give way
};

struct Obstacle {
  std::string name;
  ObstacleSpec::Type type;
  Pose pose;  ///< start pose; plane: z of the pose is its normal; capsule: z is its axis
  Vec3 half = Vec3::Zero();  ///< box: half edges [m]; capsule: (0, 0, half length)
  double radius = 0;         ///< sphere, capsule [m]
  double friction = 0, restitution = 0;
  std::string frame;
  Compliance contact;
};

struct Pin {
  int ragdoll = 0;
  int particle = 0;            ///< of the state (column)
  Vec3 target = Vec3::Zero();  ///< [m] start
  std::string frame;
};

/// What a force acts on: a particle, a bone or a rigid group of one ragdoll.
struct BodyRef {
  int ragdoll = 0;
  std::vector<int> particles;  ///< columns of the state that carry the force
  std::vector<double> weight;  ///< sums to 1; the body's own point is their weighted mean
};

/// A force for a time, in whole steps.
struct Poke {
  double start = 0;     ///< [s] of simulation time
  double duration = 0;  ///< [s]; 0: one step; < 0: until cleared
  BodyRef body;
  std::string body_name;
  Vec3 force = Vec3::Zero();  ///< [N] world
  Vec3 point = Vec3::Zero();  ///< [m] offset from the body's own point, world axes
};

/// A virtual inertial measurement unit. The segment's frame has its origin at a bone's `from`, or
/// at the mean of a group's particles, and the model's axes in the rest pose.
struct Sensor {
  std::string name;  ///< "<ragdoll>/<its own>"
  int ragdoll = 0, segment = 0;
  Vec3 position = Vec3::Zero();                         ///< [m] in the segment's frame
  Quat orientation = Quat::Identity();                  ///< sensor -> segment's frame
  std::uint64_t every = 1;                              ///< [steps] of a sample
  double accelerometer_noise = 0, gyroscope_noise = 0;  ///< standard deviation [m/s^2], [rad/s]
  double accelerometer_range = 0, gyroscope_range = 0;  ///< [m/s^2], [rad/s] each axis
  std::uint64_t seed = 0;
  bool twists = true;  ///< false: a bone, whose particles do not tell how it turns about its line
  std::string where;   ///< in the file
};

struct Model {
  Vec3 gravity = Vec3::Zero();
  std::vector<Skeleton> skeletons;
  std::vector<System> systems;
  std::vector<Ragdoll> ragdolls;
  std::vector<Obstacle> obstacles;
  std::vector<Pin> pins;
  std::vector<Poke> pokes;
  std::vector<Sensor> sensors;
  SolverSpec solver;
  bool self_collision = false, ragdoll_collision = false;
  bool compliant = false;                 ///< some contact with an obstacle gives way
  Points start_position, start_velocity;  ///< 3 x N
  Eigen::VectorXd radius;                 ///< N
  std::vector<std::string> warnings;      ///< what the checks found and mended, for the log
  std::vector<std::string> notes;         ///< what was decided that a user may want to know

  int size() const { return static_cast<int>(radius.size()); }
  const Skeleton& skeletonOf(const Ragdoll& r) const { return skeletons[r.skeleton]; }
  const System& systemOf(const Ragdoll& r) const { return systems[r.system]; }
};

/// "ragdoll/right_hand", "right_hand" (of the first ragdoll that has it) or a segment's name.
/// Throws Error that lists the valid names.
BodyRef findBody(const Model& model, const std::string& name);

}  // namespace ragdoll
