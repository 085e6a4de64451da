#include "contact_messages.h"

#include "ragdoll_sim/ros/convert.h"

namespace ragdoll {

ragdoll_msgs::ContactState toContactState(const Model& model, const Touch& touch, double interval) {
  const ContactImpulse& c = touch.contact;
  ragdoll_msgs::ContactState m;
  m.ragdoll = model.ragdolls[c.ragdoll].name;
  m.body = particlesName(model, c.ragdoll, c.particle);
  m.other = otherName(model, c, &m.other_body);
  m.position = toPoint(c.point);
  m.normal = toVector3(c.normal);
  m.depth = c.depth;
  m.force = toVector3(c.impulse / interval);
  m.peak_force = touch.peak_force;
  m.impulse = c.impulse.norm();
  m.slip = c.slip;
  return m;
}

ragdoll_msgs::Impact toImpact(const Model& model, const ImpactReport& impact) {
  const ContactImpulse& c = impact.contact;
  ragdoll_msgs::Impact m;
  m.step = impact.step;
  m.id = impact.id;
  m.over = impact.over;
  m.ragdoll = model.ragdolls[c.ragdoll].name;
  m.body = particlesName(model, c.ragdoll, c.particle);
  m.region = regionName(model, c.ragdoll, c.particle);
  m.other = otherName(model, c);
  m.position = toPoint(c.point);
  m.normal = toVector3(c.normal);
  m.approach_speed = c.approach;
  m.effective_mass = c.effective_mass;
  if (!impact.over) return m;
  m.impulse = c.impulse.norm();
  m.peak_force = impact.peak_force;
  m.duration = impact.duration;
  return m;
}

}  // namespace ragdoll
