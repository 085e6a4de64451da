// A RigidScene in MuJoCo: written as MJCF, stepped, read back. Needs libmujoco-dev (2.2 or later).
#pragma once

#include <mujoco/mujoco.h>

#include <cstdio>
#include <cstring>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/rigid_bodies.h"

namespace ragdoll::test {

/// The tree of bodies as MJCF. Limits of cones are distances between the tips of two unit vectors
/// (a ball joint's own range would limit the twist as well, and a rod has none).
class MujocoText {
 public:
  MujocoText(const RigidScene& scene, double step, const std::string& integrator)
      : scene_(scene), visited_(scene.bodies.size(), false) {
    out_.precision(17);
    int root = 0;
    const RigidJoint* pin = nullptr;
    for (const RigidJoint& joint : scene.joints)
      if (joint.parent < 0) root = joint.child, pin = &joint;
    out_ << "<mujoco><compiler angle='radian' inertiafromgeom='false' autolimits='false'/>\n"
         << "<option timestep='" << step << "' integrator='" << integrator << "' gravity='"
         << scene.gravity.transpose() << "'/>\n<worldbody>\n";
    if (scene.floor)
      out_ << "<geom type='plane' size='0 0 1' contype='2' conaffinity='1' friction='"
           << scene.friction << " 0.005 0.0001'/>\n";
    body(root, -1, pin);
    out_ << "</worldbody>\n";
    if (!tendons_.empty()) out_ << "<tendon>\n" << tendons_ << "</tendon>\n";
    out_ << "</mujoco>\n";
  }
  std::string text() const { return out_.str(); }

 private:
  void joint(const RigidJoint& j, int child) {
    const Vec3 anchor = j.anchor - scene_.bodies[child].com;
    out_ << "<joint type='" << (j.hinge ? "hinge" : "ball") << "' pos='" << anchor.transpose()
         << "'";
    if (j.hinge) {
      // Seen from the parent the child turns about the axis; from the child the parent turns back.
      const double sign = child == j.child ? 1 : -1;
      out_ << " axis='" << (sign * j.axis).transpose() << "'";
      if (j.range)
        out_ << " limited='true' range='" << j.range->begin << " " << j.range->end << "'";
    }
    out_ << "/>\n";
  }

  /// The site on `body` that a cone's tendon ends at.
  void site(const RigidJoint& j, int body) {
    const Vec3 tip = j.anchor + (body == j.child ? j.bone : j.axis) - scene_.bodies[body].com;
    out_ << "<site name='" << j.name << (body == j.child ? "_bone" : "_axis") << "' pos='"
         << tip.transpose() << "'/>\n";
  }

  void body(int index, int parent, const RigidJoint* held_by) {
    visited_[index] = true;
    const RigidBody& b = scene_.bodies[index];
    const Quat& q = scene_.start.orientation;
    if (parent < 0) {
      out_ << "<body name='" << b.name << "' pos='" << scene_.startOf(index).position.transpose()
           << "' quat='" << q.w() << " " << q.x() << " " << q.y() << " " << q.z() << "'>\n";
    } else {
      out_ << "<body name='" << b.name << "' pos='"
           << (b.com - scene_.bodies[parent].com).transpose() << "'>\n";
    }
    if (held_by != nullptr)
      joint(*held_by, index);
    else
      out_ << "<freejoint/>\n";
    out_ << "<inertial pos='0 0 0' mass='" << b.mass << "' diaginertia='" << b.moments.transpose()
         << "' quat='" << b.axes.w() << " " << b.axes.x() << " " << b.axes.y() << " " << b.axes.z()
         << "'/>\n";
    if (scene_.floor)
      for (const int p : b.spheres)
        out_ << "<geom type='sphere' size='" << scene_.radius[p] << "' pos='"
             << (scene_.rest.col(p) - b.com).transpose()
             << "' contype='1' conaffinity='2' friction='" << scene_.friction
             << " 0.005 0.0001'/>\n";
    for (const RigidJoint& j : scene_.joints)
      if (j.half_angle && (j.parent == index || j.child == index)) {
        site(j, index);
        if (index != j.child) continue;
        std::ostringstream tendon;
        tendon.precision(17);
        tendon << "<spatial limited='true' range='0 " << 2 * std::sin(0.5 * *j.half_angle)
               << "'><site site='" << j.name << "_axis'/><site site='" << j.name
               << "_bone'/></spatial>\n";
        tendons_ += tendon.str();
      }
    for (const RigidJoint& j : scene_.joints) {
      if (j.parent < 0) continue;
      const int other = j.parent == index ? j.child : j.child == index ? j.parent : -1;
      if (other >= 0 && !visited_[other]) body(other, index, &j);
    }
    out_ << "</body>\n";
  }

  const RigidScene& scene_;
  std::vector<bool> visited_;
  std::ostringstream out_;
  std::string tendons_;
};

class MujocoSimulation {
 public:
  /// `integrator`: "Euler" or "RK4".
  MujocoSimulation(const RigidScene& scene, double step, const std::string& integrator) {
    mju_user_warning = [](const char*) {};  // else it writes a file; resets() counts
    const std::string text = MujocoText(scene, step, integrator).text();
    auto files = std::make_unique<mjVFS>();
    mj_defaultVFS(files.get());
    mj_makeEmptyFileVFS(files.get(), "scene.xml", static_cast<int>(text.size()));
    std::memcpy(files->filedata[mj_findFileVFS(files.get(), "scene.xml")], text.data(),
                text.size());
    char error[500] = "";
    model_ = mj_loadXML("scene.xml", files.get(), error, sizeof error);
    mj_deleteVFS(files.get());
    if (model_ == nullptr) throw std::runtime_error(std::string("MuJoCo: ") + error);
    data_ = mj_makeData(model_);
    for (const RigidBody& body : scene.bodies)
      ids_.push_back(mj_name2id(model_, mjOBJ_BODY, body.name.c_str()));
    mj_forward(model_, data_);
  }
  ~MujocoSimulation() {
    mj_deleteData(data_);
    mj_deleteModel(model_);
  }
  MujocoSimulation(const MujocoSimulation&) = delete;
  MujocoSimulation& operator=(const MujocoSimulation&) = delete;

  void step() { mj_step(model_, data_); }

  /// Brings poses up to the time that the last step reached.
  void settle() {
    mj_kinematics(model_, data_);
    mj_comPos(model_, data_);
    mj_comVel(model_, data_);
  }

  Pose pose(int body) const {
    const mjtNum* p = data_->xpos + 3 * ids_[body];
    const mjtNum* q = data_->xquat + 4 * ids_[body];
    return {Vec3(p[0], p[1], p[2]), Quat(q[0], q[1], q[2], q[3])};
  }

  /// Angular [rad/s] and linear [m/s] of the centre of mass, world.
  void velocity(int body, Vec3& angular, Vec3& linear) const {
    mjtNum v[6];
    mj_objectVelocity(model_, data_, mjOBJ_BODY, ids_[body], v, 0);
    angular = Vec3(v[0], v[1], v[2]);
    linear = Vec3(v[3], v[4], v[5]);
  }

  /// How often it has started over because numbers were bad.
  int resets() const {
    return data_->warning[mjWARN_BADQPOS].number + data_->warning[mjWARN_BADQVEL].number +
           data_->warning[mjWARN_BADQACC].number;
  }

 private:
  mjModel* model_ = nullptr;
  mjData* data_ = nullptr;
  std::vector<int> ids_;
};

}  // namespace ragdoll::test
