// A loop over parts by several threads: who does what is open, what is done is not.
#include "core/base/task_arena.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <utility>
#include <vector>

#include "core/base/workers.h"

namespace ragdoll {
namespace {

/// What the calls of one run were.
struct Calls {
  explicit Calls(int threads, int parts) : done(parts), busy(threads) {}

  std::vector<std::atomic<int>> done;   ///< per part, how often
  std::vector<std::atomic<bool>> busy;  ///< per worker
  std::atomic<int> longest{0};          ///< range
  std::atomic<bool> stranger{false};    ///< a worker beyond the threads
  std::atomic<bool> twice{false};       ///< a worker at two ranges at once

  void take(int begin, int end, int worker) {
    if (worker < 0 || worker >= static_cast<int>(busy.size())) {
      stranger = true;
      return;
    }
    if (busy[worker].exchange(true)) twice = true;
    for (int part = begin; part < end; ++part) ++done[part];
    int seen = longest;
    while (seen < end - begin && !longest.compare_exchange_weak(seen, end - begin)) {
    }
    busy[worker] = false;
  }
};

/// Runs the parts on the arena; what the calls were is complete when it returns.
void run(TaskArena& arena, int parts, Calls& calls) {
  Calls* const to = &calls;
  arena.run(
      parts,
      [](const void* task, int begin, int end, int worker) {
        (*static_cast<Calls* const*>(task))->take(begin, end, worker);
      },
      &to);
}

/// Fewer threads than cores and more, fewer parts than threads and many more.
TEST(TaskArena, RangesMakeUpAllPartsOnce) {
  for (const int threads : {1, 2, 7}) {
    TaskArena arena(threads);
    EXPECT_EQ(arena.threads(), threads);
    for (const int parts : {0, 1, 2, 31, 32, 33, 5000}) {
      Calls calls(threads, parts);
      run(arena, parts, calls);
      EXPECT_TRUE(std::all_of(calls.done.begin(), calls.done.end(), [](int n) { return n == 1; }))
          << parts << " parts on " << threads;
      EXPECT_FALSE(calls.stranger) << parts << " parts on " << threads;
      EXPECT_FALSE(calls.twice) << parts << " parts on " << threads;
    }
  }
}

TEST(TaskArena, RangesAreASixteenthOfAThreadsShareOrOnePart) {
  if (Workers::count(2) < 2) GTEST_SKIP() << "built without oneTBB: one range";
  TaskArena arena(2);
  for (const auto& [parts, most] : {std::pair{3200, 100}, {64, 2}, {33, 1}, {5, 1}}) {
    Calls calls(2, parts);
    run(arena, parts, calls);
    EXPECT_LE(calls.longest, most) << parts;
  }
}

}  // namespace
}  // namespace ragdoll
