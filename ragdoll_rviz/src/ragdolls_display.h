// The display "Ragdolls": draws the bodies that ~model and ~state tell of, however many, itself.
#pragma once

#ifndef Q_MOC_RUN
#include <OgreMaterial.h>
#include <OgreMatrix4.h>
#include <OgreVector3.h>
#include <dynamic_reconfigure/Config.h>
#include <ragdoll_msgs/State.h>
#include <ros/message_event.h>
#include <ros/subscriber.h>
#include <rviz/display.h>

#include "body_batch.h"
#include "ragdoll_sim/core/model.h"
#include "ragdoll_sim/core/scene.h"
#include "ragdoll_sim/core/state.h"
#include "ragdoll_sim/ros/any_model.h"
#endif

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace rviz {
class ColorProperty;
class EnumProperty;
class FloatProperty;
class StringProperty;
}  // namespace rviz

namespace ragdoll_rviz {

class RagdollsDisplay : public rviz::Display {
  Q_OBJECT

 public:
  RagdollsDisplay();
  ~RagdollsDisplay() override;

  void update(float wall_dt, float ros_dt) override;
  void reset() override;
  void setTopic(const QString& topic, const QString& datatype) override;

 protected:
  void onInitialize() override;
  void onEnable() override;
  void onDisable() override;
  void fixedFrameChanged() override;

 private:
  /// What the picture depends on beside the bodies.
  struct View {
    Ogre::Vector3 eye = Ogre::Vector3::ZERO;  ///< in the bodies' frame [m]
    float scale = 0;           ///< [pixels] of 1 m: at a distance of 1 m, or at any
    bool perspective = true;
    bool operator==(const View& o) const {
      return eye == o.eye && scale == o.scale && perspective == o.perspective;
    }
  };

  void subscribe();
  void unsubscribe();
  void hearModel(const ros::MessageEvent<ragdoll::AnyModel const>& event);
  void hearState(const ragdoll_msgs::State& message);
  void hearSettings(const dynamic_reconfigure::Config& message);
  void forgetBodies();

  void changeNode();
  void changeCoat();
  void changeColors();
  void changeAlpha();

  ragdoll::CoatKind coat() const;
  void dress();
  bool placeInFixedFrame();
  std::optional<View> view() const;
  void draw(const View& view);
  std::size_t levelOf(const Ogre::Vector3& place, const View& view) const;
  void showCount();

  rviz::StringProperty* node_;
  rviz::EnumProperty *coat_, *colors_;
  rviz::ColorProperty* color_;
  rviz::FloatProperty* alpha_;

  std::vector<ros::Subscriber> subscribers_;
  std::string node_coat_;  ///< ~coat; empty: the scene's
  std::string world_frame_;
  std::shared_ptr<const ragdoll::Scene> scene_;
  std::unique_ptr<ragdoll::Model> world_;
  ragdoll::State state_;
  std::uint32_t run_ = 0;
  bool heard_ = false;    ///< a state of the present model
  bool changed_ = false;  ///< since the last picture
  std::optional<ragdoll::FrameTracker> tracker_;

  Ogre::MaterialPtr material_;
  /// Per skeleton, from the finest on; empty: to be made.
  std::vector<std::vector<std::unique_ptr<BodyBatch>>> batches_;
  bool placed_ = false;  ///< in rviz's fixed frame
  View drawn_;
  QString count_;
};

}  // namespace ragdoll_rviz
