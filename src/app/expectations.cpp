// Marking pixels, and counting them.
#include "app/expectations.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ir/expectations.h"

namespace pse::app {
namespace {

// The whole number below `place` where that is the centre of a pixel from first to end; else -1.
int pixel_at(float place, int first, int end) {
  const float whole = std::floor(place);
  const bool inside = place - whole == 0.5f && whole >= static_cast<float>(first) &&
                      whole < static_cast<float>(end);
  return inside ? static_cast<int>(whole) - first : -1;
}

}  // namespace

Expectations::Expectations(const ir::Module& module) {
  for (const ir::External& external : module.externals) {
    const auto number = ir::expectation_of(external);
    if (!number || static_cast<std::size_t>(*number) >= module.checks.size()) continue;
    watches_.push_back(std::make_unique<Watch>());
    watches_.back()->number = *number;
    watches_.back()->check = module.checks[static_cast<std::size_t>(*number)];
  }
}

void Expectations::bind(const ir::Module& module, std::vector<ExternalFunction>& externals) const {
  externals.resize(std::max(externals.size(), module.externals.size()));
  for (std::size_t i = 0; i < module.externals.size(); ++i)
    if (const auto number = ir::expectation_of(module.externals[i]))
      for (const auto& watch : watches_)
        if (watch->number == *number) externals[i] = {&Expectations::note, watch.get()};
}

void Expectations::begin_frame(const Rect& window) {
  for (const auto& watch : watches_) watch->window = window, watch->failed.clear();
}

void Expectations::note(void* self, std::int64_t count, const float* const* arguments,
                        float* const*) {
  auto& watch = *static_cast<Watch*>(self);
  if (watch.told) return;
  const Rect& window = watch.window;
  const std::lock_guard lock(watch.mutex);
  for (std::int64_t i = 0; i < count; ++i) {
    const int x = pixel_at(arguments[0][i], window.x0, window.x1);
    const int y = pixel_at(arguments[1][i], window.y0, window.y1);
    if (x < 0 || y < 0) continue;
    const auto width = static_cast<std::size_t>(window.width());
    if (watch.failed.empty())
      watch.failed.resize(width * static_cast<std::size_t>(window.height()));
    watch.failed[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)] = true;
  }
}

void Expectations::report(double frame, Diagnostics& diagnostics) {
  for (const auto& watch : watches_) {
    const auto pixels = std::ranges::count(watch->failed, true);
    if (pixels == 0) continue;
    watch->told = true;
    const auto first = std::ranges::find(watch->failed, true) - watch->failed.begin();
    const Rect& window = watch->window;
    const std::string& said = watch->check.message;
    const std::size_t line = std::min(said.find('\n'), said.size());
    diagnostics.warning(
        "expect", watch->check.span,
        fmt::format("{} at {} pixel{}, first at ({}, {}) of frame {:.0f}", said.substr(0, line),
                    pixels, pixels == 1 ? "" : "s", window.x0 + first % window.width(),
                    window.y0 + first / window.width(), frame),
        said.substr(std::min(line + 1, said.size())));
  }
}

}  // namespace pse::app
