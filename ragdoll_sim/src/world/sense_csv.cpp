#include "ragdoll_sim/world/sense_csv.h"

#include <cstdio>
#include <ostream>
#include <string>

#include "ragdoll_sim/io/csv.h"

namespace ragdoll {
namespace {

void append(const Vec3& v, std::string& row) {
  for (int axis = 0; axis < 3; ++axis) appendCsv(v[axis], row);
}

/// The first column, which no comma comes before.
std::string timeText(const Model& model, std::uint64_t step) {
  std::string row;
  appendCsv(static_cast<double>(step) * model.solver.step, row);
  return row.substr(1);
}

}  // namespace

void writeImuHeader(std::ostream& out) { out << "time,sensor,ax,ay,az,gx,gy,gz,qx,qy,qz,qw\n"; }

void writeImuRow(const Model& model, const ImuSample& sample, std::ostream& out) {
  std::string row = timeText(model, sample.step) + "," + model.sensors[sample.sensor].name;
  append(sample.acceleration, row);
  append(sample.angular_velocity, row);
  const Quat& q = sample.pose.orientation;
  for (const double c : {q.x(), q.y(), q.z(), q.w()}) appendCsv(c, row);
  out << row << '\n';
}

void writeContactHeader(std::ostream& out) {
  out << "time,ragdoll,body,other,x,y,z,nx,ny,nz,depth,fx,fy,fz,peak_force,impulse,slip\n";
}

void writeContactRows(const Model& model, const ContactReport& report, std::ostream& out) {
  for (const Touch& touch : report.touches) {
    const ContactImpulse& c = touch.contact;
    std::string body;
    std::string other = otherName(model, c, &body);
    if (!body.empty()) other += "/" + body;
    std::string row = timeText(model, report.step) + "," + model.ragdolls[c.ragdoll].name + "," +
                      particlesName(model, c.ragdoll, c.particle) + "," + other;
    append(c.point, row);
    append(c.normal, row);
    appendCsv(c.depth, row);
    append(c.impulse / report.interval, row);
    for (const double value : {touch.peak_force, c.impulse.norm(), c.slip}) appendCsv(value, row);
    out << row << '\n';
  }
}

}  // namespace ragdoll
