#include "poke_tool.h"

#include <OgreCamera.h>
#include <OgreRay.h>
#include <OgreViewport.h>
#include <ragdoll_msgs/Poke.h>
#include <ros/exceptions.h>
#include <rviz/display_context.h>
#include <rviz/frame_manager.h>
#include <rviz/properties/float_property.h>
#include <rviz/properties/string_property.h>
#include <rviz/view_controller.h>
#include <rviz/view_manager.h>
#include <rviz/viewport_mouse_event.h>

#include <pluginlib/class_list_macros.hpp>

#include "ragdoll_sim/ros/any_model.h"

namespace ragdoll_rviz {
namespace {

Eigen::Vector3d toEigen(const Ogre::Vector3& v) { return {v.x, v.y, v.z}; }

}  // namespace

PokeTool::PokeTool() {
  shortcut_key_ = 'p';
  rviz::Property* parent = getPropertyContainer();
  node_ = new rviz::StringProperty("Node", "/ragdoll", "Name of the simulation's node.", parent);
  strength_ = new rviz::FloatProperty("Strength", 600, "Force of a poke [N].", parent);
  strength_->setMin(0);
  duration_ = new rviz::FloatProperty("Duration", 0.1f, "How long a poke lasts [s].", parent);
  duration_->setMin(0);
  connect(node_, &rviz::Property::changed, this, [this] {
    if (active_) subscribe();
  });
}

void PokeTool::activate() {
  active_ = true;
  setStatus("<b>Left-Click:</b> poke the body. <b>Other buttons:</b> move the camera.");
  subscribe();
}

void PokeTool::deactivate() {
  active_ = false;
  model_subscriber_.shutdown();
  state_subscriber_.shutdown();
}

void PokeTool::subscribe() {
  model_.reset();
  state_.reset();
  model_subscriber_.shutdown();
  state_subscriber_.shutdown();
  const std::string prefix = node_->getStdString() + "/";
  try {
    model_subscriber_ = ragdoll::subscribeToModels(
        nh_, prefix + "model", [this](const ragdoll_msgs::Model& m) { model_ = m; });
    state_subscriber_ = nh_.subscribe<ragdoll_msgs::State>(
        prefix + "state", 1, [this](const ragdoll_msgs::State::ConstPtr& m) { state_ = m; });
  } catch (const ros::InvalidNameException& e) {
    setStatus(QString("no name of a node: %1").arg(e.what()));
  }
}

int PokeTool::processMouseEvent(rviz::ViewportMouseEvent& event) {
  if (event.leftDown()) {
    if (!model_ || !state_)
      setStatus(QString("nothing heard of %1 yet").arg(node_->getString()));
    else if (const std::optional<Ray> ray = lineOfSight(event))
      poke(*ray);
    return Render;
  }
  if (event.left() || event.leftUp()) return 0;
  if (rviz::ViewController* view = context_->getViewManager()->getCurrent())
    view->handleMouseEvent(event);
  return 0;
}

std::optional<Ray> PokeTool::lineOfSight(const rviz::ViewportMouseEvent& event) {
  const float x =
      static_cast<float>(event.x) / static_cast<float>(event.viewport->getActualWidth());
  const float y =
      static_cast<float>(event.y) / static_cast<float>(event.viewport->getActualHeight());
  const Ogre::Ray sight = event.viewport->getCamera()->getCameraToViewportRay(x, y);
  Ogre::Vector3 position;  // of the world frame in rviz's fixed frame
  Ogre::Quaternion orientation;
  const std::string& world = state_->header.frame_id;
  if (!context_->getFrameManager()->getTransform(world, ros::Time(), position, orientation)) {
    setStatus(QString("no transform to %1").arg(QString::fromStdString(world)));
    return std::nullopt;
  }
  const Ogre::Quaternion back = orientation.Inverse();
  return Ray{toEigen(back * (sight.getOrigin() - position)),
             toEigen(back * sight.getDirection()).normalized()};
}

void PokeTool::poke(const Ray& ray) {
  const std::optional<Hit> hit = pick(ray, *model_, *state_);
  if (!hit) {
    setStatus("no body there");
    return;
  }
  const Eigen::Vector3d force = strength_->getFloat() * ray.direction;
  ragdoll_msgs::PokeRequest request;
  request.body_name = hit->body_name;
  request.reference_point.x = hit->offset.x();
  request.reference_point.y = hit->offset.y();
  request.reference_point.z = hit->offset.z();
  request.force.x = force.x();
  request.force.y = force.y();
  request.force.z = force.z();
  request.duration = ros::Duration(duration_->getFloat());
  caller_.call<ragdoll_msgs::Poke>(
      node_->getStdString() + "/poke", request, this,
      [this](const QString& problem, const ragdoll_msgs::PokeResponse& response) {
        setStatus(problem.isEmpty() ? QString::fromStdString(response.status_message) : problem);
      });
}

}  // namespace ragdoll_rviz

PLUGINLIB_EXPORT_CLASS(ragdoll_rviz::PokeTool, rviz::Tool)
