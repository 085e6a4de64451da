// A step depends on the state alone. Scratch that is kept from step to step saves work; it has the
// same bits as with none.
#include <gtest/gtest.h>

#include <string>

#include "ragdoll_sim/core/inputs.h"
#include "ragdoll_sim/core/measures.h"
#include "ragdoll_sim/core/step.h"
#include "ragdoll_sim/io/scene_yaml.h"

namespace ragdoll {
namespace {

void expectSameBits(const std::string& text, int steps) {
  const Model model = buildModel(parseScene(text, "test"));
  const Inputs inputs = startInputs(model);
  Workspace kept;
  State with = startState(model), without = with;
  for (int i = 0; i < steps; ++i) {
    Workspace fresh;
    step(model, inputs, kept, with);
    step(model, inputs, fresh, without);
    ASSERT_EQ(hash(with), hash(without)) << "step " << i << " of\n" << text;
  }
}

constexpr char kFloor[] = "obstacles: [{type: plane, point: [0, 0, 0], normal: [0, 0, 1]}]\n";

TEST(Scratch, leavesNoTraceInAFall) {
  expectSameBits("ragdolls: [{model: human, position: [0, 0, 1.2], rpy_deg: [80, 20, 0]}]\n" +
                     std::string(kFloor),
                 300);
}

TEST(Scratch, leavesNoTraceOnABox) {
  expectSameBits(
      "self_collision: true\n"
      "ragdolls: [{model: human, position: [0, 0, 1.5], rpy_deg: [-80, 0, 30]}]\n"
      "obstacles: [{type: box, position: [0, 0, 0.2], size: [0.6, 0.6, 0.4]}]\n",
      200);
}

TEST(Scratch, leavesNoTraceInAPile) {
  expectSameBits(
      "ragdoll_collision: true\n"
      "ragdolls: [{name: a, model: human, position: [0, 0, 0.5], rpy_deg: [90, 0, 0]},\n"
      "           {name: b, model: human, position: [0.2, 0, 1.1], rpy_deg: [90, 0, 60]}]\n" +
          std::string(kFloor),
      150);
}

}  // namespace
}  // namespace ragdoll
