// Telling the processor's level.
#include "codegen/target.h"

namespace pse {

const Target* host_target() {
  if (!__builtin_cpu_supports("x86-64-v2")) return nullptr;
  if (!__builtin_cpu_supports("x86-64-v3")) return &targets[0];
  if (!__builtin_cpu_supports("x86-64-v4")) return &targets[1];
  return __builtin_cpu_supports("avx512vbmi") ? &targets[3] : &targets[2];
}

const Target* find_target(std::string_view name) {
  if (name.empty()) return host_target();
  for (const Target& target : targets) {
    if (target.name == name) return &target;
  }
  return nullptr;
}

}  // namespace pse
