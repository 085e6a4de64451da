#include "ragdoll_sim/world/crowd.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <map>
#include <mutex>
#include <thread>
#include <utility>

#include "ragdoll_sim/core/bounds.h"
#include "ragdoll_sim/core/error.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace ragdoll {
namespace {

/// Bodies of a batch: enough to fill packs while some sleep, few enough to stay in the cache.
constexpr std::size_t kMostInBatch = 64;

/// Skeletons with the same text become one, so that packs can share it.
void shareSkeletons(std::vector<Scene>& scenes) {
  std::map<const SkeletonSpec*, std::shared_ptr<const SkeletonSpec>> seen;
  std::map<std::string, std::shared_ptr<const SkeletonSpec>> known;
  std::vector<std::shared_ptr<const SkeletonSpec>> alive;  // so that no address is used twice
  for (Scene& scene : scenes)
    for (RagdollSpec& ragdoll : scene.ragdolls) {
      auto& same = seen[ragdoll.skeleton.get()];
      if (!same) {
        Scene only;
        only.ragdolls.resize(1);
        only.ragdolls[0].skeleton = ragdoll.skeleton;
        same = known.try_emplace(toYaml(only), ragdoll.skeleton).first->second;
        alive.push_back(ragdoll.skeleton);
      }
      ragdoll.skeleton = same;
    }
}

}  // namespace

void inParallel(int threads, int parts, const std::function<void(int)>& task) {
  if (threads <= 0) threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  std::atomic<int> next{0};
  std::mutex mutex;
  std::exception_ptr error;
  const auto work = [&] {
    for (int part = next++; part < parts; part = next++) {
      try {
        task(part);
      } catch (...) {
        const std::lock_guard<std::mutex> lock(mutex);
        if (!error) error = std::current_exception();
        next = parts;
      }
    }
  };
  std::vector<std::thread> others;
  for (int i = 1; i < std::min(threads, parts); ++i) others.emplace_back(work);
  work();
  for (std::thread& other : others) other.join();
  if (error) std::rethrow_exception(error);
}

Crowd::Crowd(std::vector<Scene> scenes, int threads) : threads_(threads) {
  if (scenes.empty()) throw Error("scenes", "there is none; at least one is expected");
  checkThreads("threads", threads);
  for (const Scene& scene : scenes)
    if (scene.solver.step != scenes.front().solver.step)
      throw Error(scene.where, "has another solver.step than the first scene; a crowd steps together");
  shareSkeletons(scenes);
  std::map<std::string, std::vector<int>> groups;
  std::vector<std::vector<int>> parts;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const std::string key = batchKey(scenes[i]);
    if (key.empty()) {
      parts.push_back({static_cast<int>(i)});
      continue;
    }
    std::vector<int>& group = groups[key];
    group.push_back(static_cast<int>(i));
    if (group.size() == kMostInBatch) parts.push_back(std::exchange(group, {}));
  }
  for (auto& [key, group] : groups)
    if (!group.empty()) parts.push_back(group);
  places_.resize(scenes.size());
  for (const std::vector<int>& part : parts) {
    std::vector<Scene> own;
    for (const int i : part) {
      places_[i] = {static_cast<int>(batches_.size()), static_cast<int>(own.size())};
      own.push_back(scenes[i]);
    }
    batches_.push_back(std::make_unique<Batch>(own));
  }
}

void Crowd::step(std::uint64_t steps) {
  inParallel(threads_, batches(), [&](int part) {
    for (std::uint64_t k = 0; k < steps; ++k) batches_[part]->advance();
  });
}

void Crowd::reset() {
  for (auto& batch : batches_) batch->reset();
}

}  // namespace ragdoll
