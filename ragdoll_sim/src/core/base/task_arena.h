// oneTBB's loop over parts. A source of its own, which the thread sanitizer does not look into: half of
// the library is a part of whoever calls it, and locks of the other half it cannot see.
#pragma once

#include <memory>

namespace ragdoll {

class TaskArena {
 public:
  using Call = void (*)(const void* task, int begin, int end, int worker);

  explicit TaskArena(int threads);
  ~TaskArena();

  int threads() const { return threads_; }
  /// call(task, begin, end, worker) for ranges that make up 0 ... parts, and the end of all.
  void run(int parts, Call call, const void* task);

 private:
  struct Impl;
  int threads_;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ragdoll
