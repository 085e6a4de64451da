#include "ragdolls_display.h"

#include <OgreCamera.h>
#include <OgreMaterialManager.h>
#include <OgreResourceGroupManager.h>
#include <OgreSceneManager.h>
#include <OgreSceneNode.h>
#include <OgreTechnique.h>
#include <ros/exceptions.h>
#include <ros/param.h>
#include <rviz/display_context.h>
#include <rviz/frame_manager.h>
#include <rviz/properties/color_property.h>
#include <rviz/properties/enum_property.h>
#include <rviz/properties/float_property.h>
#include <rviz/properties/string_property.h>
#include <rviz/render_panel.h>
#include <rviz/view_controller.h>
#include <rviz/view_manager.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <pluginlib/class_list_macros.hpp>

#include "ragdoll_sim/core/build_model.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/io/scene_yaml.h"
#include "ragdoll_sim/ros/convert.h"

namespace ragdoll_rviz {
namespace {

using ragdoll::CoatKind;
using ragdoll::Rgba;
using rviz::StatusProperty;

/// [m] Detail that may be lost, level by level.
constexpr std::array<double, 5> kLosses = {0, 0.03, 0.06, 0.10, 0.16};
constexpr float kLossPixels = 3.5f;   ///< what is no larger is not missed
constexpr float kNearest = 0.3f;      ///< [m] from the eye: what is nearer counts as so near
constexpr double kMaxGap = 0.1;       ///< [s] of simulation; a longer one is a jump
constexpr int kNodesCoat = 0;         ///< option of the property; else 1 + CoatKind
constexpr int kOwnColors = 0, kOneColor = 1, kColorEach = 2;  ///< options of the property

/// Colours set apart, the same for the same number: hues a golden section of the circle apart.
Rgba colorOf(int ragdoll) {
  constexpr double kGolden = 0.61803398875, kSaturation = 0.45, kValue = 0.9;
  const QColor c = QColor::fromHsvF(std::fmod(0.55 + kGolden * ragdoll, 1.0), kSaturation, kValue);
  return {static_cast<float>(c.redF()), static_cast<float>(c.greenF()),
          static_cast<float>(c.blueF()), 1};
}

}  // namespace

RagdollsDisplay::RagdollsDisplay() {
  const auto changed = [this](rviz::Property* property, void (RagdollsDisplay::*slot)()) {
    connect(property, &rviz::Property::changed, this, [this, slot] { (this->*slot)(); });
  };
  node_ = new rviz::StringProperty("Node", "/ragdoll", "Name of the simulation's node.", this);
  coat_ = new rviz::EnumProperty("Coat", "node's", "What bodies wear; node's: what ~coat says.", this);
  coat_->addOption("node's", kNodesCoat);
  for (const char* name : {"none", "sticks", "boxes", "capsules", "skin"})
    coat_->addOption(name, 1 + static_cast<int>(ragdoll::coatKind(name)));
  colors_ = new rviz::EnumProperty("Colors", "own", "The coat's own, one for all, or one each.", this);
  colors_->addOption("own", kOwnColors);
  colors_->addOption("one", kOneColor);
  colors_->addOption("each", kColorEach);
  color_ = new rviz::ColorProperty("Color", QColor(64, 148, 178), "Of all bodies, with Colors: one.",
                                   this);
  alpha_ = new rviz::FloatProperty("Alpha", 1, "1 is opaque.", this);
  alpha_->setMin(0);
  alpha_->setMax(1);
  color_->hide();
  changed(node_, &RagdollsDisplay::changeNode);
  changed(coat_, &RagdollsDisplay::changeCoat);
  changed(colors_, &RagdollsDisplay::changeColors);
  changed(color_, &RagdollsDisplay::changeColors);
  changed(alpha_, &RagdollsDisplay::changeAlpha);
}

RagdollsDisplay::~RagdollsDisplay() {
  unsubscribe();
  batches_.clear();
  if (!material_) return;
  Ogre::MaterialManager::getSingleton().remove(material_->getName(), material_->getGroup());
}

void RagdollsDisplay::onInitialize() {
  static int count = 0;
  material_ = Ogre::MaterialManager::getSingleton().create(
      "ragdoll_rviz/Ragdolls" + std::to_string(count++),
      Ogre::ResourceGroupManager::DEFAULT_RESOURCE_GROUP_NAME);
  material_->setReceiveShadows(false);
  material_->setLightingEnabled(false);  // the light is in the colours
  changeAlpha();
}

/// What was heard before is shown until there is news: a node that is paused may have none.
void RagdollsDisplay::onEnable() {
  subscribe();
  count_.clear();
  changed_ = true;
}

void RagdollsDisplay::onDisable() { unsubscribe(); }

void RagdollsDisplay::reset() {
  Display::reset();
  if (!isEnabled()) return;
  forgetBodies();
  subscribe();
}

void RagdollsDisplay::fixedFrameChanged() { changed_ = true; }

// --- What is heard --------------------------------------------------------------------------------

void RagdollsDisplay::subscribe() {
  unsubscribe();
  setStatus(StatusProperty::Warn, "Bodies", "nothing heard of " + node_->getString() + " yet");
  const std::string prefix = node_->getStdString() + "/";
  try {
    subscribers_.push_back(update_nh_.subscribe(prefix + "model", 1, &RagdollsDisplay::hearModel, this));
    subscribers_.push_back(update_nh_.subscribe(prefix + "state", 1, &RagdollsDisplay::hearState, this));
    subscribers_.push_back(update_nh_.subscribe(prefix + "parameter_updates", 1,
                                                &RagdollsDisplay::hearSettings, this));
  } catch (const ros::InvalidNameException& e) {
    setStatus(StatusProperty::Error, "Bodies", QString("no name of a node: %1").arg(e.what()));
  }
}

void RagdollsDisplay::unsubscribe() { subscribers_.clear(); }

void RagdollsDisplay::forgetBodies() {
  batches_.clear();
  tracker_.reset();
  world_.reset();
  scene_.reset();
  heard_ = false;
  count_.clear();
}

void RagdollsDisplay::hearModel(const ros::MessageEvent<ragdoll::AnyModel const>& event) {
  try {
    const ragdoll_msgs::Model message = ragdoll::toModel(
        *event.getConstMessage(), event.getConnectionHeader()["md5sum"]);
    // What the node or a relay was started with; what changes later is told on ~parameter_updates.
    ros::param::get(node_->getStdString() + "/coat", node_coat_);
    world_frame_ = message.header.frame_id;
    changed_ = true;
    if (scene_ && message.scene_yaml == scene_->text) return;
    auto scene = std::make_shared<ragdoll::Scene>(ragdoll::parseScene(message.scene_yaml, "~model"));
    auto model = std::make_unique<ragdoll::Model>(ragdoll::buildModel(*scene));
    forgetBodies();
    scene_ = std::move(scene);
    world_ = std::move(model);
  } catch (const ragdoll::Error& e) {
    forgetBodies();
    setStatus(StatusProperty::Error, "Bodies", QString("~model: %1").arg(e.what()));
    return;
  }
  state_ = ragdoll::startState(*world_);
  tracker_.emplace(*world_);
}

void RagdollsDisplay::hearState(const ragdoll_msgs::State& message) {
  if (!world_) return;
  if (!ragdoll::fits(*world_, message)) {
    setStatus(StatusProperty::Warn, "Bodies", "~state is not of the scene that ~model told");
    return;
  }
  const double passed = message.time - state_.time;
  const bool jump = !heard_ || message.run != run_ || passed < 0 || passed > kMaxGap;
  ragdoll::putState(*world_, message, state_);
  if (jump)
    tracker_->reset(state_);
  else if (passed > 0)
    tracker_->update(state_);
  run_ = message.run;
  heard_ = changed_ = true;
}

void RagdollsDisplay::hearSettings(const dynamic_reconfigure::Config& message) {
  for (const auto& setting : message.strs) {
    if (setting.name != "coat" || setting.value == node_coat_) continue;
    node_coat_ = setting.value;
    changeCoat();
  }
}

// --- What the user changes ------------------------------------------------------------------------

void RagdollsDisplay::changeNode() {
  node_coat_.clear();
  forgetBodies();
  if (isEnabled()) subscribe();
}

void RagdollsDisplay::changeCoat() {
  batches_.clear();
  count_.clear();
  changed_ = true;
}

void RagdollsDisplay::changeColors() {
  color_->setHidden(colors_->getOptionInt() != kOneColor);
  changed_ = true;
}

void RagdollsDisplay::changeAlpha() {
  changed_ = true;
  if (!material_) return;
  const bool opaque = alpha_->getFloat() >= 1;
  material_->setSceneBlending(opaque ? Ogre::SBT_REPLACE : Ogre::SBT_TRANSPARENT_ALPHA);
  material_->setDepthWriteEnabled(opaque);
}

void RagdollsDisplay::setTopic(const QString& topic, const QString&) {
  node_->setString(topic.left(topic.lastIndexOf('/')));
}

// --- The picture ----------------------------------------------------------------------------------

void RagdollsDisplay::update(float, float) {
  if (!heard_ || !placeInFixedFrame()) return;
  if (batches_.empty()) dress();
  const std::optional<View> now = view();
  if (!now || (!changed_ && *now == drawn_)) return;
  draw(*now);
  drawn_ = *now;
  changed_ = false;
  showCount();
}

CoatKind RagdollsDisplay::coat() const {
  const int option = coat_->getOptionInt();
  if (option != kNodesCoat) return static_cast<CoatKind>(option - 1);
  try {
    return ragdoll::coatKind(node_coat_.empty() ? scene_->coat : node_coat_);
  } catch (const ragdoll::Error&) {
    return ragdoll::coatKind(scene_->coat);
  }
}

/// Bodies of one skeleton share their batches.
void RagdollsDisplay::dress() {
  batches_.resize(world_->skeletons.size());
  for (std::size_t i = 0; i < world_->ragdolls.size(); ++i) {
    auto& levels = batches_[static_cast<std::size_t>(world_->ragdolls[i].skeleton)];
    if (!levels.empty()) continue;
    const ragdoll::Skeleton& skeleton = world_->skeletonOf(world_->ragdolls[i]);
    for (const double loss : kLosses) {
      levels.push_back(std::make_unique<BodyBatch>(
          ragdoll::CoatMesh(coat(), skeleton, tracker_->tree(static_cast<int>(i)), loss), material_));
      scene_node_->attachObject(levels.back().get());
    }
  }
  changed_ = true;
}

bool RagdollsDisplay::placeInFixedFrame() {
  Ogre::Vector3 position;
  Ogre::Quaternion orientation;
  const bool known = context_->getFrameManager()->getTransform(world_frame_, ros::Time(), position,
                                                               orientation);
  if (!known) {
    scene_node_->setVisible(false);
    placed_ = false;
    setStatus(StatusProperty::Error, "Frame",
              QString("no transform from %1 to %2")
                  .arg(QString::fromStdString(world_frame_), fixed_frame_));
    return false;
  }
  if (!placed_) {
    deleteStatus("Frame");
    placed_ = changed_ = true;  // draw() shows it
  }
  scene_node_->setPosition(position);
  scene_node_->setOrientation(orientation);
  return true;
}

std::optional<RagdollsDisplay::View> RagdollsDisplay::view() const {
  const rviz::ViewManager* views = context_->getViewManager();
  const rviz::ViewController* controller = views->getCurrent();
  const rviz::RenderPanel* panel = views->getRenderPanel();
  if (!controller || !controller->getCamera() || !panel) return std::nullopt;
  const Ogre::Camera* camera = controller->getCamera();
  const Ogre::Matrix4& projection = camera->getProjectionMatrix();
  View view;
  view.eye = scene_node_->getOrientation().Inverse() *
             (camera->getDerivedPosition() - scene_node_->getPosition());
  view.scale = static_cast<float>(projection[1][1] * panel->height() / 2);
  view.perspective = projection[3][3] == 0;
  return view;
}

/// The coarsest whose loss is not seen.
std::size_t RagdollsDisplay::levelOf(const Ogre::Vector3& place, const View& view) const {
  const float distance = std::max<float>(kNearest, place.distance(view.eye));
  const float pixels = view.perspective ? view.scale / distance : view.scale;
  std::size_t level = 0;
  while (level + 1 < kLosses.size() && static_cast<float>(kLosses[level + 1]) * pixels <= kLossPixels)
    ++level;
  return level;
}

void RagdollsDisplay::draw(const View& view) {
  for (const auto& levels : batches_)
    for (const auto& batch : levels) batch->clear();
  const QColor all = color_->getColor();
  const Rgba one{static_cast<float>(all.redF()), static_cast<float>(all.greenF()),
                 static_cast<float>(all.blueF()), 1};
  const ragdoll::Posture& posture = tracker_->now();
  for (int i = 0; i < tracker_->ragdolls(); ++i) {
    const ragdoll::Ragdoll& ragdoll = world_->ragdolls[static_cast<std::size_t>(i)];
    const double* x = posture.x.data() + 3 * ragdoll.first;
    const Ogre::Vector3 place(static_cast<float>(x[0]), static_cast<float>(x[1]),
                              static_cast<float>(x[2]));
    BodyBatch::Body body{x, world_->skeletonOf(ragdoll).size(),
                         posture.parts.data() + tracker_->firstPart(i), std::nullopt};
    if (colors_->getOptionInt() == kOneColor) body.color = one;
    if (colors_->getOptionInt() == kColorEach) body.color = colorOf(i);
    batches_[static_cast<std::size_t>(ragdoll.skeleton)][levelOf(place, view)]->add(body);
  }
  for (const auto& levels : batches_)
    for (const auto& batch : levels) batch->draw(alpha_->getFloat());
  context_->queueRender();
}

void RagdollsDisplay::showCount() {
  std::size_t triangles = 0;
  for (const auto& levels : batches_)
    for (const auto& batch : levels) triangles += batch->triangles();
  const QString text = QString("%1, %2 triangles").arg(tracker_->ragdolls()).arg(triangles);
  if (text == count_) return;
  count_ = text;
  setStatus(StatusProperty::Ok, "Bodies", text);
}

}  // namespace ragdoll_rviz

PLUGINLIB_EXPORT_CLASS(ragdoll_rviz::RagdollsDisplay, rviz::Display)
