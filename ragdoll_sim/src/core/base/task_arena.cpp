#include "core/base/task_arena.h"

#ifdef RAGDOLL_WITH_TBB
#define TBB_PREVIEW_GLOBAL_CONTROL 1  // TBB 2020, of Ubuntu 20.04
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <optional>
#endif

namespace ragdoll {

#ifdef RAGDOLL_WITH_TBB

namespace {

constexpr int kShares = 16;  ///< of a thread: what one leaves others take

/// More threads than there are cores, if asked for.
class Allowed {
 public:
  explicit Allowed(int threads) {
    constexpr auto kThreads = tbb::global_control::max_allowed_parallelism;
    const auto wanted = static_cast<std::size_t>(threads);
    if (tbb::global_control::active_value(kThreads) < wanted) control_.emplace(kThreads, wanted);
  }

 private:
  std::optional<tbb::global_control> control_;
};

}  // namespace

struct TaskArena::Impl {
  explicit Impl(int threads) : arena(threads) {}
  tbb::task_arena arena;
};

TaskArena::TaskArena(int threads) : threads_(threads), impl_(std::make_unique<Impl>(threads)) {}

void TaskArena::run(int parts, Call call, const void* task) {
  const Allowed allowed(threads_);
  const int grain = std::max(1, parts / (kShares * threads_));
  impl_->arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<int>(0, parts, grain),
        [&](const tbb::blocked_range<int>& range) {
          call(task, range.begin(), range.end(), tbb::this_task_arena::current_thread_index());
        },
        tbb::simple_partitioner());
  });
}

#else

struct TaskArena::Impl {};

TaskArena::TaskArena(int threads) : threads_(threads) {}

void TaskArena::run(int parts, Call call, const void* task) { call(task, 0, parts, 0); }

#endif

TaskArena::~TaskArena() = default;

}  // namespace ragdoll
