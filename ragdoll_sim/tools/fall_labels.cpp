#include "fall_labels.h"

#include <cstdio>
#include <limits>

namespace ragdoll::lab {

std::vector<Label> labelsOf(const falls::Record& record) {
  using Type = Label::Type;
  const falls::Fall& f = record.fall;
  const falls::Outcome& o = record.outcome;
  const double none = std::numeric_limits<double>::quiet_NaN();
  const bool pushed = !f.push_body.empty();
  char bag[kWordLength];  // as fall_dataset.py calls its bag
  std::snprintf(bag, sizeof bag, "fall_%08llu", static_cast<unsigned long long>(f.seed));
  return {
      {"bag", Type::kWord, 0, bag},
      {"seed", Type::kCount, static_cast<double>(f.seed), ""},
      {"start_yaw_deg", Type::kNumber, f.yaw, ""},
      {"start_pitch_deg", Type::kNumber, f.pitch, ""},
      {"start_roll_deg", Type::kNumber, f.roll, ""},
      {"friction", Type::kNumber, f.friction, ""},
      {"push_body", Type::kWord, 0, f.push_body},
      {"push_x", Type::kNumber, f.push.x(), ""},
      {"push_y", Type::kNumber, f.push.y(), ""},
      {"push_z", Type::kNumber, f.push.z(), ""},
      {"push_begin", Type::kNumber, pushed ? record.onset : none, ""},
      {"push_duration", Type::kNumber, f.push_duration, ""},
      {"impact_time", Type::kNumber, o.impact_time.value_or(none), ""},
      {"impact_body", Type::kWord, 0, o.impact_body},
      {"impact_speed", Type::kNumber, o.impact_time ? o.impact_speed : none, ""},
      {"end_pose", Type::kWord, 0, o.end_pose},
      {"end_head_height", Type::kNumber, o.end_head_height, ""},
      {"at_rest", Type::kCount, record.at_rest ? 1.0 : 0.0, ""},
      {"kind", Type::kWord, 0, f.kind},
      {"start", Type::kWord, 0, f.start},
      {"height", Type::kNumber, f.height, ""},
      {"mass", Type::kNumber, f.mass, ""},
      {"speed", Type::kNumber, f.speed, ""},
      {"foot", Type::kWord, 0, f.foot},
      {"foot_hold", Type::kNumber, f.hold, ""},
      {"foot_friction", Type::kNumber, f.foot_friction, ""},
      {"onset_time", Type::kNumber, record.onset, ""},
      {"impact_region", Type::kWord, 0, o.impact_region},
      {"peak_force", Type::kNumber, record.peak_force, ""},
      {"hic15", Type::kNumber, record.hic15, ""},
  };
}

}  // namespace ragdoll::lab
