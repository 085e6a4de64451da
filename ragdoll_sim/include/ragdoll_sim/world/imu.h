// Virtual inertial measurement units: what sensors on the bodies would say, from states alone.
//
// A sample is the mean over the steps that it spans, in the sensor's frame:
//   specific force    (v1 - v0) / h - g, with the sensor's own velocity v at the states: exact
//                     through an impact, however short. In the frame as it stands when the velocity
//                     changes: where in the step that is follows from how far the sensor came
//   angular velocity  the turn between the states over h, in the frame in the middle of the step;
//                     of a bone the turn of its line, since two particles do not tell how it
//                     turns about that
// then noise, then saturation. A function of the sequence of states: the same run gives the same
// bits, whoever listens; the noise depends on the sensor's name, its seed and the sample's number.
// docs/body.md#virtual-imus.
#pragma once

#include <cstdint>
#include <vector>

#include "ragdoll_sim/body/frames.h"
#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/state.h"

namespace ragdoll {

struct ImuSample {
  int sensor = 0;                        ///< of Model::sensors
  std::uint64_t step = 0;                ///< at which the sample ends
  double time = 0;                       ///< [s] the same
  Vec3 acceleration = Vec3::Zero();      ///< [m/s^2] specific force in the sensor's frame
  Vec3 angular_velocity = Vec3::Zero();  ///< [rad/s] in the sensor's frame
  Pose pose;                             ///< of the sensor at the sample's end, in the world
};

class Imus {
 public:
  /// Of the model's sensors. Throws Error for a segment that no frame turns with.
  explicit Imus(const Model& model);

  bool empty() const { return mounts_.empty(); }

  /// A start, or a jump: samples begin with the state's step, if one does there, or the next.
  void reset(const State& state);

  /// After every step of the model: `state` is the next one. Appends the samples that end here, in
  /// the order of the sensors.
  void update(const Model& model, const State& state, std::vector<ImuSample>& samples);

  /// Of the sensor in the world at the last state.
  const Pose& pose(int sensor) const { return mounts_[sensor].now.pose; }
  /// [m/s] the same.
  const Vec3& velocity(int sensor) const { return mounts_[sensor].now.velocity; }

 private:
  /// At one state, in the world.
  struct Look {
    Pose pose;                      ///< of the sensor
    Quat part;                      ///< orientation of what it rides on
    Vec3 direction = Vec3::Zero();  ///< bone: unit
    Vec3 velocity = Vec3::Zero();   ///< [m/s] of the sensor
    Vec3 spin = Vec3::Zero();       ///< [rad/s] of what it rides on
  };
  struct Mount {
    Sensor sensor;
    std::vector<int> particles;  ///< of the part that it rides on, columns of the state
    bool group = false;
    int part = 0;                        ///< among all the tracker's
    Vec3 offset = Vec3::Zero();          ///< [m] from the part's anchor, in its frame
    Vec3 rest_direction = Vec3::Zero();  ///< bone: unit
    std::uint64_t stream = 0;            ///< of its noise
    Look now;                            ///< at the last state
    std::uint64_t steps = 0;             ///< in the means
    bool whole = false;                  ///< the sample began with its first step
    Vec3 acceleration = Vec3::Zero(), turn = Vec3::Zero();  ///< means so far
  };

  void mount(const Model& model, const Sensor& sensor);
  Look look(const State& state, const Mount& mount) const;
  static void add(const Model& model, const Look& next, Mount& mount);
  static void begin(Mount& mount, bool whole);
  ImuSample finish(int sensor, const State& state) const;

  FrameTracker tracker_;
  std::vector<Mount> mounts_;
};

/// The body's frame that a sensor turns with, and where the sensor is in it.
struct SensorFrame {
  int frame = -1;  ///< of the tracker; -1: none turns with it
  Pose local;
};
SensorFrame sensorFrame(const Model& model, const FrameTracker& tracker, const Sensor& sensor);

/// Throws Error for a sensor whose frame would be one of the body's.
void checkSensorNames(const Model& model, const FrameTracker& tracker);

/// So many normally distributed numbers of mean 0 and deviation 1 as the stream's n-th draw: the
/// same bits on every machine.
void normalNumbers(std::uint64_t stream, std::uint64_t n, int count, double* out);

}  // namespace ragdoll
