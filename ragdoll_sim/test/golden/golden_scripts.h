// What the scripted runs of the golden list are made of.
#pragma once

#include <string>
#include <vector>

#include "golden_cases.h"

namespace ragdoll::golden {

inline const std::string kLies = "position: [0, 0, 0.3], rpy_deg: [0, -90, 0]";
inline const std::string kFloor = "obstacles: [{type: plane}]\n";

/// The key `ragdolls` with one body.
std::string human(const std::string& start, const std::string& model = "human");

/// [s] The end of the step that comes.
double timeAfter(const Run& run);

/// Whether the step that comes is the first at or after `time` [s], a multiple of 1/60.
bool isTime(const Run& run, double time);

/// Every pin on a circle of its own, from where it starts; stops after 1.5 s.
void leadPins(Run& run);

/// Adds a run by each kind of method.
class Scripts {
 public:
  explicit Scripts(std::vector<Case>& cases) : cases_(cases) {}

  /// Damping is the text's, the rest of the solver the method's; `change` is made to the scene.
  void add(const std::string& name, double seconds, const std::string& text,
           const Script& script = {}, const std::function<void(Scene&)>& change = {});

 private:
  std::vector<Case>& cases_;
};

void addActs(Scripts& scripts);    ///< somebody pins, pokes, moves obstacles, turns gravity
void addBodies(Scripts& scripts);  ///< sleep, bodies that touch, joints, bad starts
void addModels(Scripts& scripts);  ///< models that are not shipped, starts that loading puts right

}  // namespace ragdoll::golden
