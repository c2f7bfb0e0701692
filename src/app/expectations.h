// The pixels at which a program's expectations do not hold (ir/expectations.h), and the warnings
// that are made of them. Part of render_job.cpp's flow: bound while a frame is computed, told when
// it is written.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "codegen/kernel.h"
#include "diag/diagnostics.h"
#include "ir/module.h"
#include "stream/executor.h"

namespace pse::app {

// Of one program and of all that antialiasing makes of it. Only the samples at the centres of the
// window's pixels count, which are computed whatever the tiles are: what else is looked at, beside
// the picture or between pixels, changes no number.
class Expectations {
 public:
  explicit Expectations(const ir::Module& module);

  // Binds the expectations among the module's externals; what is bound lasts as long as this.
  void bind(const ir::Module& module, std::vector<ExternalFunction>& externals) const;
  // Forgets the last frame's pixels.
  void begin_frame(const Rect& window);
  // Warnings of code "expect": of each expectation one, of the first frame in which it fails.
  void report(double frame, Diagnostics& diagnostics);

 private:
  struct Watch {
    std::int32_t number = 0;  // index in Module::checks
    ir::Check check;
    bool told = false;
    Rect window;
    std::mutex mutex;
    std::vector<bool> failed;  // by pixel, row by row; empty before the first
  };
  // Arguments: px and py.
  static void note(void* self, std::int64_t count, const float* const* arguments,
                   float* const* results);

  std::vector<std::unique_ptr<Watch>> watches_;
};

}  // namespace pse::app
