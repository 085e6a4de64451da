// The panel "Ragdoll": controls a simulation by its services and shows its ~metrics, and while it is
// seen what touches.
#pragma once

#ifndef Q_MOC_RUN
#include <dynamic_reconfigure/Config.h>
#include <dynamic_reconfigure/ConfigDescription.h>
#include <ragdoll_msgs/Metrics.h>
#include <ragdoll_msgs/Model.h>
#include <ros/node_handle.h>
#include <ros/subscriber.h>
#include <rviz/panel.h>
#endif

#include <QElapsedTimer>
#include <QString>

#include "caller.h"
#include "touch_figures.h"

class QComboBox;
class QDoubleSpinBox;
class QFormLayout;
class QLabel;
class QLineEdit;
class QPushButton;
class QSpinBox;

namespace rviz {
class Property;
class Tool;
}  // namespace rviz

namespace ragdoll_rviz {

class RagdollPanel : public rviz::Panel {
  Q_OBJECT

 public:
  explicit RagdollPanel(QWidget* parent = nullptr);

  void load(const rviz::Config& config) override;
  void save(rviz::Config config) const override;

  QString node() const { return node_; }
  void setNode(const QString& node);

 protected:
  void onInitialize() override;
  void showEvent(QShowEvent* event) override;
  void hideEvent(QHideEvent* event) override;

 private:
  enum class State { kNoNode, kSilent, kPaused, kRunning };

  // Widgets.
  void makeControls(QFormLayout* form);
  void makeSolver(QFormLayout* form);
  void connectControls();
  void makeFigures(QFormLayout* form);
  QLabel* addFigure(QFormLayout* form, const QString& name, const QString& title,
                    const QString& tip);

  // What is heard of the node.
  void hearMetrics(const ragdoll_msgs::Metrics& message);
  void hearSettings(const dynamic_reconfigure::Config& message);
  void hearModel(const ragdoll_msgs::Model& message);
  void hearDescription(const dynamic_reconfigure::ConfigDescription& message);
  void showState();
  void showScene();

  // What is asked of it.
  void pause();
  void step();
  void reset();
  void loadScene();
  void set(const dynamic_reconfigure::Config& change);
  void set(const char* name, const QString& value);
  void set(const char* name, double value);
  void set(const char* name, int value);
  template <class Service>
  void ask(const char* service, const typename Service::Request& request);
  void say(const QString& text);

  // The tool that pokes, if there is one.
  void findTool(rviz::Tool* tool);
  void showStrength();

  QString node_;
  QString scenes_;         ///< folder of ragdoll_sim's scenes
  QString running_scene_;  ///< what the node has loaded it from; empty: not known
  State state_ = State::kNoNode;
  bool paused_ = false;
  QElapsedTimer heard_;  ///< since the last metrics
  ros::NodeHandle nh_;
  ros::Subscriber metrics_, settings_, description_, model_;
  TouchFigures touches_;
  rviz::Property* strength_property_ = nullptr;
  rviz::Property* node_property_ = nullptr;

  QLineEdit* node_edit_;
  QLabel *state_label_, *message_;
  QPushButton *pause_, *step_, *reset_;
  QSpinBox *steps_, *threads_;
  QComboBox *scene_, *preset_, *method_, *numbers_;
  QDoubleSpinBox *factor_, *tolerance_, *strength_;
  QLabel *speed_, *energy_, *stretch_, *overlap_, *error_, *solver_;

  Caller caller_;  // last: its calls end before the widgets do
};

}  // namespace ragdoll_rviz
