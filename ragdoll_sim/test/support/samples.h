// How many samples a random law takes.
#pragma once

#include <algorithm>

namespace ragdoll::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

/// A tenth where a sanitizer makes each step some ten times as slow: the same law, of fewer samples.
constexpr int samples(int count) { return kSanitized ? std::max(count / 10, 1) : count; }

}  // namespace ragdoll::test
