// The processors that kernels are compiled for: a few levels of the x86-64 instruction set, told
// apart without LLVM. A level, not a model: a cached kernel serves every machine of its level, and
// all levels give the same bits.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace pse {

struct Target {
  std::string_view name;      // what CodegenOptions::cpu accepts
  std::string_view cpu;       // LLVM's -mcpu
  std::string_view features;  // LLVM's -mattr, added to the cpu's
  int width;                  // samples per vector that this level does best
  bool avx2, avx512, vbmi;
};

// Worst first.
inline constexpr std::array targets = {
    Target{"x86-64-v2", "x86-64-v2", "", 4, false, false, false},
    Target{"x86-64-v3", "x86-64-v3", "+fast-gather", 8, true, false, false},
    Target{"x86-64-v4", "x86-64-v4", "", 16, true, true, false},
    Target{"x86-64-v4-vbmi", "x86-64-v4", "+avx512vbmi", 16, true, true, true},
};

// The best level this processor has; null below x86-64-v2.
const Target* host_target();
// The level called `name`, or the host's where `name` is empty; null where there is none.
const Target* find_target(std::string_view name);

}  // namespace pse
