// The form of each value of a program's main function: how it changes with the place between two
// edges. Asked by what looks for edges between the samples (bent.h) and by what smooths outputs
// (courses.h).
#pragma once

#include <cstdint>
#include <vector>

#include "antialias/decisions.h"

namespace pse::antialias {

// The later, the less is known.
enum class Kind : std::uint8_t {
  constant,
  linear,
  reciprocal,  // one over a linear function
  ratio,       // of two linear functions, or by pieces of several kinds but the last
  bent,        // otherwise
};
struct Form {
  Kind kind = Kind::constant;
  ir::Value by = ir::no_value;  // of reciprocals and ratios: the value below; no_value: several
  bool operator==(const Form&) const = default;
};

// Of a sum or a difference.
Form sum(Form a, Form b);

// Whether someone looks for the folds of absolute values: those then have the form of what they are
// of, on both sides; otherwise they are bent.
enum class Folds : std::uint8_t { seen, unseen };

// By value. Linear are inputs, whatever the stream brings, and where rays end, which it brings too.
// Constant is what gives an answer or a whole number, since it changes at edges alone. Bent is what
// searches end with, their turns being no edges, and what arrays hold.
// `module` and `decisions` are those of find_decisions(), which may not know what is bent yet.
std::vector<Form> find_forms(const ir::Module& module, const Decisions& decisions, Folds folds);

}  // namespace pse::antialias
