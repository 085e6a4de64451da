// ragdoll_peers: the same bodies in other engines, in one process: their rounds of timing are
// interleaved, medians count, and the clock is the thread's CPU time.
#include <cstdio>
#include <exception>
#include <string>

#include "comparisons.h"

int main(int argc, char** argv) {
  using namespace ragdoll::peers;
  const std::string what = argc > 1 ? argv[1] : "";
  if (argc > 2 || (argc == 2 && what != "pendulum" && what != "fall" && what != "crowd")) {
    std::fprintf(stderr, "Usage: ragdoll_peers [pendulum | fall | crowd]\n");
    return 2;
  }
  std::vector<Engine> engines = ragdollEngines();
  const auto add = [&engines](const std::vector<Engine>& more) {
    engines.insert(engines.end(), more.begin(), more.end());
  };
#ifdef RAGDOLL_WITH_BULLET
  add(bulletEngines());
#endif
#ifdef RAGDOLL_WITH_ODE
  add(odeEngines());
#endif
#ifdef RAGDOLL_WITH_MUJOCO
  add(mujocoEngines());
#endif
  try {
    if (what.empty() || what == "pendulum") comparePendulum(engines);
    if (what.empty() || what == "fall") compareFall(engines);
    if (what.empty() || what == "crowd") compareCrowd(engines);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "ragdoll_peers: %s\n", error.what());
    return 1;
  }
  return 0;
}
