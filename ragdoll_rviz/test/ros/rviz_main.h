// A test program within rviz, on a screen of its own.
#pragma once

#include <gtest/gtest.h>
#include <ros/ros.h>
#include <rviz/visualization_frame.h>

#include <QApplication>
#include <cstdlib>
#include <memory>

#include "virtual_screen.h"

namespace ragdoll_test {

inline rviz::VisualizationFrame* rviz_frame = nullptr;  ///< there can be one; null without a screen

/// All tests. argv[1]: the configuration that rviz shows.
inline int runInRviz(int argc, char** argv, const char* name) {
  testing::InitGoogleTest(&argc, argv);
  const VirtualScreen screen;
  setenv("QT_QPA_PLATFORM", screen.there() ? "xcb" : "offscreen", 1);
  setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
  ros::init(argc, argv, name);
  ros::NodeHandle nh;  // keeps ROS going
  QApplication application(argc, argv);
  std::unique_ptr<rviz::VisualizationFrame> frame;
  if (screen.there() && argc > 1) {
    frame = std::make_unique<rviz::VisualizationFrame>();
    frame->setShowChooseNewMaster(false);
    frame->setSplashPath("");
    frame->initialize(argv[1]);
    frame->resize(1200, 800);
    frame->show();
    rviz_frame = frame.get();
  }
  return RUN_ALL_TESTS();
}

}  // namespace ragdoll_test
