// Independent parts of a step on several threads (oneTBB, where it was there when this was built;
// else in turn). Who does what has no effect on the result.
#pragma once

#include <memory>

namespace ragdoll {

class TaskArena;

class Workers {
 public:
  Workers();
  ~Workers();
  Workers(Workers&&) noexcept;
  Workers& operator=(Workers&&) noexcept;

  /// How many may work at once. wanted: 0: as many as there are cores.
  static int count(int wanted);

  /// task(part, worker) for parts 0 ... parts - 1; worker: 0 ... threads - 1, one part at a time.
  /// By one thread, or with one part, it is a loop.
  template <class Task>
  void run(int threads, int parts, const Task& task) {
    if (threads < 2 || parts < 2) {
      for (int part = 0; part < parts; ++part) task(part, 0);
      return;
    }
    share(
        threads, parts,
        [](const void* t, int part, int worker) {
          (*static_cast<const Task*>(t))(part, worker);
        },
        &task);
  }

 private:
  using Call = void (*)(const void* task, int part, int worker);
  void share(int threads, int parts, Call call, const void* task);

  std::unique_ptr<TaskArena> arena_;
};

}  // namespace ragdoll
