// The tool "Poke": a click pokes the body under the mouse along the line of sight.
#pragma once

#ifndef Q_MOC_RUN
#include <ragdoll_msgs/Model.h>
#include <ragdoll_msgs/State.h>
#include <ros/node_handle.h>
#include <ros/subscriber.h>
#include <rviz/tool.h>
#endif

#include <optional>

#include "caller.h"
#include "pick.h"

namespace rviz {
class FloatProperty;
class StringProperty;
}  // namespace rviz

namespace ragdoll_rviz {

class PokeTool : public rviz::Tool {
  Q_OBJECT

 public:
  PokeTool();

  void activate() override;
  void deactivate() override;
  int processMouseEvent(rviz::ViewportMouseEvent& event) override;

 private:
  void subscribe();
  void poke(const Ray& ray);
  /// In the world frame; nothing if rviz cannot transform to it.
  std::optional<Ray> lineOfSight(const rviz::ViewportMouseEvent& event);

  rviz::StringProperty* node_;
  rviz::FloatProperty *strength_, *duration_;
  ros::NodeHandle nh_;
  ros::Subscriber model_subscriber_, state_subscriber_;
  std::optional<ragdoll_msgs::Model> model_;
  ragdoll_msgs::State::ConstPtr state_;
  bool active_ = false;

  Caller caller_;  // last
};

}  // namespace ragdoll_rviz
