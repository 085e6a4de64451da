// Service calls on a thread of their own: a node that is absent or hangs never holds up the GUI.
#pragma once

#include <ros/names.h>
#include <ros/node_handle.h>
#include <ros/service_client.h>

#include <QMetaObject>
#include <QObject>
#include <QString>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace ragdoll_rviz {

class Caller {
 public:
  static constexpr std::size_t kMaxWaiting = 4;  ///< calls; more are refused

  Caller();
  ~Caller();  ///< cuts off a call that is under way

  /// Calls a service, later. done(problem, response) runs in the thread of `receiver`, which must
  /// live longer than this; problem is empty if the service has answered.
  template <class Service>
  void call(const std::string& name, const typename Service::Request& request, QObject* receiver,
            std::function<void(const QString&, const typename Service::Response&)> done) {
    const auto report = [receiver, done](const QString& problem,
                                         const typename Service::Response& response) {
      QMetaObject::invokeMethod(
          receiver, [=] { done(problem, response); }, Qt::QueuedConnection);
    };
    std::string invalid;
    if (!ros::names::validate(name, invalid)) return report(QString::fromStdString(invalid), {});
    const bool posted = post([this, name, request, report] {
      typename Service::Request asked = request;
      typename Service::Response response;
      // A persistent client can be cut off from another thread.
      ros::ServiceClient client = ros::NodeHandle().serviceClient<Service>(name, true);
      QString problem;
      if (!client.isValid() || !begin(client))
        problem = QString("no answer from %1").arg(QString::fromStdString(name));
      else if (!client.call(asked, response))
        problem = QString("%1 has failed").arg(QString::fromStdString(name));
      end();
      report(problem, response);
    });
    if (!posted) report("still waiting for an answer", {});
  }

 private:
  bool post(std::function<void()> job);
  bool begin(const ros::ServiceClient& client);
  void end();
  void run();

  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::function<void()>> jobs_;
  ros::ServiceClient active_;  ///< of the call that is under way
  bool stopping_ = false;
  std::thread thread_;  // last
};

}  // namespace ragdoll_rviz
