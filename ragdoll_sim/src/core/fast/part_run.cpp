// What packs have left, in parts of the step: until something is hit, or even ones, as what turns
// over an edge errs by less the shorter they are.
#include <algorithm>
#include <cstddef>
#include <iterator>

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

/// Shares of the step that end at its end.
constexpr double kWhole = 1 - 1e-9;

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
    pack_.last.clear();
    pack_.parts.clear();
    for (std::size_t i = 0; i < pack_.again.size(); ++i) {
      PartTask part;
      part.ragdoll = pack_.again[i];
      retry(scratch_.again_hits[batch_.begin + i], part);
      pack_.parts.push_back(part);
    }
    while (!pack_.parts.empty()) takeParts();
    Roomy<CachedImpulse>& all = batch_.impulses;
    const auto stayed = [this](const CachedImpulse& p) { return has(batch_.left, p.ragdoll); };
    all.erase(std::remove_if(all.begin(), all.end(), stayed), all.end());
    exchange(true);
  }

 private:
  static bool has(const Roomy<int>& all, int index) {
    return std::find(all.begin(), all.end(), index) != all.end();
  }

  /// What a part of that length is held to: a short one to less.
  static void setBounds(PartTask& part) {
    const bool is_long = part.share > 1.0 / kParts + (1 - kWhole);
    part.bounds = is_long ? kOfStep : kOfPart;
    if (part.found >= kMostFound) part.bounds.stopped = kNone;
  }

  /// A part that was not taken, again: until it is hit, or in even parts. False: it was one.
  static bool retry(double hit, PartTask& part) {
    const double even = std::min(1.0 / kParts, 1 - part.done);
    if (hit < 1) {
      const double before = part.share * hit - kBeforeImpact * kImpactShare;
      part.strikes = before > 0;
      part.share = part.strikes ? before : std::min(kImpactShare, 1 - part.done);
      ++part.found;
    } else {
      if (part.even || !(part.share > even + (1 - kWhole))) return false;
      part.even = true;
      part.strikes = false;
      part.share = even;
    }
    setBounds(part);
    return true;
  }

  /// The next part of each body; what has come to the step's end or is left moves no more.
  void takeParts() {
    pack_.moving.clear();
    for (const PartTask& part : pack_.parts) pack_.moving.push_back(part.ragdoll);
    Batch& own = pack_.part;
    clear(own);
    own.system = batch_.system;
    own.begin = 0;
    own.count = static_cast<int>(pack_.parts.size());
    PackTask task;
    task.h = context_.h;
    task.bounds = kOfStep;
    task.parts = pack_.parts.data();
    task.order = pack_.moving.data();
    task.last = &pack_.last;
    PackRun(context_, task, scratch_, pack_.predicted, pack_.predicted, pack_, own).run();
    std::size_t kept = 0;
    for (const PartTask& part : pack_.parts) {
      PartTask next = part;
      if (goesOn(own, next)) pack_.parts[kept++] = next;
    }
    pack_.parts.resize(kept);
  }

  /// Whether the step goes on for a body after its part.
  bool goesOn(const Batch& own, PartTask& part) {
    const auto at = std::find(own.left.begin(), own.left.end(), part.ragdoll);
    if (at != own.left.end()) {
      if (retry(own.hits[at - own.left.begin()], part)) return true;
      batch_.left.push_back(part.ragdoll);
      return false;
    }
    const bool ends = part.done + part.share > kWhole;
    addPart(own.impulses, part.ragdoll, part.share, ends, batch_.impulses);
    if (ends) {
      for (const CachedImpulse& p : own.impulses)
        batch_.contacts += p.ragdoll == part.ragdoll && p.a >= 0;
      if (has(own.limited, part.ragdoll)) batch_.limited.push_back(part.ragdoll);
      return false;
    }
    const auto of = [&part](const CachedImpulse& p) { return p.ragdoll == part.ragdoll; };
    Roomy<CachedImpulse>& last = pack_.last;
    last.erase(std::remove_if(last.begin(), last.end(), of), last.end());
    std::copy_if(own.impulses.begin(), own.impulses.end(), std::back_inserter(last), of);
    part.done += part.share;
    part.last = part.share;
    part.share = 1 - part.done;
    if (part.even) part.share = std::min(1.0 / kParts, part.share);
    if (part.strikes) part.share = std::min(kImpactShare, part.share);
    part.strikes = false;
    setBounds(part);
    return true;
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

void addPart(const std::vector<CachedImpulse>& part, int ragdoll, double share, bool last,
             std::vector<CachedImpulse>& all) {
  for (std::size_t i = 0; i < part.size(); ++i) {
    if (ragdoll >= 0 && part[i].ragdoll != ragdoll) continue;
    if (part[i].a >= 0)
      sameAs(part, i, all).impulse += share * part[i].impulse;
    else if (last)
      all.push_back(part[i]);
  }
}

void stepParts(const StepContext& context, const FastScratch& scratch, PackScratch& pack,
               Batch& batch) {
  Parts(context, scratch, pack, batch).run();
}

}  // namespace ragdoll::fast
