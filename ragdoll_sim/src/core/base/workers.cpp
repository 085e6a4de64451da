#include "core/base/workers.h"

#include <algorithm>
#include <atomic>
#include <thread>

#include "core/base/task_arena.h"

namespace ragdoll {
namespace {

/// Order parts between what comes before and after, for who cannot see that in the library.
std::atomic<unsigned> begun{0}, done{0};

struct TaskParts {
  void (*call)(const void* task, int part, int worker);
  const void* task;
};

void runRange(const void* parts, int begin, int end, int worker) {
  (void)begun.load(std::memory_order_acquire);
  const TaskParts& p = *static_cast<const TaskParts*>(parts);
  for (int part = begin; part < end; ++part) p.call(p.task, part, worker);
  done.fetch_add(1, std::memory_order_release);
}

}  // namespace

int Workers::count(int wanted) {
#ifdef RAGDOLL_WITH_TBB
  return wanted > 0 ? wanted : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
#else
  (void)wanted;
  return 1;
#endif
}

void Workers::share(int threads, int parts, Call call, const void* task) {
  if (!arena_ || arena_->threads() != threads) arena_ = std::make_unique<TaskArena>(threads);
  const TaskParts all{call, task};
  begun.fetch_add(1, std::memory_order_release);
  arena_->run(parts, runRange, &all);
  (void)done.load(std::memory_order_acquire);
}

Workers::Workers() = default;
Workers::~Workers() = default;
Workers::Workers(Workers&&) noexcept = default;
Workers& Workers::operator=(Workers&&) noexcept = default;

}  // namespace ragdoll
