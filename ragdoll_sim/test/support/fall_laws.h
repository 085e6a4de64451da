// What holds in every fall by the default solver, alone or onto others.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "support/falls.h"

namespace ragdoll::test {

/// The figures, into the test's results.
inline void tell(const FallRecord& record) {
  const auto tell = [](const char* name, double value) {
    testing::Test::RecordProperty(name, std::to_string(value));
  };
  tell("limit_deg", record.limit_deg);
  tell("stretch", record.stretch);
  tell("penetration_mm", record.penetration_mm);
  tell("stick_mm", record.stick_mm);
  tell("overlap_mm", record.overlap_mm);
  tell("energy_rise_J", record.rise);
  tell("step_rise_J", record.step_rise);
  testing::Test::RecordProperty("resting", record.resting);
  testing::Test::RecordProperty("sleeping", record.sleeping);
}

/// Joints and sticks hold, nothing sinks in, and the energy never rises above its start.
inline void expectBodiesHold(const FallRecord& record) {
  EXPECT_LT(record.limit_deg, 2);
  EXPECT_LT(record.stretch, 1e-3);
  EXPECT_LT(record.penetration_mm, 1);
  EXPECT_LT(record.rise, 1e-2);
}

}  // namespace ragdoll::test
