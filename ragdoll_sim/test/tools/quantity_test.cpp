#include "quantity.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/error_of.h"

namespace ragdoll::lab {
namespace {

using test::errorOf;
using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(Quantity, LengthsInMetres) {
  EXPECT_DOUBLE_EQ(parseLength("--error", "1mm"), 1e-3);
  EXPECT_DOUBLE_EQ(parseLength("--error", "0.5 cm"), 5e-3);
  EXPECT_DOUBLE_EQ(parseLength("--error", "2m"), 2);
  EXPECT_DOUBLE_EQ(parseLength("--error", "1e2um"), 1e-4);
}

TEST(Quantity, TimesInSeconds) {
  EXPECT_DOUBLE_EQ(parseTime("--budget", "50us"), 5e-5);
  EXPECT_DOUBLE_EQ(parseTime("--budget", "1.5ms/s"), 1.5e-3);
  EXPECT_DOUBLE_EQ(parseTime("--budget", "1s"), 1);
}

TEST(Quantity, WhatIsWrongIsSaid) {
  for (const char* text :
       {"", "mm", "1", "1 inch", "-1mm", "0mm", "1e-320nm", "nanmm", "1mm2", "1us"})
    EXPECT_THAT(errorOf([&] { parseLength("--error", text); }),
                AllOf(HasSubstr("--error"), HasSubstr("mm, cm"), HasSubstr("such as 1mm")))
        << text;
  for (const char* text : {"", "us", "50", "50mm", "-1us", "infs", "/s"})
    EXPECT_THAT(errorOf([&] { parseTime("--budget", text); }),
                AllOf(HasSubstr("--budget"), HasSubstr("us, ms"), HasSubstr("such as 50us")))
        << text;
}

TEST(Quantity, TextHasThreeDigitsAndASuitableUnit) {
  EXPECT_EQ(lengthText(8.1234e-4), "812 um");
  EXPECT_EQ(lengthText(0.02), "20 mm");
  EXPECT_EQ(lengthText(1.5), "1.5 m");
  EXPECT_EQ(lengthText(1e-12), "0.001 nm");
  EXPECT_EQ(timeText(9.52e-5), "95.2 us");
  EXPECT_EQ(timeText(0.25), "250 ms");
}

}  // namespace
}  // namespace ragdoll::lab
