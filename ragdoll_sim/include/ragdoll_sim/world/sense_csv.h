// What sensors and contacts tell, as CSV: 17 significant digits, time [s] as step times step
// length.
#pragma once

#include <iosfwd>

#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/world/contacts.h"
#include "ragdoll_sim/world/imu.h"

namespace ragdoll {

/// time,sensor,ax,ay,az,gx,gy,gz,qx,qy,qz,qw
void writeImuHeader(std::ostream& out);
void writeImuRow(const Model& model, const ImuSample& sample, std::ostream& out);

/// time,ragdoll,body,other,x,y,z,nx,ny,nz,depth,fx,fy,fz,peak_force,impulse,slip
void writeContactHeader(std::ostream& out);
/// A row for each contact of the interval; forces are means over it.
void writeContactRows(const Model& model, const ContactReport& report, std::ostream& out);

}  // namespace ragdoll
