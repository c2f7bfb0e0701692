// The IR's readable text form (`--emit ir`) and its parser. What is printed can be read back
// exactly.
//
//   input 0 "x" sample
//   output 0 "color.0"
//   entry function 0 "main" {
//     %0 = input 0                    # x
//     %1!c = const.f 0.5
//     %2 = flt %0 %1
//     %3:f = if %2 {
//       yield %1
//     } else {
//       yield %0
//     }
//     yield %3
//   }
//
// `!c` and `!f` mark values of rate constant and frame; `:f`, `:i`, `:b` give types that do not
// follow from the operator.
#pragma once

#include <expected>
#include <string>
#include <string_view>

#include "ir/module.h"

namespace pse::ir {

struct TextOptions {
  bool spans = false;  // also where in the source each instruction comes from, as `@file:begin:end`
};

std::string print(const Module& module, const TextOptions& options = {});

// The error is a sentence with its line. The module is not verified.
std::expected<Module, std::string> parse(std::string_view text);

}  // namespace pse::ir
