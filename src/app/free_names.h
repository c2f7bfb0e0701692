// Which channels of images a program seems to read: for `check`, `info` and --help, where no image
// is at hand.
#pragma once

#include <vector>

#include "lang/ast.h"
#include "lower/lower.h"

namespace pse::app {

// `color`, `alpha` and `Z`, and every `name.channel` whose `name` the program sets nowhere. A
// channel's components follow from its name: `alpha`, `Z` and other capitals are numbers, the rest
// vectors of three.
std::vector<StreamName> image_names_read(const lang::Program& program);

}  // namespace pse::app
