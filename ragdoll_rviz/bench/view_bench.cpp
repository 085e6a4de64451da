// How many pictures a second rviz makes of a running simulation, on a screen of its own:
//   view_bench CONFIG.rviz [SECONDS [WARM_UP [PICTURE.png]]] [--smooth]
// prints pictures per second, rviz's CPU [% of a core] and its memory [MB]. Without
// --smooth edges are not smoothed, as crowd.launch has it. See crowd_table.py.
#include <ros/ros.h>
#include <rviz/ogre_helpers/render_system.h>
#include <rviz/visualization_frame.h>
#include <rviz/visualization_manager.h>
#include <sys/resource.h>

#include <QApplication>
#include <QElapsedTimer>
#include <QScreen>
#include <QWindow>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>

#include "../test/ros/virtual_screen.h"

namespace {

double cpuSeconds() {
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double memory() {
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

void work(double seconds) {
  QElapsedTimer timer;
  timer.start();
  while (static_cast<double>(timer.elapsed()) < 1000 * seconds)
    QCoreApplication::processEvents(QEventLoop::WaitForMoreEvents, 10);
}

}  // namespace

int main(int argc, char** argv) {
  const ragdoll_test::VirtualScreen screen;
  if (argc < 2 || !screen.there()) {
    std::fprintf(stderr, argc < 2 ? "view_bench CONFIG.rviz [SECONDS [WARM_UP [PICTURE.png]]] [--smooth]\n"
                                  : "view_bench: no Xvfb\n");
    return 2;
  }
  setenv("QT_QPA_PLATFORM", "xcb", 1);
  setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
  ros::init(argc, argv, "view_bench", ros::init_options::AnonymousName);
  ros::NodeHandle nh;
  QApplication application(argc, argv);
  if (argc > 1 && argv[argc - 1] == std::string("--smooth"))
    --argc;
  else
    rviz::RenderSystem::disableAntiAliasing();
  rviz::VisualizationFrame frame;
  frame.setShowChooseNewMaster(false);
  frame.setSplashPath("");
  frame.initialize(argv[1]);
  frame.show();
  const double seconds = argc > 2 ? std::atof(argv[2]) : 10;
  work(argc > 3 ? std::atof(argv[3]) : 5);
  int pictures = 0;
  QObject::connect(frame.getManager(), &rviz::VisualizationManager::preUpdate,
                   [&] { ++pictures; });
  const double cpu = cpuSeconds();
  QElapsedTimer timer;
  timer.start();
  work(seconds);
  const double passed = 1e-3 * static_cast<double>(timer.elapsed());
  std::printf("%.1f %.0f %.0f\n", pictures / passed, 100 * (cpuSeconds() - cpu) / passed, memory());
  std::fflush(stdout);
  if (argc > 4) QGuiApplication::primaryScreen()->grabWindow(frame.winId()).save(argv[4]);
  return 0;
}
