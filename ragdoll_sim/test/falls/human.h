#pragma once

#include <memory>

#include "ragdoll_sim/io/model_yaml.h"
#include "ragdoll_sim/io/share.h"

namespace ragdoll::falls {

inline std::shared_ptr<const SkeletonSpec> human() {
  return loadModel(findModel("human", ".", "model"));
}

}  // namespace ragdoll::falls
