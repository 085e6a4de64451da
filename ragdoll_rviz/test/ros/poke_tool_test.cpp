// The tool in rviz itself, with the shipped configuration on a screen of its own: clicks where it
// is known what stands there, and what the node then hears.
#include <gtest/gtest.h>
#include <ragdoll_msgs/Model.h>
#include <ragdoll_msgs/Poke.h>
#include <ragdoll_msgs/PokeEvent.h>
#include <ragdoll_msgs/State.h>
#include <ros/ros.h>
#include <rviz/properties/property.h>
#include <rviz/render_panel.h>
#include <rviz/tool.h>
#include <rviz/tool_manager.h>
#include <rviz/view_controller.h>
#include <rviz/view_manager.h>
#include <rviz/visualization_frame.h>
#include <rviz/visualization_manager.h>
#include <std_srvs/Trigger.h>

#include <Eigen/Geometry>
#include <QDoubleSpinBox>
#include <QElapsedTimer>
#include <QMouseEvent>
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>

#include "qt_wait.h"
#include "rviz_main.h"

namespace {

using Eigen::Vector3d;
using ragdoll_test::kLimit;
using ragdoll_test::rviz_frame;
using ragdoll_test::waitFor;

constexpr double kYaw = 0.4, kPitch = 0.3, kDistance = 3, kFov = M_PI / 4;  ///< of the view


class PokeTool : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!frame_) GTEST_SKIP() << "no Xvfb";
    model_subscriber_ = nh_.subscribe<ragdoll_msgs::Model>(
        "/ragdoll/model", 1, [this](const ragdoll_msgs::Model::ConstPtr& m) { model_ = m; });
    state_subscriber_ = nh_.subscribe<ragdoll_msgs::State>(
        "/ragdoll/state", 1, [this](const ragdoll_msgs::State::ConstPtr& m) { state_ = m; });
    pokes_ = nh_.subscribe<ragdoll_msgs::PokeEvent>(
        "/ragdoll/pokes", 10, [this](const ragdoll_msgs::PokeEvent::ConstPtr& m) { poke_ = m; });
    rviz::ToolManager* tools = frame_->getManager()->getToolManager();
    for (int i = 0; i < tools->numTools(); ++i)
      if (tools->getTool(i)->getClassId() == "ragdoll_rviz/Poke") tool_ = tools->getTool(i);
    ASSERT_NE(tool_, nullptr);
    tools->setCurrentTool(tool_);
    // A reset is told to all; what has been heard here, the tool has heard too.
    std_srvs::Trigger reset;
    ASSERT_TRUE(ros::service::waitForService("/ragdoll/reset", kLimit));
    // roscpp now and then loses the answer of a call that has a connection of its own.
    reset_ = nh_.serviceClient<std_srvs::Trigger>("/ragdoll/reset", true);
    ASSERT_TRUE(waitFor([&] { return reset_.call(reset) && model_ && state_; }));
    // Once this poke has been told here, all that follow are.
    ragdoll_msgs::Poke poke;
    poke.request.body_name = "head";
    QElapsedTimer asked;
    ASSERT_TRUE(waitFor([&] {
      if (poke_ && poke_->force.x == poke.request.force.x) return true;
      if (asked.isValid() && asked.elapsed() < 500) return false;
      asked.start();
      poke.request.force.x += 1;
      ros::service::call("/ragdoll/poke", poke);
      return false;
    }));
    state_.reset();
    ASSERT_TRUE(reset_.call(reset));
    ASSERT_TRUE(waitFor([this] { return state_ != nullptr; }));
    panel_ = frame_->getManager()->getRenderPanel();
    ASSERT_TRUE(waitFor([this] { return panel_->height() > 400; }));
  }

  Vector3d at(const std::string& particle) const {
    const auto& names = model_->ragdolls[0].particles;
    const auto i = std::find(names.begin(), names.end(), particle) - names.begin();
    const auto& p = state_->ragdolls[0].positions.at(static_cast<std::size_t>(i));
    return {p.x, p.y, p.z};
  }

  /// The orbit view looks at this point, which then is in the middle of the picture.
  void lookAt(const Vector3d& point) {
    rviz::ViewController* view = frame_->getManager()->getViewManager()->getCurrent();
    view->subProp("Distance")->setValue(kDistance);
    view->subProp("Yaw")->setValue(kYaw);
    view->subProp("Pitch")->setValue(kPitch);
    rviz::Property* focus = view->subProp("Focal Point");
    focus->subProp("X")->setValue(point.x());
    focus->subProp("Y")->setValue(point.y());
    focus->subProp("Z")->setValue(point.z());
    int frames = 0;
    const auto counting = QObject::connect(
        frame_->getManager(), &rviz::VisualizationManager::preUpdate, [&] { ++frames; });
    EXPECT_TRUE(waitFor([&] { return frames > 3; }));  // the camera follows in an update
    QObject::disconnect(counting);
  }

  /// Clicks so many pixels beside the middle; the poke that the node then tells.
  ragdoll_msgs::PokeEvent click(int right, int down) {
    poke_.reset();
    press(right, down);
    EXPECT_TRUE(waitFor([this] { return poke_ != nullptr; }));
    return poke_ ? *poke_ : ragdoll_msgs::PokeEvent();
  }
  void press(int right, int down) {
    const QPoint point(panel_->width() / 2 + right, panel_->height() / 2 + down);
    for (const auto type : {QEvent::MouseButtonPress, QEvent::MouseButtonRelease}) {
      const bool pressed = type == QEvent::MouseButtonPress;
      QMouseEvent event(type, point, panel_->mapToGlobal(point), Qt::LeftButton,
                        pressed ? Qt::LeftButton : Qt::NoButton, Qt::NoModifier);
      QCoreApplication::sendEvent(panel_, &event);
    }
  }

  /// Where the eye looks, as REP-103's axes have it: forward, left and up of the view.
  static Eigen::Matrix3d axes() {
    const Vector3d forward(-std::cos(kYaw) * std::cos(kPitch), -std::sin(kYaw) * std::cos(kPitch),
                           -std::sin(kPitch));
    const Vector3d left = Vector3d::UnitZ().cross(forward).normalized();
    Eigen::Matrix3d r;
    r << forward, left, forward.cross(left);
    return r;
  }

  ros::NodeHandle nh_;
  ros::Subscriber model_subscriber_, state_subscriber_, pokes_;
  ros::ServiceClient reset_;
  ragdoll_msgs::Model::ConstPtr model_;
  ragdoll_msgs::State::ConstPtr state_;
  ragdoll_msgs::PokeEvent::ConstPtr poke_;
  rviz::VisualizationFrame* frame_ = rviz_frame;
  rviz::RenderPanel* panel_ = nullptr;
  rviz::Tool* tool_ = nullptr;
};

Vector3d vector(const geometry_msgs::Vector3& v) { return {v.x, v.y, v.z}; }

TEST_F(PokeTool, pokesWhatIsClickedAlongTheLineOfSightAsHardAsThePanelSays) {
  auto* strength = frame_->findChild<QDoubleSpinBox*>("strength");
  ASSERT_NE(strength, nullptr);
  EXPECT_EQ(strength->value(), 600);  // as the configuration has it

  // The middle of the picture: the middle of a forearm.
  const Vector3d elbow = at("right_elbow"), hand = at("right_hand");
  lookAt((elbow + hand) / 2);
  ragdoll_msgs::PokeEvent poke = click(0, 0);
  EXPECT_EQ(poke.body_name, "ragdoll/right_forearm");
  EXPECT_LT((vector(poke.force) - 600 * axes().col(0)).norm(), 600 * 0.01);
  EXPECT_LT(std::hypot(std::hypot(poke.point.x, poke.point.y), poke.point.z), 0.02);
  EXPECT_NEAR(poke.duration.toSec(), 0.1, 0.01);

  // Beside the middle: the angle of the pixel, half the picture's height being half the field of
  // view. A quarter of the forearm away from its middle.
  strength->setValue(250);
  const Vector3d aim = axes().transpose() * (hand - elbow) / 4;
  const double pixels = panel_->height() / 2.0 / std::tan(kFov / 2) / (kDistance + aim.x());
  const int right = static_cast<int>(std::lround(-aim.y() * pixels));
  const int down = static_cast<int>(std::lround(-aim.z() * pixels));
  ASSERT_GT(std::abs(right) + std::abs(down), 10);
  poke = click(right, down);
  EXPECT_EQ(poke.body_name, "ragdoll/right_forearm");
  const Vector3d direction = (axes() * (aim + kDistance * Vector3d::UnitX())).normalized();
  EXPECT_LT((vector(poke.force) - 250 * direction).norm(), 250 * 0.01);
  const Vector3d offset(poke.point.x, poke.point.y, poke.point.z);
  EXPECT_LT((offset - (hand - elbow) / 4).norm(), 0.02);
}

TEST_F(PokeTool, clickingBesideTheBodyPokesNothing) {
  lookAt(at("head") + Vector3d(0, 0, 3));
  poke_.reset();
  press(0, 0);
  // In order: when this one is told, that one would have been.
  lookAt(at("head"));
  EXPECT_EQ(click(0, 0).body_name, "ragdoll/head");
}

TEST_F(PokeTool, aNodeOfNoValidNameIsReported) {
  QString status;
  const auto listening =
      QObject::connect(frame_->getManager(), &rviz::VisualizationManager::statusUpdate,
                       [&](const QString& text) { status = text; });
  rviz::Property* node = tool_->getPropertyContainer()->subProp("Node");
  const QVariant name = node->getValue();
  for (const char* wrong : {"/rag doll", "~ragdoll", "?"}) {
    status.clear();
    node->setValue(wrong);
    EXPECT_TRUE(status.contains("no name of a node")) << status.toStdString();
  }
  QObject::disconnect(listening);
  node->setValue(name);
  lookAt(at("head"));
  // Paused, the node tells its state when something changes; then the tool has heard it, too.
  std_srvs::Trigger reset;
  state_.reset();
  ASSERT_TRUE(reset_.call(reset));
  ASSERT_TRUE(waitFor([this] { return state_ != nullptr; }));
  EXPECT_EQ(click(0, 0).body_name, "ragdoll/head");
}

}  // namespace

int main(int argc, char** argv) { return ragdoll_test::runInRviz(argc, argv, "poke_tool_test"); }
