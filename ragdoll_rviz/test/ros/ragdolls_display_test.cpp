// The display in rviz itself, with the shipped configuration on a screen of its own: what it draws
// where, and which pixels show it.
#include <OgreHardwarePixelBuffer.h>
#include <OgreRenderWindow.h>
#include <OgreSceneNode.h>
#include <gtest/gtest.h>
#include <ragdoll_msgs/LoadScene.h>
#include <ragdoll_msgs/Model.h>
#include <ragdoll_msgs/State.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>
#include <rviz/display.h>
#include <rviz/display_group.h>
#include <rviz/properties/status_list.h>
#include <rviz/render_panel.h>
#include <rviz/view_controller.h>
#include <rviz/view_manager.h>
#include <rviz/visualization_frame.h>
#include <rviz/visualization_manager.h>

#include <Eigen/Geometry>
#include <QColor>
#include <QRegularExpression>
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "qt_wait.h"
#include "ragdoll_sim/body/coat_mesh.h"
#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "rviz_main.h"

namespace {

using Eigen::Vector3d;
using ragdoll_test::rviz_frame;
using ragdoll_test::waitFor;

class Ragdolls : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!rviz_frame) GTEST_SKIP() << "no Xvfb";
    manager_ = rviz_frame->getManager();
    rviz::DisplayGroup* root = manager_->getRootDisplayGroup();
    for (int i = 0; i < root->numDisplays(); ++i)
      if (root->getDisplayAt(i)->getClassId() == "ragdoll_rviz/Ragdolls")
        display_ = root->getDisplayAt(i);
    ASSERT_NE(display_, nullptr);
    if (!model_subscriber_) subscribe();
    ASSERT_TRUE(waitFor([&] { return model_ && state_; }));
    for (const auto& [name, value] : std::vector<std::pair<const char*, const char*>>{
             {"Coat", "node's"}, {"Colors", "own"}, {"Node", "/ragdoll"}})
      set(name, value);
    set("Alpha", 1);
    ASSERT_TRUE(waitFor([&] { return triangles() > 0; })) << status();
  }

  /// Once. Paused, the node tells a state to who is new, and the display is there already: a reset
  /// tells it to all.
  void subscribe() {
    model_subscriber_ = nh_.subscribe("/ragdoll/model", 1, &Ragdolls::hearModel);
    state_subscriber_ = nh_.subscribe("/ragdoll/state", 1, &Ragdolls::hearState);
    ASSERT_TRUE(ros::service::waitForService("/ragdoll/reset", ragdoll_test::kLimit));
    std_srvs::Trigger reset;
    ASSERT_TRUE(ros::service::call("/ragdoll/reset", reset) && reset.response.success);
  }

  static void TearDownTestSuite() {
    model_subscriber_.shutdown();
    state_subscriber_.shutdown();
  }

  static void hearModel(const ragdoll_msgs::Model::ConstPtr& m) { model_ = m; }
  static void hearState(const ragdoll_msgs::State::ConstPtr& m) { state_ = m; }

  void set(const char* property, const QVariant& value) {
    display_->subProp(property)->setValue(value);
  }
  /// "1, 2856 triangles"
  std::string status(const char* of = "Bodies") const {
    for (int i = 0; i < display_->numChildren(); ++i) {
      rviz::Property* list = display_->childAt(i);
      if (!list->getName().startsWith("Status")) continue;  // "Status: Ok"
      for (int k = 0; k < list->numChildren(); ++k)
        if (list->childAt(k)->getName() == of)
          return list->childAt(k)->getValue().toString().toStdString();
    }
    return "";
  }
  int number(int which) const {
    auto match = QRegularExpression("\\d+").globalMatch(QString::fromStdString(status()));
    for (int i = 0; match.hasNext(); ++i) {
      const int value = match.next().captured().toInt();
      if (i == which) return value;
    }
    return -1;
  }
  int bodies() const { return number(0); }
  int triangles() const { return number(1); }

  Vector3d at(const std::string& particle) const {
    const auto& names = model_->ragdolls[0].particles;
    const auto i = std::find(names.begin(), names.end(), particle) - names.begin();
    const auto& p = state_->ragdolls[0].positions.at(static_cast<std::size_t>(i));
    return {p.x, p.y, p.z};
  }
  void pictures(int wanted) {
    int frames = 0;
    const auto counting = QObject::connect(
        manager_, &rviz::VisualizationManager::preUpdate, [&] { ++frames; });
    EXPECT_TRUE(waitFor([&] { return frames > wanted; }));
    QObject::disconnect(counting);
  }
  void lookAt(const Vector3d& point, double distance) {
    rviz::ViewController* view = manager_->getViewManager()->getCurrent();
    view->subProp("Distance")->setValue(distance);
    rviz::Property* focus = view->subProp("Focal Point");
    focus->subProp("X")->setValue(point.x());
    focus->subProp("Y")->setValue(point.y());
    focus->subProp("Z")->setValue(point.z());
    pictures(3);
  }
  /// The pixel in the middle of the picture, once a picture with all changes is there.
  QColor middle() {
    pictures(3);
    Ogre::RenderWindow* window = manager_->getRenderPanel()->getRenderWindow();
    const auto width = window->getWidth(), height = window->getHeight();
    std::vector<std::uint8_t> bytes(3 * width * height);
    const Ogre::PixelBox box(width, height, 1, Ogre::PF_BYTE_RGB, bytes.data());
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"  // the OGRE of ROS Noetic has no other
    window->copyContentsToMemory(box, Ogre::RenderTarget::FB_AUTO);
#pragma GCC diagnostic pop
    const std::size_t i = 3 * (height / 2 * width + width / 2);
    return {bytes[i], bytes[i + 1], bytes[i + 2]};
  }
  static bool isBackground(const QColor& c) { return c == QColor(232, 235, 239); }

  /// Around all that the display draws, in its frame.
  Ogre::AxisAlignedBox drawn() const {
    Ogre::AxisAlignedBox all;
    Ogre::SceneNode* node = display_->getSceneNode();
    for (unsigned short i = 0; i < node->numAttachedObjects(); ++i)
      if (node->getAttachedObject(i)->getVisible()) all.merge(node->getAttachedObject(i)->getBoundingBox());
    return all;
  }
  bool load(const std::string& yaml) {
    ragdoll_msgs::LoadScene call;
    call.request.yaml = yaml;
    // roscpp now and then loses the answer of a call that has a connection of its own.
    auto service = nh_.serviceClient<ragdoll_msgs::LoadScene>("/ragdoll/load_scene", true);
    const auto before = model_;
    return waitFor([&] { return service.call(call) && call.response.success; }) &&
           waitFor([&] { return model_ != before && state_->ragdolls.size() == model_->ragdolls.size(); });
  }

  ros::NodeHandle nh_;
  inline static ros::Subscriber model_subscriber_, state_subscriber_;
  inline static ragdoll_msgs::Model::ConstPtr model_;
  inline static ragdoll_msgs::State::ConstPtr state_;
  rviz::VisualizationManager* manager_ = nullptr;
  rviz::Display* display_ = nullptr;
};

TEST_F(Ragdolls, drawsTheBodyWhereTheStateHasIt) {
  Eigen::AlignedBox3d particles;
  for (const auto& p : state_->ragdolls[0].positions) particles.extend(Vector3d(p.x, p.y, p.z));
  ASSERT_TRUE(waitFor([&] { return drawn().isFinite(); }));
  const Ogre::AxisAlignedBox box = drawn();
  constexpr double kThick = 0.25;  // [m] of flesh around particles at most, and less than nothing
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    EXPECT_LT(box.getMinimum()[i], particles.min()[axis] + 0.05);
    EXPECT_GT(box.getMinimum()[i], particles.min()[axis] - kThick);
    EXPECT_GT(box.getMaximum()[i], particles.max()[axis] - 0.05);
    EXPECT_LT(box.getMaximum()[i], particles.max()[axis] + kThick);
  }
}

TEST_F(Ragdolls, pixelsShowItInItsColors) {
  const Vector3d thigh = (at("left_leg") + at("left_knee")) / 2;
  lookAt(thigh + Vector3d(0, 0, 5), 2);
  EXPECT_TRUE(isBackground(middle())) << middle().name().toStdString();
  lookAt(thigh, 2);
  const QColor trousers = middle();  // 0.30, 0.34, 0.46 in some light
  EXPECT_FALSE(isBackground(trousers));
  EXPECT_NEAR(trousers.redF() / trousers.blueF(), 0.30 / 0.46, 0.05);
  EXPECT_NEAR(trousers.greenF() / trousers.blueF(), 0.34 / 0.46, 0.05);

  set("Colors", "one");
  set("Color", QColor(200, 40, 20));
  const QColor red = middle();
  EXPECT_NEAR(red.greenF() / red.redF(), 0.2, 0.03);
  EXPECT_NEAR(red.blueF() / red.redF(), 0.1, 0.03);

  set("Alpha", 0.5);
  const QColor half = middle();  // two layers, its front and, hidden by culling, its back
  EXPECT_GT(half.green(), red.green() + 40);
  set("Alpha", 0);
  EXPECT_TRUE(isBackground(middle())) << middle().name().toStdString();
}

TEST_F(Ragdolls, wearsEachCoat) {
  const ragdoll::Model model = ragdoll::buildModel(ragdoll::parseScene(model_->scene_yaml));
  const ragdoll::FrameTree tree = ragdoll::buildFrameTree(model.skeletons[0]);
  lookAt(at("head"), 2);  // near: nothing is left out
  for (const std::string name : {"sticks", "boxes", "skin", "capsules"}) {
    const ragdoll::CoatMesh coat(ragdoll::coatKind(name), model.skeletons[0], tree);
    set("Coat", name.c_str());
    EXPECT_TRUE(waitFor([&] {
      return triangles() == static_cast<int>(coat.rest().triangles.size());
    })) << name << ": " << status();
  }
  set("Coat", "none");
  EXPECT_TRUE(waitFor([&] { return triangles() == 0; }));
  EXPECT_TRUE(isBackground(middle()));
}

TEST_F(Ragdolls, fromAfarWithFewerTrianglesAndJustAsVisible) {
  const Vector3d chest = (at("left_shoulder") + at("right_hip")) / 2;
  lookAt(chest, 2);
  const int all = triangles();
  lookAt(chest, 40);
  EXPECT_TRUE(waitFor([&] { return triangles() < all / 4; })) << status();
  EXPECT_FALSE(isBackground(middle()));
}

TEST_F(Ragdolls, manyBodiesAndAnotherModelAtOnce) {
  const std::string before = model_->scene_yaml;
  ASSERT_TRUE(load("ragdolls:\n"
                   "  - {name: a, model: human, count: 60, spacing: [1, 1, 0]}\n"
                   "  - {name: b, model: human_thesis, count: 3, position: [0, 0, 9]}\n"
                   "solver: {preset: fast}\n"));
  EXPECT_TRUE(waitFor([&] { return bodies() == 63; })) << status();
  ASSERT_TRUE(load(before));
  EXPECT_TRUE(waitFor([&] { return bodies() == 1; })) << status();
}

TEST_F(Ragdolls, saysWhatIsMissing) {
  set("Node", "/nobody");
  EXPECT_TRUE(waitFor([&] { return status() == "nothing heard of /nobody yet"; })) << status();
  EXPECT_FALSE(drawn().isFinite());
  set("Node", "/rag doll");
  EXPECT_TRUE(waitFor([&] { return status().find("no name of a node") == 0; })) << status();
  set("Node", "/ragdoll");
  // The connection is this test's own, too: for the node nobody is new.
  std_srvs::Trigger reset;
  auto service = nh_.serviceClient<std_srvs::Trigger>("/ragdoll/reset", true);
  EXPECT_TRUE(waitFor([&] { return bodies() == 1 || (service.call(reset) && bodies() == 1); }))
      << status();
  display_->setEnabled(false);
  pictures(3);
  EXPECT_FALSE(drawn().isFinite());
  display_->setEnabled(true);
  EXPECT_TRUE(waitFor([&] { return bodies() == 1 && drawn().isFinite(); })) << status();
  manager_->setFixedFrame("nowhere");
  EXPECT_TRUE(waitFor([&] { return status("Frame") == "no transform from world to nowhere"; }));
  EXPECT_FALSE(drawn().isFinite());
  manager_->setFixedFrame("world");
  EXPECT_TRUE(waitFor([&] { return drawn().isFinite(); }));
}

}  // namespace

int main(int argc, char** argv) { return ragdoll_test::runInRviz(argc, argv, "ragdolls_display_test"); }
