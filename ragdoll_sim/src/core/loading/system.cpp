#include "core/loading/system.h"

#include "core/loading/direct_system.h"

namespace ragdoll {
namespace {

std::vector<RelaxedStick> relaxedSticks(const Skeleton& skeleton, const Eigen::MatrixXd& W) {
  std::vector<RelaxedStick> out;
  for (const Stick& k : skeleton.sticks) {
    const double wa = W(k.a, k.a), wb = W(k.b, k.b);
    if (wa + wb > 0) out.push_back({k.a, k.b, k.length, wa / (wa + wb), wb / (wa + wb)});
  }
  return out;
}

}  // namespace

System buildSystem(const Skeleton& skeleton, int skeleton_index, const std::vector<int>& pins,
                   std::vector<std::string>& warnings) {
  System system;
  system.skeleton = skeleton_index;
  system.pins = pins;
  system.direct = buildDirectSystem(skeleton, pins, warnings);
  system.lumped = skeleton.lumped;
  if (skeleton.lumped) {  // the thesis's own weights; groups are held by their sticks
    system.W = skeleton.M.diagonal().cwiseInverse().asDiagonal();
    system.pin_motion = takeOutPins(pins, system.W);
    system.gravity = Eigen::RowVectorXd::Ones(skeleton.size()) * skeleton.M * system.W;
    system.relaxed = relaxedSticks(skeleton, system.W);
  } else {
    system.W = system.direct.W;
    system.pin_motion = system.direct.pin_motion;
    system.gravity = system.direct.gravity;
    system.coupled = skeleton.sticks;
    system.coupled.insert(system.coupled.end(), skeleton.hidden_sticks.begin(),
                          skeleton.hidden_sticks.end());
    const Eigen::Index count = static_cast<Eigen::Index>(system.coupled.size());
    system.relaxed_BW.resize(count, skeleton.size());
    system.relaxed_G.resize(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Stick& k = system.coupled[i];
      system.relaxed_BW.row(i) = system.W.row(k.b) - system.W.row(k.a);
      system.relaxed_G[i] = system.relaxed_BW(i, k.b) - system.relaxed_BW(i, k.a);
    }
  }
  return system;
}

}  // namespace ragdoll
