#include "extreme_matrix.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

#include "extreme_random.h"
#include "ragdoll_sim/core/error.h"

namespace ragdoll::lab {
namespace {

/// Runs work(i) for all i < count, on all processors; `done` is told how many are finished.
void onAllProcessors(std::size_t count, const std::function<void(std::size_t)>& work,
                     const std::function<void(std::size_t)>& done) {
  std::atomic<std::size_t> next{0};
  std::size_t finished = 0;
  std::mutex mutex;
  std::exception_ptr fault;
  const auto run = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      try {
        work(i);
      } catch (...) {
        const std::lock_guard<std::mutex> lock(mutex);
        fault = std::current_exception();
        next = count;
        return;
      }
      const std::lock_guard<std::mutex> lock(mutex);
      done(++finished);
    }
  };
  std::vector<std::thread> threads;
  for (unsigned i = 1; i < std::max(1u, std::thread::hardware_concurrency()); ++i)
    threads.emplace_back(run);
  run();
  for (std::thread& t : threads) t.join();
  if (fault) std::rethrow_exception(fault);
}

}  // namespace

void RandomTally::add(std::uint32_t seed, const Verdict& v) {
  ++scenes;
  worst.stick_error = std::max(worst.stick_error, v.stick_error);
  worst.energy_rise = std::max(worst.energy_rise, v.energy_rise);
  worst.depth = std::max(worst.depth, v.depth);
  worst.guard.max_substeps = std::max(worst.guard.max_substeps, v.guard.max_substeps);
  if (v.kept()) return;
  broken.push_back(seed);
  for (const std::string& law : v.broken) laws.push_back(law);
}

bool Matrix::defaultKeepsAll() const {
  bool kept = true;
  for (std::size_t m = 0; m < methods.size(); ++m) {
    if (!methods[m].is_default) continue;
    for (const MatrixRow& row : rows) kept = kept && row.verdicts[m].kept();
    for (const RandomGroup& group : random) kept = kept && group.tallies[m].broken.empty();
  }
  return kept;
}

Matrix runMatrix(const MatrixOptions& options, Progress& progress) {
  Matrix matrix;
  for (const ExtremeMethod& method : extremeMethods())
    if (options.method.empty() || method.name == options.method) matrix.methods.push_back(method);
  if (matrix.methods.empty())
    throw Error("--method", "there is no method '" + options.method +
                                "' in the matrix; there are jakobsen, fast, shake and rk");
  const std::size_t columns = matrix.methods.size();
  for (const Extreme& test : extremeTests(options.quick))
    if (options.tests && (test.group + ": " + test.name).find(options.only) != std::string::npos)
      matrix.rows.push_back({test, std::vector<Verdict>(columns)});
  if (options.tests && matrix.rows.empty())
    throw Error("--only", "no test's name contains '" + options.only + "'");
  matrix.random = {{"random scenes", randomExtreme, options.random, {}},
                   {"random piles", randomPile, options.piles, {}},
                   {"random driven scenes", randomDriven, options.driven, {}}};
  const std::size_t cells = matrix.rows.size() * columns;
  struct RandomCell {
    RandomGroup* group;
    std::uint32_t seed;
    std::size_t method;
    Verdict verdict;
  };
  std::vector<RandomCell> random;
  for (RandomGroup& group : matrix.random) {
    group.tallies.resize(columns);
    for (int i = 0; i < group.scenes; ++i)
      for (std::size_t m = 0; m < columns; ++m)
        random.push_back({&group, options.seed + static_cast<std::uint32_t>(i), m, {}});
  }
  const auto work = [&](std::size_t i) {
    if (i < cells) {
      MatrixRow& row = matrix.rows[i / columns];
      row.verdicts[i % columns] = judge(row.test, matrix.methods[i % columns]);
    } else {
      RandomCell& cell = random[i - cells];
      cell.verdict = judge(cell.group->scene(cell.seed), matrix.methods[cell.method]);
    }
  };
  onAllProcessors(cells + random.size(), work, [&](std::size_t finished) {
    progress.show(static_cast<double>(finished) / static_cast<double>(cells + random.size()),
                  finished < cells ? matrix.rows[finished / columns].test.group : "random scenes");
  });
  for (const RandomCell& cell : random) cell.group->tallies[cell.method].add(cell.seed, cell.verdict);
  return matrix;
}

}  // namespace ragdoll::lab
