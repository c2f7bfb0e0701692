// Progress of a job on standard error: a bar with the time left, plain lines, or JSON lines.
#pragma once

#include <chrono>
#include <string>

#include "app/console.h"

namespace pse::app {

enum class ProgressStyle { none, plain, bar, json };

class Progress {
 public:
  Progress(Console& console, ProgressStyle style, int frames);

  // The frame that is now computed: the how-manieth, from 0, and its number.
  void begin_frame(int index, int frame);
  void update(double done_of_frame);
  void finish();

 private:
  double seconds() const;
  void show(double done);

  Console& console_;
  ProgressStyle style_;
  int frames_;
  int index_ = 0, frame_ = 0;
  int last_tenth_ = -1;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// The style that --progress asks for; by default a bar where standard error is a terminal.
ProgressStyle progress_style(const std::string& name, const Console& console);

}  // namespace pse::app
