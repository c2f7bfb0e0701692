// How libpng's errors come back: it jumps out of its call. guarded() is the only place that the
// jump lands, and what runs inside it must own nothing, because the jump skips destructors.
// Included only by the PNG reader and writer.
#pragma once

#include <png.h>

#include <csetjmp>
#include <cstdio>

namespace pse::image::png {

// What an error leaves behind; libpng's error pointer leads here.
struct Trouble {
  char message[256] = {};
};

inline void on_error(png_structp png, png_const_charp message) {
  auto* trouble = static_cast<Trouble*>(png_get_error_ptr(png));
  std::snprintf(trouble->message, sizeof trouble->message, "%s", message);
  std::longjmp(*png_set_longjmp_fn(png, std::longjmp, sizeof(jmp_buf)), 1);
}

inline void on_warning(png_structp, png_const_charp) {}

// Runs `step`, which calls libpng and owns nothing. False when libpng jumped out of it.
template <class Step>
bool guarded(png_structp png, const Step& step) {
  if (setjmp(*png_set_longjmp_fn(png, std::longjmp, sizeof(jmp_buf))) != 0) return false;
  step();
  return true;
}

}  // namespace pse::image::png
