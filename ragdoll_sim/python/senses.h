// What a world's contacts and sensors tell, as structured arrays.
#pragma once

#include <vector>

#include "common.h"
#include "ragdoll_sim/world/contacts.h"
#include "ragdoll_sim/world/imu.h"

namespace ragdoll::python {

/// ragdoll, body, other; position, normal, depth, force, peak_force, impulse, slip
py::object contactArray(const Model& model, const ContactReport& report);
/// time, sensor, acceleration, angular_velocity, orientation (x, y, z, w)
py::object imuArray(const Model& model, const std::vector<ImuSample>& samples);

}  // namespace ragdoll::python
