#include "panel.h"

#include <dynamic_reconfigure/Reconfigure.h>
#include <ragdoll_msgs/LoadScene.h>
#include <ragdoll_msgs/Step.h>
#include <ros/package.h>
#include <rviz/properties/property.h>
#include <rviz/tool.h>
#include <rviz/tool_manager.h>
#include <rviz/visualization_manager.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>

#include <QComboBox>
#include <QDir>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QFrame>
#include <QHBoxLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QRegularExpression>
#include <QSignalBlocker>
#include <QSpinBox>
#include <QTimer>
#include <algorithm>
#include <cmath>
#include <pluginlib/class_list_macros.hpp>

#include "ragdoll_sim/ros/any_model.h"

namespace ragdoll_rviz {
namespace {

constexpr int kLookPeriod = 250;         ///< [ms] between two looks whether the node is there
constexpr int kSilence = 3500;           ///< [ms] without metrics, which come once a second
constexpr const char* kText = "(text)";  ///< for a scene that was loaded from none
constexpr int kFactorDecimals = 4;       ///< of the speed
constexpr double kMillimetres = 1000;    ///< in a metre
constexpr int kToleranceDecimals = 6;    ///< of a tolerance in millimetres: 1e-9 m
constexpr int kMaxThreads = 256;         ///< as the setting has it
constexpr double kStrength = 600;        ///< [N] of a poke at first

QString messageOf(const std_srvs::TriggerResponse& r) { return QString::fromStdString(r.message); }
QString messageOf(const std_srvs::SetBoolResponse& r) { return QString::fromStdString(r.message); }
QString messageOf(const dynamic_reconfigure::ReconfigureResponse&) { return {}; }
template <class Response>
QString messageOf(const Response& r) {
  return QString::fromStdString(r.status_message);
}

QHBoxLayout* row(std::initializer_list<QWidget*> widgets) {
  auto* layout = new QHBoxLayout;
  for (QWidget* widget : widgets) layout->addWidget(widget);
  return layout;
}

/// One of several by name, in a row of its own.
QComboBox* addChoice(QFormLayout* form, const char* name, const char* label, const char* tip,
                     const QStringList& choices) {
  auto* choice = new QComboBox;
  choice->setObjectName(name);
  choice->setToolTip(tip);
  choice->addItems(choices);
  form->addRow(label, choice);
  return choice;
}

/// A length or a ratio with three digits.
QString figure(double value) { return QString::number(value, 'g', 3); }

/// One setting, in the list of its type.
template <class List, class Value>
dynamic_reconfigure::Config changeOf(List dynamic_reconfigure::Config::*list, const char* name,
                                     const Value& value) {
  dynamic_reconfigure::Config change;
  (change.*list).resize(1);
  (change.*list)[0].name = name;
  (change.*list)[0].value = value;
  return change;
}

}  // namespace

RagdollPanel::RagdollPanel(QWidget* parent) : rviz::Panel(parent) {
  auto* form = new QFormLayout(this);
  form->setContentsMargins(8, 8, 8, 8);
  form->setVerticalSpacing(5);
  makeControls(form);
  auto* line = new QFrame;
  line->setFrameShape(QFrame::HLine);
  line->setFrameShadow(QFrame::Sunken);
  form->addRow(line);
  makeFigures(form);

  connectControls();
  auto* look = new QTimer(this);
  connect(look, &QTimer::timeout, this, [this] { showState(); });
  look->start(kLookPeriod);
  setNode("/ragdoll");
}

void RagdollPanel::connectControls() {
  connect(node_edit_, &QLineEdit::editingFinished, this, [this] { setNode(node_edit_->text()); });
  connect(pause_, &QPushButton::clicked, this, [this] { pause(); });
  connect(step_, &QPushButton::clicked, this, [this] { step(); });
  connect(reset_, &QPushButton::clicked, this, [this] { reset(); });
  connect(scene_, QOverload<int>::of(&QComboBox::activated), this, [this](int) { loadScene(); });
  connect(preset_, QOverload<int>::of(&QComboBox::activated), this,
          [this](int) { set("preset", preset_->currentText()); });
  connect(method_, QOverload<int>::of(&QComboBox::activated), this,
          [this](int i) { set("method", i); });
  connect(numbers_, QOverload<int>::of(&QComboBox::activated), this,
          [this](int) { set("numbers", numbers_->currentText()); });
  connect(threads_, QOverload<int>::of(&QSpinBox::valueChanged), this,
          [this](int n) { set("threads", n); });
  connect(tolerance_, QOverload<double>::of(&QDoubleSpinBox::valueChanged), this,
          [this](double mm) { set("tolerance", mm / kMillimetres); });
  connect(factor_, QOverload<double>::of(&QDoubleSpinBox::valueChanged), this,
          [this](double f) { set("realtime_factor", f > 0 ? f : -1.0); });
  connect(strength_, QOverload<double>::of(&QDoubleSpinBox::valueChanged), this, [this](double f) {
    if (strength_property_) strength_property_->setValue(f);
    Q_EMIT configChanged();
  });
}

void RagdollPanel::makeControls(QFormLayout* form) {
  node_edit_ = new QLineEdit;
  node_edit_->setObjectName("node");
  node_edit_->setToolTip("name of the simulation's node");
  form->addRow("Node", node_edit_);
  state_label_ = new QLabel;
  state_label_->setObjectName("state");
  form->addRow("State", state_label_);

  pause_ = new QPushButton("Pause");
  pause_->setObjectName("pause");
  reset_ = new QPushButton("Reset");
  reset_->setObjectName("reset");
  reset_->setToolTip("back to the scene's start");
  form->addRow(row({pause_, reset_}));
  step_ = new QPushButton("Step");
  step_->setObjectName("step");
  step_->setToolTip("so many steps, while paused");
  steps_ = new QSpinBox;
  steps_->setObjectName("steps");
  steps_->setRange(1, 100000);
  form->addRow(row({step_, steps_}));

  const QString share = QString::fromStdString(ros::package::getPath("ragdoll_sim"));
  scenes_ = share + "/scenes";
  scene_ =
      addChoice(form, "scene", "Scene", "the scene that runs; choose another of ragdoll_sim's", {});
  if (!share.isEmpty())
    for (const QFileInfo& file : QDir(scenes_).entryInfoList({"*.yaml"}, QDir::Files, QDir::Name))
      scene_->addItem(file.completeBaseName());
  scene_->setCurrentIndex(-1);

  factor_ = new QDoubleSpinBox;
  factor_->setObjectName("factor");
  factor_->setDecimals(kFactorDecimals);
  factor_->setRange(0, 1000);
  factor_->setSingleStep(0.25);
  factor_->setKeyboardTracking(false);
  factor_->setSpecialValueText("free");
  factor_->setValue(1);
  factor_->setToolTip("simulated time per real time; lowest: as fast as it goes");
  form->addRow("Speed", factor_);

  makeSolver(form);

  strength_ = new QDoubleSpinBox;
  strength_->setObjectName("strength");
  strength_->setRange(0, 100000);
  strength_->setDecimals(0);
  strength_->setSingleStep(100);
  strength_->setKeyboardTracking(false);
  strength_->setSuffix(" N");
  strength_->setValue(kStrength);
  form->addRow("Poke", strength_);
  showStrength();

  message_ = new QLabel;
  message_->setObjectName("message");
  message_->setWordWrap(true);
  message_->setMinimumHeight(2 * message_->fontMetrics().lineSpacing());
  message_->setAlignment(Qt::AlignTop | Qt::AlignLeft);
  message_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  form->addRow(message_);
}

void RagdollPanel::makeSolver(QFormLayout* form) {
  preset_ = addChoice(form, "preset", "Solver", "settings of the solver", {});
  method_ = addChoice(form, "method", "Method", "how a step is taken; a preset has its own",
                      {"jakobsen", "shake", "rk", "fast"});

  tolerance_ = new QDoubleSpinBox;
  tolerance_->setObjectName("tolerance");
  tolerance_->setDecimals(kToleranceDecimals);
  tolerance_->setRange(0, kMillimetres);
  tolerance_->setStepType(QAbstractSpinBox::AdaptiveDecimalStepType);
  tolerance_->setKeyboardTracking(false);
  tolerance_->setSuffix(" mm/s");
  tolerance_->setSpecialValueText("fixed step");
  tolerance_->setToolTip("error per simulated second that substeps keep to; lowest: a fixed step");
  form->addRow("Tolerance", tolerance_);

  threads_ = new QSpinBox;
  threads_->setObjectName("threads");
  threads_->setRange(0, kMaxThreads);
  threads_->setKeyboardTracking(false);
  threads_->setSpecialValueText("all cores");
  threads_->setValue(1);
  threads_->setToolTip("of one step of the whole scene; the same motion for any number");
  form->addRow("Threads", threads_);

  numbers_ = addChoice(form, "numbers", "Numbers", "what the method fast computes with",
                       {"double", "float"});
}

void RagdollPanel::makeFigures(QFormLayout* form) {
  speed_ = addFigure(form, "speed", "Real time",
                     "simulated time per real time over the last second, time of a step");
  energy_ = addFigure(form, "energy", "Energy",
                      "kinetic and potential energy; potential is 0 at the world's origin");
  stretch_ = addFigure(form, "stretch", "Stretch", "largest relative error of a stick's length");
  overlap_ = addFigure(form, "overlap", "Overlap", "deepest penetration into an obstacle");
  auto* force = addFigure(form, "force", "Largest force", "of the contacts now, and of which");
  auto* impact = addFigure(form, "impact", "Last impact",
                           "that began faster than 0.1 m/s: its peak force once it is over, its "
                           "approach speed, what hit what");
  touches_.setLabels(force, impact);
  error_ = addFigure(form, "error", "Error class",
                     "of the solver's preset: distance from the exact motion (RMS) after 0.1 s of "
                     "falling on things");
  solver_ = addFigure(form, "solver", "In use", "settings that the node runs with");
  solver_->setWordWrap(true);
}

QLabel* RagdollPanel::addFigure(QFormLayout* form, const QString& name, const QString& title,
                                const QString& tip) {
  auto* label = new QLabel;
  label->setObjectName(name);
  label->setToolTip(tip);
  form->addRow(title, label);
  return label;
}

void RagdollPanel::load(const rviz::Config& config) {
  rviz::Panel::load(config);
  QString node;
  if (config.mapGetString("Node", &node)) setNode(node);
}

void RagdollPanel::save(rviz::Config config) const {
  rviz::Panel::save(config);
  config.mapSetValue("Node", node_);
}

void RagdollPanel::setNode(const QString& node) {
  QString name = node.trimmed();
  if (!name.isEmpty() && !name.startsWith('/')) name.prepend('/');
  std::string problem;
  if (name.isEmpty() || !ros::names::validate(name.toStdString(), problem)) {
    say(name.isEmpty() ? "a node has a name, such as /ragdoll" : QString::fromStdString(problem));
    node_edit_->setText(node_);
    return;
  }
  node_edit_->setText(name);
  if (name == node_) return;
  node_ = name;
  if (node_property_) node_property_->setValue(node_);
  say("");
  heard_.invalidate();
  const std::string prefix = node_.toStdString() + "/";
  using Metrics = ragdoll_msgs::Metrics;
  using dynamic_reconfigure::Config;
  using dynamic_reconfigure::ConfigDescription;
  metrics_ = nh_.subscribe<Metrics>(prefix + "metrics", 10,
                                    [this](const Metrics::ConstPtr& m) { hearMetrics(*m); });
  settings_ = nh_.subscribe<Config>(prefix + "parameter_updates", 10,
                                    [this](const Config::ConstPtr& m) { hearSettings(*m); });
  description_ = nh_.subscribe<ConfigDescription>(
      prefix + "parameter_descriptions", 10,
      [this](const ConfigDescription::ConstPtr& m) { hearDescription(*m); });
  model_ = ragdoll::subscribeToModels(nh_, prefix + "model",
                                      [this](const ragdoll_msgs::Model& m) { hearModel(m); });
  if (isVisible()) touches_.listen(nh_, node_.toStdString());
  running_scene_.clear();
  showScene();
  showState();
  Q_EMIT configChanged();
}

void RagdollPanel::showEvent(QShowEvent* event) {
  rviz::Panel::showEvent(event);
  touches_.listen(nh_, node_.toStdString());
}

void RagdollPanel::hideEvent(QHideEvent* event) {
  rviz::Panel::hideEvent(event);
  touches_.stop();
}

void RagdollPanel::hearMetrics(const ragdoll_msgs::Metrics& m) {
  heard_.start();
  paused_ = m.paused;
  speed_->setText(QString("x %1, step %2 us")
                      .arg(m.realtime_factor, 0, 'f', 2)
                      .arg(1e6 * m.step_time, 0, 'f', 0));
  energy_->setText(
      QString("%1 J + %2 J").arg(m.kinetic_energy, 0, 'f', 1).arg(m.potential_energy, 0, 'f', 1));
  stretch_->setText(figure(m.max_stick_error));
  overlap_->setText(figure(1e3 * m.max_penetration) + " mm");
  error_->setText(m.error_class.empty() ? "unknown" : QString::fromStdString(m.error_class));
  solver_->setText(QString::fromStdString(m.solver));
  showState();
}

void RagdollPanel::hearSettings(const dynamic_reconfigure::Config& m) {
  const QSignalBlocker factor(factor_), preset(preset_), tolerance(tolerance_), threads(threads_),
      numbers(numbers_), method(method_);
  for (const auto& d : m.doubles)
    if (d.name == "realtime_factor") {
      // 0 reads "free", which a very slow one is not.
      const double least = std::pow(10.0, -kFactorDecimals);
      factor_->setValue(d.value > 0 ? std::max(d.value, least) : 0);
    } else if (d.name == "tolerance") {
      tolerance_->setValue(kMillimetres * d.value);
    }
  for (const auto& i : m.ints) {
    if (i.name == "threads") threads_->setValue(i.value);
    if (i.name == "method") method_->setCurrentIndex(i.value);
  }
  for (const auto& s : m.strs) {
    if (s.name == "numbers") numbers_->setCurrentText(QString::fromStdString(s.value));
    if (s.name != "preset") continue;
    const QString name = QString::fromStdString(s.value);
    if (preset_->findText(name) < 0) preset_->addItem(name);
    preset_->setCurrentText(name);
  }
}

void RagdollPanel::hearModel(const ragdoll_msgs::Model& m) {
  running_scene_ = m.scene.empty() ? kText : QString::fromStdString(m.scene);
  touches_.clear();
  showScene();
}

/// A scene that is not ragdoll_sim's gets an entry of its own, with where it comes from as data.
void RagdollPanel::showScene() {
  const QString& scene = running_scene_;
  while (scene_->count() > 0 && scene_->itemData(scene_->count() - 1).isValid())
    scene_->removeItem(scene_->count() - 1);
  const QFileInfo file(scene);
  const bool ours = scene == file.baseName() || file.dir() == QDir(scenes_) ||
                    scene.startsWith("package://ragdoll_sim/scenes/");
  int index = scene.isEmpty() ? -1 : scene_->findText(file.completeBaseName());
  if (!scene.isEmpty() && (!ours || index < 0)) {
    scene_->addItem(file.fileName(), scene);
    index = scene_->count() - 1;
  }
  scene_->setCurrentIndex(index);
}

void RagdollPanel::hearDescription(const dynamic_reconfigure::ConfigDescription& m) {
  const QSignalBlocker preset(preset_);
  const QString present = preset_->currentText();
  preset_->clear();
  for (const auto& group : m.groups) {
    for (const auto& p : group.parameters) {
      if (p.name != "preset") continue;
      // A python dictionary of dictionaries with the key value.
      static const QRegularExpression value("'value': '([^']*)'");
      auto match = value.globalMatch(QString::fromStdString(p.edit_method));
      while (match.hasNext()) preset_->addItem(match.next().captured(1));
    }
  }
  preset_->setCurrentText(present);
}

void RagdollPanel::showState() {
  if (metrics_.getNumPublishers() == 0) {
    heard_.invalidate();
    state_ = State::kNoNode;
  } else if (!heard_.isValid() || heard_.elapsed() > kSilence) {
    state_ = State::kSilent;
  } else {
    state_ = paused_ ? State::kPaused : State::kRunning;
  }
  static const char* const kNames[] = {"no node", "no news", "paused", "running"};
  static const char* const kColors[] = {"#b3261e", "#a15c00", "#5b6770", "#1f7a3d"};
  const int i = static_cast<int>(state_);
  state_label_->setText(QString("<b style='color:%1'>%2</b>").arg(kColors[i], kNames[i]));
  const bool there = state_ != State::kNoNode;
  for (QWidget* w : std::initializer_list<QWidget*>{pause_, reset_, scene_, factor_, preset_,
                                                    tolerance_, threads_, numbers_, method_})
    w->setEnabled(there);
  step_->setEnabled(state_ == State::kPaused);
  pause_->setText(paused_ && there ? "Run" : "Pause");
  if (there) return;
  touches_.clear();
  for (QLabel* label : {speed_, energy_, stretch_, overlap_, error_, solver_}) label->setText("-");
}

template <class Service>
void RagdollPanel::ask(const char* service, const typename Service::Request& request) {
  say("...");
  caller_.call<Service>(node_.toStdString() + "/" + service, request, this,
                        [this](const QString& problem, const typename Service::Response& response) {
                          say(problem.isEmpty() ? messageOf(response) : problem);
                        });
}

void RagdollPanel::pause() {
  std_srvs::SetBoolRequest request;
  request.data = !paused_;
  say("...");
  caller_.call<std_srvs::SetBool>(
      node_.toStdString() + "/pause", request, this,
      [this, wanted = !paused_](const QString& problem, const std_srvs::SetBoolResponse& response) {
        const bool done = problem.isEmpty() && response.success;  // the state says it
        if (done) paused_ = wanted;
        say(done ? "" : problem.isEmpty() ? messageOf(response) : problem);
        showState();
      });
}

void RagdollPanel::step() {
  ragdoll_msgs::StepRequest request;
  request.steps = static_cast<std::uint32_t>(steps_->value());
  ask<ragdoll_msgs::Step>("step", request);
}

void RagdollPanel::reset() {
  touches_.clear();  // a model comes with another scene alone
  ask<std_srvs::Trigger>("reset", {});
}

void RagdollPanel::loadScene() {
  const QVariant own = scene_->currentData();  // of a scene that is not ragdoll_sim's
  if (own.isValid() && own.toString() == kText) {
    return say("this scene was loaded as text; Reset begins it again");
  }
  ragdoll_msgs::LoadSceneRequest request;
  request.path = (own.isValid() ? own.toString() : scene_->currentText()).toStdString();
  say("...");
  caller_.call<ragdoll_msgs::LoadScene>(
      node_.toStdString() + "/load_scene", request, this,
      [this](const QString& problem, const ragdoll_msgs::LoadSceneResponse& response) {
        say(problem.isEmpty() ? messageOf(response) : problem);
        if (!problem.isEmpty() || !response.success) showScene();  // the old one goes on
      });
}

void RagdollPanel::set(const dynamic_reconfigure::Config& change) {
  dynamic_reconfigure::ReconfigureRequest request;
  request.config = change;
  ask<dynamic_reconfigure::Reconfigure>("set_parameters", request);
}

void RagdollPanel::set(const char* name, const QString& value) {
  set(changeOf(&dynamic_reconfigure::Config::strs, name, value.toStdString()));
}

void RagdollPanel::set(const char* name, double value) {
  set(changeOf(&dynamic_reconfigure::Config::doubles, name, value));
}

void RagdollPanel::set(const char* name, int value) {
  set(changeOf(&dynamic_reconfigure::Config::ints, name, value));
}

void RagdollPanel::say(const QString& text) { message_->setText(text); }

void RagdollPanel::onInitialize() {
  rviz::ToolManager* tools = vis_manager_->getToolManager();
  connect(tools, &rviz::ToolManager::toolAdded, this, [this](rviz::Tool* t) { findTool(t); });
  for (int i = 0; i < tools->numTools(); ++i) findTool(tools->getTool(i));
}

void RagdollPanel::findTool(rviz::Tool* tool) {
  if (tool->getClassId() != "ragdoll_rviz/Poke") return;
  rviz::Property* properties = tool->getPropertyContainer();
  strength_property_ = properties->subProp("Strength");
  node_property_ = properties->subProp("Node");
  node_property_->setValue(node_);
  connect(strength_property_, &rviz::Property::changed, this, [this] { showStrength(); });
  connect(strength_property_, &QObject::destroyed, this, [this](QObject* gone) {
    if (gone != strength_property_) return;
    strength_property_ = node_property_ = nullptr;
    showStrength();
  });
  showStrength();
}

void RagdollPanel::showStrength() {
  strength_->setEnabled(strength_property_ != nullptr);
  strength_->setToolTip(strength_property_ ? "force of the tool Poke, for 0.1 s"
                                           : "of the tool Poke: add it with + in the toolbar");
  if (!strength_property_) return;
  const QSignalBlocker blocker(strength_);
  strength_->setValue(strength_property_->getValue().toDouble());
}

}  // namespace ragdoll_rviz

PLUGINLIB_EXPORT_CLASS(ragdoll_rviz::RagdollPanel, rviz::Panel)
