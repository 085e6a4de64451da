// What packs have left, in parts of the step: what turns over an edge or is stopped errs by less
// the shorter they are.
#include <algorithm>
#include <cstddef>

#include "core/direct/impulse_cache.h"
#include "core/fast/constants.h"
#include "core/fast/pack_run.h"

namespace ragdoll::fast {
namespace {

/// Of `all`, the entry of the i-th impulse of a part: of the same contact, in their order.
CachedImpulse& sameAs(const std::vector<CachedImpulse>& part, std::size_t i,
                      std::vector<CachedImpulse>& all) {
  const CachedImpulse& p = part[i];
  const auto same = [&p](const CachedImpulse& q) {
    return q.ragdoll == p.ragdoll && isOfSame(p, q);
  };
  auto nth = std::count_if(part.begin(), part.begin() + static_cast<std::ptrdiff_t>(i), same);
  for (CachedImpulse& q : all)
    if (same(q) && nth-- == 0) return q;
  all.push_back(p);
  all.back().impulse = Vec3::Zero();
  return all.back();
}

class Parts {
 public:
  Parts(const StepContext& context, const FastScratch& scratch, PackScratch& pack, Batch& batch)
      : context_(context), scratch_(scratch), pack_(pack), batch_(batch) {
    const auto first = scratch.again.begin() + batch.begin;
    pack.again.assign(first, first + batch.count);
    n_ = 3 * scratch.bodies[batch.system].tree.particles;
    const std::size_t room = 2 * n_ * pack.again.size();  // a worker may have had no pack before
    if (pack.start.size() < room) pack.start.resize(room);
  }

  /// Leaves what does not come through either where it was.
  void run() {
    exchange(false);
    pack_.moving = pack_.again;
    const std::vector<CachedImpulse>* last = nullptr;
    for (int part = 0; part < kParts && !pack_.moving.empty(); ++part) {
      Batch& own = pack_.parts[part % 2];
      clear(own);
      own.system = batch_.system;
      own.begin = 0;
      own.count = static_cast<int>(pack_.moving.size());
      PackTask task;
      task.h = context_.h / kParts;
      task.left = kParts - part;
      task.order = pack_.moving.data();
      task.last = last;
      PackRun(context_, task, scratch_, pack_.predicted, pack_.predicted, pack_, own).run();
      append(own.left, batch_.left);
      const auto stays = [&own](int index) { return has(own.left, index); };
      pack_.moving.erase(std::remove_if(pack_.moving.begin(), pack_.moving.end(), stays),
                         pack_.moving.end());
      last = &own.impulses;
      add(own, part + 1 == kParts);
    }
    Roomy<CachedImpulse>& all = batch_.impulses;
    const auto stayed = [this](const CachedImpulse& p) { return has(batch_.left, p.ragdoll); };
    all.erase(std::remove_if(all.begin(), all.end(), stayed), all.end());
    exchange(true);
  }

 private:
  static bool has(const Roomy<int>& all, int index) {
    return std::find(all.begin(), all.end(), index) != all.end();
  }

  void add(const Batch& part, bool last) {
    addPart(part.impulses, last, batch_.impulses);
    if (!last) return;
    batch_.contacts += part.contacts;
    append(part.limited, batch_.limited);
  }

  /// Keeps x and v, or gives them back to what is left.
  void exchange(bool back) {
    for (std::size_t i = 0; i < pack_.again.size(); ++i) {
      if (back && !has(batch_.left, pack_.again[i])) continue;
      const int first = 3 * context_.model.ragdolls[pack_.again[i]].first;
      for (double* state : {context_.state.x.data() + first, context_.state.v.data() + first}) {
        const bool is_v = state != context_.state.x.data() + first;
        double* kept = pack_.start.data() + n_ * (2 * i + is_v);
        if (back)
          std::copy_n(kept, n_, state);
        else
          std::copy_n(state, n_, kept);
      }
    }
  }

  const StepContext& context_;
  const FastScratch& scratch_;
  PackScratch& pack_;
  Batch& batch_;
  int n_ = 0;  ///< 3 per particle
};

}  // namespace

void addPart(const std::vector<CachedImpulse>& part, bool last, std::vector<CachedImpulse>& all) {
  for (std::size_t i = 0; i < part.size(); ++i) {
    if (part[i].a >= 0)
      sameAs(part, i, all).impulse += (1.0 / kParts) * part[i].impulse;
    else if (last)
      all.push_back(part[i]);
  }
}

void stepParts(const StepContext& context, const FastScratch& scratch, PackScratch& pack,
               Batch& batch) {
  Parts(context, scratch, pack, batch).run();
}

}  // namespace ragdoll::fast
