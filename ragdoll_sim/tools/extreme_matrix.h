// All tests by all methods: what `extremes` prints.
#pragma once

#include <cstdint>
#include <vector>

#include "extreme_verdict.h"
#include "progress.h"

namespace ragdoll::lab {

struct MatrixRow {
  Extreme test;
  std::vector<Verdict> verdicts;  ///< per method
};

/// The random scenes of one method.
struct RandomTally {
  int scenes = 0;
  std::vector<std::uint32_t> broken;  ///< seeds
  std::vector<std::string> laws;      ///< what each of them broke
  Verdict worst;                      ///< the largest of each figure

  void add(std::uint32_t seed, const Verdict& verdict);
};

/// Scenes drawn at random, numbered by seeds.
struct RandomGroup {
  std::string name;  ///< "random scenes"
  Extreme (*scene)(std::uint32_t seed);
  int scenes = 0;
  std::vector<RandomTally> tallies;  ///< per method
};

struct Matrix {
  std::vector<ExtremeMethod> methods;
  std::vector<MatrixRow> rows;
  std::vector<RandomGroup> random;

  bool defaultKeepsAll() const;
};

struct MatrixOptions {
  bool quick = false;
  bool tests = true;  ///< false: random scenes alone
  int random = 0;     ///< scenes
  int piles = 0;
  int driven = 0;          ///< scenes
  std::uint32_t seed = 0;  ///< of the first
  std::string only;        ///< only tests whose name contains this
  std::string method;      ///< only this one; empty: all
};

/// Runs everything on all processors. Throws Error.
Matrix runMatrix(const MatrixOptions& options, Progress& progress);

}  // namespace ragdoll::lab
