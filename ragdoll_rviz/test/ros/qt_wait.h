// What the tests in a Qt application share: waiting for conditions.
#pragma once

#include <ros/ros.h>

#include <QCoreApplication>
#include <QElapsedTimer>
#include <chrono>
#include <functional>
#include <thread>

namespace ragdoll_test {

constexpr int kLimit = 30000;  ///< [ms] a test that waits longer than this has failed

/// Lets Qt and ROS work, as rviz does, until the condition comes true; false if it does not.
inline bool waitFor(const std::function<bool()>& condition) {
  QElapsedTimer timer;
  timer.start();
  while (timer.elapsed() < kLimit) {
    QCoreApplication::processEvents(QEventLoop::AllEvents, 5);
    ros::spinOnce();
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return false;
}

}  // namespace ragdoll_test
