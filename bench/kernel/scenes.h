// The programs whose speed is measured: the three scenes of DESIGN.md section 7 and the noises
// below them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "passes/pipeline.h"

namespace pse::bench {

struct Scene {
  std::string name;
  passes::SplitModule split;
  double noises;  // noise evaluations per sample
  // The expected output 0 at (x, y, z), up to rounding of a few last bits.
  std::function<float(float x, float y, float z)> expected;
};

std::vector<Scene> noise_scenes();

}  // namespace pse::bench
