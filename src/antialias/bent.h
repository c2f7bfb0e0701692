// Conditions that may hold in a place which no pixel's middle shows: what is compared is neither
// linear in the place nor a ratio of linear functions, so it may have a peak between the samples,
// as the distance from a small disc's middle has. Neighbours then go the same way all around.
#pragma once

#include <vector>

#include "antialias/roots.h"
#include "ir/module.h"
#include "passes/emit.h"
#include "stream/sample_source.h"

namespace pse::antialias {

struct Decisions;

// By the result of comparisons and steps in the main function: those that are bent and whose slopes
// are found with little work (fine.h). Values have their rates.
std::vector<bool> find_bent(const ir::Module& module, const Decisions& decisions,
                            const InputChanges& changes);

// Whether the edge of a comparison or a step is within `reach` pixels of the sample by f / |f'|,
// which is never too far for what bends like a distance or its square. Asks by `slope`
// instructions.
ir::Value is_near(const passes::Emit& emit, const ir::Instruction& decision, const Roots& roots,
                  float reach);

}  // namespace pse::antialias
