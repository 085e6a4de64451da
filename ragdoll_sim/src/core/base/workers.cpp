#include "core/base/workers.h"

#ifdef RAGDOLL_WITH_TBB
#define TBB_PREVIEW_GLOBAL_CONTROL 1  // TBB 2020, of Ubuntu 20.04
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <optional>
#include <thread>
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

struct Workers::Arena {
  explicit Arena(int threads) : size(threads), arena(threads) {}
  int size;
  tbb::task_arena arena;
  /// Orders the parts between what comes before and after, for who cannot see it in the library.
  std::atomic<int> begun{0}, done{0};
};

int Workers::count(int wanted) {
  return wanted > 0 ? wanted : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void Workers::share(int threads, int parts, Call call, const void* task) {
  if (!arena_ || arena_->size != threads) arena_ = std::make_unique<Arena>(threads);
  Arena& a = *arena_;
  const Allowed allowed(threads);
  const int grain = std::max(1, parts / (kShares * threads));
  a.begun.store(parts, std::memory_order_release);
  a.arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<int>(0, parts, grain),
        [&](const tbb::blocked_range<int>& range) {
          (void)a.begun.load(std::memory_order_acquire);
          const int worker = tbb::this_task_arena::current_thread_index();
          for (int i = range.begin(); i < range.end(); ++i) call(task, i, worker);
          a.done.fetch_add(1, std::memory_order_release);
        },
        tbb::simple_partitioner());
  });
  (void)a.done.load(std::memory_order_acquire);
}

#else

struct Workers::Arena {};

int Workers::count(int) { return 1; }

void Workers::share(int, int parts, Call call, const void* task) {
  for (int i = 0; i < parts; ++i) call(task, i, 0);
}

#endif

Workers::Workers() = default;
Workers::~Workers() = default;
Workers::Workers(Workers&&) noexcept = default;
Workers& Workers::operator=(Workers&&) noexcept = default;

}  // namespace ragdoll
