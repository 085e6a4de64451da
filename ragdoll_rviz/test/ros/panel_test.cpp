// The panel against a running node, without a screen: its buttons are clicked as a user would.
#include "panel.h"

#include <gtest/gtest.h>
#include <ragdoll_msgs/ContactStates.h>
#include <ragdoll_msgs/Impact.h>
#include <ragdoll_msgs/LoadScene.h>
#include <ragdoll_msgs/Model.h>
#include <ragdoll_msgs/State.h>
#include <ros/callback_queue.h>
#include <ros/master.h>
#include <ros/package.h>
#include <ros/ros.h>
#include <rviz/config.h>
#include <rviz/panel.h>
#include <rviz/tool.h>
#include <std_srvs/Trigger.h>

#include <QApplication>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QSpinBox>
#include <atomic>
#include <functional>
#include <memory>
#include <pluginlib/class_loader.hpp>
#include <thread>

#include "qt_wait.h"

namespace ragdoll_test {

/// ragdoll_msgs/Model before RagdollModel.mass, without bodies.
struct ModelOfBefore {
  ragdoll_msgs::Model model;
};

}  // namespace ragdoll_test

namespace ros {
namespace message_traits {

template <>
struct MD5Sum<ragdoll_test::ModelOfBefore> {
  static const char* value() { return "90718b455b603a4402841136096aae23"; }
  static const char* value(const ragdoll_test::ModelOfBefore&) { return value(); }
};
template <>
struct DataType<ragdoll_test::ModelOfBefore> : DataType<ragdoll_msgs::Model> {
  static const char* value() { return DataType<ragdoll_msgs::Model>::value(); }
  static const char* value(const ragdoll_test::ModelOfBefore&) { return value(); }
};
template <>
struct Definition<ragdoll_test::ModelOfBefore> {
  static const char* value() { return ""; }
  static const char* value(const ragdoll_test::ModelOfBefore&) { return value(); }
};

}  // namespace message_traits
namespace serialization {

/// Without bodies the bytes of both versions are the same.
template <>
struct Serializer<ragdoll_test::ModelOfBefore> {
  template <class Stream>
  static void write(Stream& stream, const ragdoll_test::ModelOfBefore& m) {
    Serializer<ragdoll_msgs::Model>::write(stream, m.model);
  }
  static std::uint32_t serializedLength(const ragdoll_test::ModelOfBefore& m) {
    return Serializer<ragdoll_msgs::Model>::serializedLength(m.model);
  }
};

}  // namespace serialization
}  // namespace ros

namespace {

using ragdoll_rviz::RagdollPanel;
using ragdoll_test::kLimit;
using ragdoll_test::waitFor;

class Panel : public ::testing::Test {
 protected:
  template <class Widget>
  Widget* find(const char* name) {
    auto* widget = panel_.findChild<Widget*>(name);
    EXPECT_NE(widget, nullptr) << name;
    return widget;
  }
  void click(const char* name) { find<QPushButton>(name)->click(); }
  bool says(const char* label, const char* text) {
    return waitFor([&] { return find<QLabel>(label)->text().contains(text); });
  }

  void SetUp() override {
    state_ = nh_.subscribe<ragdoll_msgs::State>(
        "/ragdoll/state", 10, [this](const ragdoll_msgs::State::ConstPtr& m) { last_ = m; });
    model_ = nh_.subscribe<ragdoll_msgs::Model>(
        "/ragdoll/model", 10, [this](const ragdoll_msgs::Model::ConstPtr& m) { scene_ = m; });
    ASSERT_TRUE(ros::service::waitForService("/ragdoll/reset", kLimit));
    ASSERT_TRUE(waitFor([&] { return last_ && scene_; }));
    ASSERT_TRUE(waitFor([&] {
      const QString state = find<QLabel>("state")->text();
      return state.contains("paused") || state.contains("running");
    }));
    if (find<QLabel>("state")->text().contains("running")) click("pause");
    ASSERT_TRUE(says("state", "paused"));
    click("reset");
    ASSERT_TRUE(says("message", "start"));
    ASSERT_TRUE(waitFor([&] { return last_->step == 0; }));
  }

  ros::NodeHandle nh_;
  ros::Subscriber state_, model_;
  ragdoll_msgs::State::ConstPtr last_;
  ragdoll_msgs::Model::ConstPtr scene_;
  RagdollPanel panel_;
};

TEST_F(Panel, stepsWhilePausedAndResets) {
  find<QSpinBox>("steps")->setValue(7);
  click("step");
  ASSERT_TRUE(says("message", "at step 7"));
  EXPECT_TRUE(waitFor([&] { return last_->step == 7; }));
  click("reset");
  EXPECT_TRUE(waitFor([&] { return last_->step == 0; }));
}

TEST_F(Panel, pausesAndRuns) {
  EXPECT_EQ(find<QPushButton>("pause")->text(), "Run");
  click("pause");
  EXPECT_TRUE(says("state", "running"));
  EXPECT_EQ(find<QLabel>("message")->text(), "");  // the state says it
  EXPECT_TRUE(waitFor([&] { return last_->step > 20; }));
  EXPECT_FALSE(find<QPushButton>("step")->isEnabled());
  EXPECT_EQ(find<QPushButton>("pause")->text(), "Pause");
  click("pause");
  EXPECT_TRUE(says("state", "paused"));
}

TEST_F(Panel, choosesAScene) {
  auto* scene = find<QComboBox>("scene");
  for (const char* name : {"hang", "fall"}) {
    const int i = scene->findText(name);
    ASSERT_GE(i, 0) << name;
    const auto before = scene_;
    scene->setCurrentIndex(i);
    Q_EMIT scene->activated(i);
    EXPECT_TRUE(says("message", "1 ragdoll, "));
    ASSERT_TRUE(waitFor([&] { return scene_ != before; }));
    EXPECT_EQ(scene_->scene_yaml.find("pins") != std::string::npos, name == std::string("hang"));
  }
}

TEST_F(Panel, showsTheSceneThatRuns) {
  const auto* scene = find<QComboBox>("scene");
  // roscpp now and then loses the answer of a call that has a connection of its own.
  auto service = nh_.serviceClient<ragdoll_msgs::LoadScene>("/ragdoll/load_scene", true);
  const auto load = [&](const std::string& path, const std::string& yaml) {
    ragdoll_msgs::LoadScene call;
    call.request.path = path;
    call.request.yaml = yaml;
    return service.call(call) && call.response.success;
  };
  const auto shows = [&](const QString& name) {
    EXPECT_TRUE(waitFor([&] { return scene->currentText() == name; }))
        << scene->currentText().toStdString() << ", not " << name.toStdString();
  };
  const std::string folder = ros::package::getPath("ragdoll_sim") + "/scenes/";
  ASSERT_TRUE(load("stairs", ""));
  shows("stairs");
  ASSERT_TRUE(load(folder + "hang.yaml", ""));
  shows("hang");
  ASSERT_TRUE(load("package://ragdoll_sim/scenes/two.yaml", ""));
  shows("two");
  const int own = scene->count();
  ASSERT_TRUE(load("package://ragdoll_sim/test/ros/weightless.yaml", ""));
  shows("weightless.yaml");  // not the one of that name that comes with the package
  ASSERT_TRUE(load("", scene_->scene_yaml));
  shows("(text)");
  EXPECT_EQ(scene->count(), own + 1);
  RagdollPanel later;
  EXPECT_TRUE(
      waitFor([&] { return later.findChild<QComboBox*>("scene")->currentText() == "(text)"; }));
  ASSERT_TRUE(load(folder + "fall.yaml", ""));
  shows("fall");
  EXPECT_EQ(scene->count(), own);
}

TEST_F(Panel, showsTheSceneOfABagOfBefore) {
  auto bag = nh_.advertise<ragdoll_test::ModelOfBefore>("/before/model", 1, true);
  ragdoll_test::ModelOfBefore m;
  m.model.scene = "hang";
  bag.publish(m);
  panel_.setNode("/before");
  EXPECT_TRUE(waitFor([&] { return find<QComboBox>("scene")->currentText() == "hang"; }));
}

TEST_F(Panel, aSceneThatCannotBeLoadedIsNotShown) {
  auto* scene = find<QComboBox>("scene");
  ASSERT_TRUE(waitFor([&] { return !scene->currentText().isEmpty(); }));
  const QString running = scene->currentText();
  scene->insertItem(0, "no_such_scene");
  scene->setCurrentIndex(0);
  Q_EMIT scene->activated(0);
  EXPECT_TRUE(says("message", "no_such_scene"));
  EXPECT_EQ(scene->currentText(), running);
}

TEST_F(Panel, choosesAPresetAndShowsItsError) {
  auto* preset = find<QComboBox>("preset");
  ASSERT_TRUE(waitFor([&] { return preset->count() == 6 && !preset->currentText().isEmpty(); }));
  for (const char* name : {"thesis", "balanced"}) {
    preset->setCurrentText(name);
    Q_EMIT preset->activated(preset->currentIndex());
    EXPECT_TRUE(says("solver", name));
    EXPECT_TRUE(says("error", name == std::string("thesis") ? "20 mm" : "0.7 mm"));
  }
}

TEST_F(Panel, setsMethodThreadsNumbersAndTolerance) {
  auto* threads = find<QSpinBox>("threads");
  auto* numbers = find<QComboBox>("numbers");
  auto* tolerance = find<QDoubleSpinBox>("tolerance");
  ASSERT_TRUE(waitFor([&] { return threads->isEnabled(); }));
  const auto node_has = [](const char* name, auto expected) {
    auto value = expected;
    const bool has = waitFor([&] {
      return ros::param::get(std::string("/ragdoll/") + name, value) && value == expected;
    });
    EXPECT_TRUE(has) << name << ": " << value;
  };
  threads->setValue(2);
  node_has("threads", 2);
  numbers->setCurrentText("float");
  Q_EMIT numbers->activated(numbers->currentIndex());
  node_has("numbers", std::string("float"));
  tolerance->setValue(0.25);  // mm per second
  node_has("tolerance", 0.25e-3);
  // What another has set is shown, and not set again.
  RagdollPanel later;
  EXPECT_TRUE(waitFor([&] {
    return later.findChild<QSpinBox*>("threads")->value() == 2 &&
           later.findChild<QComboBox*>("numbers")->currentText() == "float" &&
           later.findChild<QDoubleSpinBox*>("tolerance")->value() == 0.25;
  }));
  auto* method = find<QComboBox>("method");
  method->setCurrentText("rk");
  Q_EMIT method->activated(method->currentIndex());
  node_has("method", 2);
  // A preset has its own method, numbers and tolerance, but no threads.
  auto* preset = find<QComboBox>("preset");
  for (const char* name : {"fast", "balanced"}) {
    preset->setCurrentText(name);
    Q_EMIT preset->activated(preset->currentIndex());
    node_has("preset", std::string(name));
  }
  EXPECT_TRUE(
      waitFor([&] {
        return method->currentText() == "shake" && tolerance->value() == 0 &&
               numbers->currentText() == "double";
      }));
  EXPECT_EQ(threads->value(), 2);
  threads->setValue(1);
  node_has("threads", 1);
}

TEST_F(Panel, setsTheSpeed) {
  auto* factor = find<QDoubleSpinBox>("factor");
  ASSERT_TRUE(waitFor([&] { return factor->value() == 1; }));
  click("pause");
  // A busy machine may be late, now and then: some stretch is as it should be.
  const auto runs = [&](const std::function<bool(double)>& right) {
    return waitFor([&] {
      const auto a = last_;
      EXPECT_TRUE(waitFor([&] { return last_->time > a->time + 2; }));
      return right((last_->time - a->time) / (last_->header.stamp - a->header.stamp).toSec());
    });
  };
  factor->setValue(4);
  EXPECT_TRUE(runs([](double x) { return std::abs(x - 4) < 0.2; }));
  factor->setValue(0);  // free
  EXPECT_TRUE(runs([](double x) { return x > 8; }));
  factor->setValue(0.004);  // very slow, not free
  double set = 0;
  EXPECT_TRUE(
      waitFor([&] { return ros::param::get("/ragdoll/realtime_factor", set) && set == 0.004; }));
  factor->setValue(1);
  EXPECT_TRUE(runs([](double x) { return std::abs(x - 1) < 0.05; }));
}

TEST_F(Panel, showsTheFiguresOfTheMetrics) {
  ragdoll_msgs::Metrics::ConstPtr last;
  const auto subscriber = nh_.subscribe<ragdoll_msgs::Metrics>(
      "/ragdoll/metrics", 10, [&](const ragdoll_msgs::Metrics::ConstPtr& m) { last = m; });
  click("pause");
  ASSERT_TRUE(waitFor([&] { return last && last->realtime_factor > 0.5; }));
  const auto shows = [&](const char* label, const QString& text) {
    EXPECT_TRUE(waitFor([&] { return find<QLabel>(label)->text().contains(text); }))
        << label << ": " << find<QLabel>(label)->text().toStdString();
  };
  click("pause");  // so that they stay
  ASSERT_TRUE(waitFor([&] { return last->paused && last->realtime_factor == 0; }));
  shows("speed", "x 0.00");
  shows("energy", QString::number(last->kinetic_energy, 'f', 1) + " J + " +
                      QString::number(last->potential_energy, 'f', 1) + " J");
  shows("stretch", QString::number(last->max_stick_error, 'g', 3));
  shows("overlap", QString::number(1e3 * last->max_penetration, 'g', 3) + " mm");
  shows("solver", QString::fromStdString(last->solver));
  EXPECT_GT(last->max_stick_error, 0);
}

/// How many listen to a topic, as the master has it.
int listenersOf(const char* topic) {
  XmlRpc::XmlRpcValue request("/panel_test"), answer, state;
  if (!ros::master::execute("getSystemState", request, answer, state, false)) return -1;
  for (int i = 0; i < state[1].size(); ++i)
    if (std::string(state[1][i][0]) == topic) return state[1][i][1].size();
  return 0;
}

TEST_F(Panel, showsTheLargestForceAndTheLastImpactWhileItIsSeen) {
  EXPECT_EQ(listenersOf("/ragdoll/largest_contact"), 0) << "hidden, it listens";
  auto service = nh_.serviceClient<ragdoll_msgs::LoadScene>("/ragdoll/load_scene", true);
  ragdoll_msgs::LoadScene call;  // a ball of 40 kg that falls by 0.5 m and then lies
  call.request.yaml =
      "ragdolls: [{name: ben, model: {particles: {p: {position: [0, 0, 0], mass: 40, radius: "
      "0.1}}}, position: [0, 0, 0.6]}]\nobstacles: [{type: plane, name: ground}]\n";
  ASSERT_TRUE(service.call(call) && call.response.success);
  EXPECT_EQ(find<QLabel>("force")->text(), "-");
  panel_.show();
  click("pause");
  EXPECT_TRUE(says("force", "392 N, ben/p on ground"));  // 40 * 9.81: by now the node tells
  click("pause");
  ASSERT_TRUE(says("state", "paused"));
  click("reset");
  EXPECT_TRUE(waitFor([&] { return find<QLabel>("force")->text() == "-"; }));
  EXPECT_EQ(find<QLabel>("impact")->text(), "-");
  click("pause");
  EXPECT_TRUE(says("impact", "3.13 m/s, ben/p on ground"));  // sqrt(2 g 0.5)
  EXPECT_TRUE(says("force", "392 N, ben/p on ground"));

  panel_.hide();
  EXPECT_TRUE(waitFor([&] {
    return listenersOf("/ragdoll/largest_contact") == 0 && listenersOf("/ragdoll/impacts") == 0;
  }));
}

TEST_F(Panel, tellsOfTheLastImpactOnceItIsOver) {
  ros::NodeHandle other("/told");
  const auto metrics = other.advertise<ragdoll_msgs::Metrics>("metrics", 1);
  const auto largest = other.advertise<ragdoll_msgs::ContactStates>("largest_contact", 10);
  const auto impacts = other.advertise<ragdoll_msgs::Impact>("impacts", 10);
  panel_.setNode("/told");
  panel_.show();
  ASSERT_TRUE(waitFor(
      [&] { return largest.getNumSubscribers() == 1 && impacts.getNumSubscribers() == 1; }));
  int heard = 0;
  const auto own = other.subscribe<ragdoll_msgs::Impact>(
      "impacts", 10, [&](const ragdoll_msgs::Impact::ConstPtr&) { ++heard; });
  const auto hit = [&](std::uint32_t id, bool over, const char* region, double speed) {
    ragdoll_msgs::Impact m;
    m.id = id;
    m.over = over;
    m.ragdoll = "ben";
    m.region = region;
    m.other = "stairs";
    m.approach_speed = speed;
    m.peak_force = over ? 1234.4 : 0;
    impacts.publish(m);
  };
  hit(1, false, "pelvis", 4);
  hit(2, false, "head", 2.5);
  EXPECT_TRUE(says("impact", "2.50 m/s, ben/head on stairs"));
  hit(1, true, "pelvis", 4);  // not the last any more
  ASSERT_TRUE(waitFor([&] { return heard == 3; }));
  ros::spinOnce();
  EXPECT_EQ(find<QLabel>("impact")->text().toStdString(), "2.50 m/s, ben/head on stairs");
  hit(2, true, "head", 2.5);
  EXPECT_TRUE(says("impact", "1234 N, 2.50 m/s, ben/head on stairs"));

  ragdoll_msgs::ContactStates touches;
  touches.contacts.resize(1);
  touches.contacts[0].ragdoll = "ben";
  touches.contacts[0].body = "head";
  touches.contacts[0].other = "al";
  touches.contacts[0].force.x = -3;
  touches.contacts[0].force.y = 4;
  touches.contacts[0].force.z = 12;
  largest.publish(touches);
  EXPECT_TRUE(says("force", "13 N, ben/head on al"));
  touches.contacts.clear();
  largest.publish(touches);
  EXPECT_TRUE(says("force", "none"));
}

TEST_F(Panel, keepsTheNodeInItsConfig) {
  rviz::Config config;
  panel_.setNode("/other");
  panel_.save(config);
  RagdollPanel restored;
  restored.load(config);
  EXPECT_EQ(restored.node(), "/other");
  EXPECT_EQ(restored.findChild<QLineEdit*>("node")->text(), "/other");
}

TEST_F(Panel, refusesANameThatIsNone) {
  for (const char* name : {"", "a b", "/ragdoll?"}) {
    find<QLineEdit>("node")->setText(name);
    Q_EMIT find<QLineEdit>("node")->editingFinished();
    EXPECT_EQ(panel_.node(), "/ragdoll") << name;
    EXPECT_EQ(find<QLineEdit>("node")->text(), "/ragdoll") << name;
    EXPECT_FALSE(find<QLabel>("message")->text().isEmpty()) << name;
  }
}

TEST_F(Panel, saysThatThereIsNoNode) {
  panel_.setNode("/nobody");
  EXPECT_TRUE(says("state", "no node"));
  EXPECT_FALSE(find<QPushButton>("reset")->isEnabled());
  EXPECT_EQ(find<QLabel>("energy")->text(), "-");
  EXPECT_EQ(find<QLabel>("force")->text(), "-");
  panel_.setNode("/ragdoll");
  EXPECT_TRUE(says("state", "paused"));
}

TEST_F(Panel, aNodeThatHangsHoldsNothingUp) {
  // A service that does not answer until it is told to, in threads of its own.
  ros::CallbackQueue queue;
  ros::NodeHandle other("/hung");
  other.setCallbackQueue(&queue);
  std::atomic<bool> called{false}, answer{false};
  boost::function<bool(std_srvs::Trigger::Request&, std_srvs::Trigger::Response&)> hang =
      [&](std_srvs::Trigger::Request&, std_srvs::Trigger::Response&) {
        called = true;
        while (!answer) std::this_thread::sleep_for(std::chrono::milliseconds(5));
        return true;
      };
  const auto server = other.advertiseService("reset", hang);
  const auto metrics = other.advertise<ragdoll_msgs::Metrics>("metrics", 1);
  ros::AsyncSpinner spinner(1, &queue);
  spinner.start();
  {
    RagdollPanel panel;
    panel.setNode("/hung");
    auto* reset = panel.findChild<QPushButton*>("reset");
    ASSERT_TRUE(waitFor([&] { return reset->isEnabled(); }));
    EXPECT_TRUE(panel.findChild<QLabel*>("state")->text().contains("no news"));
    for (int i = 0; i < 10; ++i) reset->click();
    ASSERT_TRUE(waitFor([&] { return called.load(); }));
    EXPECT_TRUE(waitFor(
        [&] { return panel.findChild<QLabel*>("message")->text().contains("still waiting"); }));
  }  // the panel goes although no answer has come
  EXPECT_FALSE(answer);
  answer = true;
}

TEST(Plugins, areFoundByRviz) {
  pluginlib::ClassLoader<rviz::Panel> panels("rviz", "rviz::Panel");
  EXPECT_TRUE(panels.isClassAvailable("ragdoll_rviz/Ragdoll"));
  pluginlib::ClassLoader<rviz::Tool> tools("rviz", "rviz::Tool");
  EXPECT_TRUE(tools.isClassAvailable("ragdoll_rviz/Poke"));
  EXPECT_NE(tools.createUniqueInstance("ragdoll_rviz/Poke"), nullptr);
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "panel_test");
  ros::NodeHandle nh;  // keeps ROS going
  QApplication application(argc, argv);
  return RUN_ALL_TESTS();
}
