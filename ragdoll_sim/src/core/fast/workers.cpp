#include "core/fast/workers.h"

#ifdef RAGDOLL_WITH_TBB
#define TBB_PREVIEW_GLOBAL_CONTROL 1  // TBB 2020, of Ubuntu 20.04
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <thread>
#endif

namespace ragdoll::fast {

#ifdef RAGDOLL_WITH_TBB

struct Workers::Arena {
  explicit Arena(int threads)
      : size(threads),
        allowed(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads)),
        arena(threads) {}
  int size;
  tbb::global_control allowed;  ///< more than there are cores, if asked for
  tbb::task_arena arena;
};

int Workers::count(int wanted) {
  return wanted > 0 ? wanted : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void Workers::run(int threads, int parts, const std::function<void(int, int)>& task) {
  if (threads < 2 || parts < 2) {
    for (int i = 0; i < parts; ++i) task(i, 0);
    return;
  }
  if (!arena_ || arena_->size != threads) arena_ = std::make_unique<Arena>(threads);
  arena_->arena.execute([&] {
    tbb::parallel_for(tbb::blocked_range<int>(0, parts), [&](const tbb::blocked_range<int>& range) {
      for (int i = range.begin(); i < range.end(); ++i)
        task(i, tbb::this_task_arena::current_thread_index());
    });
  });
}

#else

struct Workers::Arena {};

int Workers::count(int) { return 1; }

void Workers::run(int, int parts, const std::function<void(int, int)>& task) {
  for (int i = 0; i < parts; ++i) task(i, 0);
}

#endif

Workers::Workers() = default;
Workers::~Workers() = default;
Workers::Workers(Workers&&) noexcept = default;
Workers& Workers::operator=(Workers&&) noexcept = default;

}  // namespace ragdoll::fast
