// Conditions that may hold in a place which no pixel's middle shows: what is compared is neither
// linear in the place nor a ratio of linear functions, so it may have a peak between the samples,
// as the distance from a small disc's middle has. Neighbours then go the same way all around.
#pragma once

#include <optional>
#include <vector>

#include "antialias/forms.h"
#include "antialias/roots.h"
#include "passes/emit.h"
#include "stream/sample_source.h"

namespace pse::antialias {

struct Decisions;

// By the result of comparisons and steps in the main function: those that are bent and whose slopes
// are found with little work (fine.h). Values have their rates.
std::vector<bool> find_bent(const ir::Module& module, const Decisions& decisions,
                            const InputChanges& changes);

// Numbers of the frame that the slopes of distances never exceed: a length of what is linear in the
// place changes from pixel to pixel by no more than that moves, and sums and parts of lengths
// likewise. It takes the place of a slope at every sample.
class SlopeBounds {
 public:
  // Of the main function's values as they are now, for decisions that are bent and cheap.
  SlopeBounds(const ir::Module& module, const Decisions& decisions);
  // Nothing where no bound is known. Asks by `slope` instructions.
  std::optional<ir::Value> of(const passes::Emit& emit, ir::Value value) const;

 private:
  struct Definition {
    ir::Op op = ir::Op::input;
    std::vector<ir::Value> operands;
  };
  void define(const ir::Region& region);
  bool is_even(ir::Value value) const { return forms_[value].kind == Kind::constant; }
  bool add_squares(ir::Value value, std::vector<ir::Value>& of) const;

  std::vector<Form> forms_;
  std::vector<Definition> definitions_;
};

// Whether the edge of a comparison or a step is within `reach` pixels of the sample by f / |f'|,
// which is never too far for what bends like a distance or its square; where a bound on |f'| is
// known, by that. Asks by `slope` instructions.
ir::Value is_near(const passes::Emit& emit, const ir::Instruction& decision, const Roots& roots,
                  const SlopeBounds& bounds, float reach);

}  // namespace pse::antialias
