// Independent parts of a step on several threads (oneTBB, where it was there when this was built;
// else in turn). Who does what has no effect on the result.
#pragma once

#include <functional>
#include <memory>

namespace ragdoll::fast {

class Workers {
 public:
  Workers();
  ~Workers();
  Workers(Workers&&) noexcept;
  Workers& operator=(Workers&&) noexcept;

  /// How many may work at once. wanted: 0: as many as there are cores.
  static int count(int wanted);

  /// task(part, worker) for parts 0 ... parts - 1; worker: 0 ... threads - 1, one part at a time.
  void run(int threads, int parts, const std::function<void(int, int)>& task);

 private:
  struct Arena;
  std::unique_ptr<Arena> arena_;
};

}  // namespace ragdoll::fast
