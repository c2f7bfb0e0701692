// trace(), radiance() and visible() of programs: rays sent from inside a program into the scene
// that is being rendered. Bound to the kernel's externals (codegen/kernel.h).
#pragma once

#include "codegen/kernel.h"
#include "surface/shader.h"

namespace pse::surface {

// What trace() gives, in this order: distance, place 3, point 3, normal 3, uv 2, id, backface.
// lower/intrinsics_scene.cpp names the parts.
inline constexpr int hit_components = 14;

struct TraceCall {
  enum class What { trace, radiance, visible };
  What what = What::trace;
  const Shader* shader = nullptr;

  // The call that an external of this name is; nothing for others (textures).
  static std::optional<What> of(std::string_view external);
  // Arguments: two vectors of 3 and a value of sample rate, which keeps the call in the samples'
  // part of the program.
  static void run(void* self, std::int64_t count, const float* const* arguments,
                  float* const* results);
};

}  // namespace pse::surface
