// The answer of the thirteen samples to the wave (s, t), in radians per half pixel, is
//
//   middle + 2 side (cos s + cos t) + 4 corner cos s cos t + 2 next (cos 2s + cos 2t)
//
// Even functions and the kernel's variance v leave two of the four weights free:
//
//   side = 2 v - 2 corner - 4 next,   middle = 1 - 8 v + 4 corner + 12 next
//
// and these are chosen such that the answer is the kernel's own to two waves.
#include "antialias/half_grid.h"

#include <cmath>
#include <numbers>

#include "noise/math.h"

namespace pse::antialias {
namespace {

// In pixels. Waves as long are the shortest that noise of most_move_squared (fine.h) and finer is
// mostly made of; with it noise of 1.5 to 3 pixels comes out best.
constexpr float true_wave = 1.6f;
constexpr float farthest_reach = 0.75f;
// So many pixels that want nothing are cheaper than a run of their own behind them.
constexpr std::size_t most_between = 4;

// The kernel's answer to a wave along (nx, ny), in radians per pixel: by its projection on that
// direction, whose integral is share().
float answer_of(const Filter& filter, float frequency, float nx, float ny) {
  constexpr int parts = 64;
  const float reach = filter.reach(nx, ny), step = 2 * reach / parts;
  float sum = 0, before = 0;
  for (int k = 1; k <= parts; ++k) {
    const float to = -reach + step * static_cast<float>(k);
    const float share = filter.share(to, nx, ny);
    sum += (share - before) * num::cos(frequency * (to - step / 2));
    before = share;
  }
  return sum;
}

// What a weight adds to the answer to the wave (s, t) while the sum and the variance stay.
float corner_part(float s, float t) { return 4 * (1 - num::cos(s)) * (1 - num::cos(t)); }
float next_part(float s, float t) {
  const auto part = [](float a) { return 6 - 8 * num::cos(a) + 2 * num::cos(2 * a); };
  return part(s) + part(t);
}

HalfWeights weights_of(float variance, float corner, float next) {
  return {1 - 8 * variance + 4 * corner + 12 * next, 2 * variance - 2 * corner - 4 * next, corner,
          next};
}

}  // namespace

std::optional<HalfMeans> half_means_of(const Filter& filter) {
  if (filter.reach() > farthest_reach) return std::nullopt;
  const float v = filter.variance(), diagonal = std::sqrt(0.5f);
  const float frequency = 2 * std::numbers::pi_v<float> / true_wave;
  const float s = frequency / 2, d = s * diagonal;  // per half pixel
  // What is missing of the kernel's answer along the rows and along the diagonals.
  const float along = answer_of(filter, frequency, 1, 0) - (1 - 4 * v * (1 - num::cos(s)));
  const float across =
      answer_of(filter, frequency, diagonal, diagonal) - (1 - 8 * v * (1 - num::cos(d)));
  // Corners say nothing of waves along the rows.
  const float next = along / next_part(s, 0);
  const float corner = (across - next * next_part(d, d)) / corner_part(d, d);
  return HalfMeans{weights_of(v, corner, next), weights_of(v, across / corner_part(d, d), 0)};
}

void HalfGrid::begin(const Rect& rect, std::span<const Pixel> pixels, std::size_t outputs) {
  rect_ = rect;
  const auto width = static_cast<std::size_t>(rect.width());
  const auto height = static_cast<std::size_t>(rect.height());
  row_ = width + 1, plane_ = row_ * (height + 1);
  if (values_.size() < outputs * kinds * plane_ + beyond)
    values_.resize(outputs * kinds * plane_ + beyond);
  runs_.clear();
  if (pixels.empty()) return;

  // Rows that nothing is wanted of lie around.
  wanted_.assign(width * (height + 2), 0);
  const auto row_of = [&](int y) {
    return std::span(wanted_).subspan(static_cast<std::size_t>(y + 1) * width, width);
  };
  for (const Pixel& pixel : pixels)
    row_of(pixel.y - rect.y0)[static_cast<std::size_t>(pixel.x - rect.x0)] = 1;
  const int first = pixels.front().y - rect.y0, last = pixels.back().y - rect.y0;
  // What is wanted of row y by `is_wanted`, in stretches; short ones between are taken too.
  const auto stretches = [&](const auto& is_wanted, const auto& add) {
    std::size_t begin = width, end = 0;
    for (std::size_t x = 0; x < width; ++x) {
      if (!is_wanted(x)) continue;
      if (begin < width && x - end > most_between) add(begin, end), begin = width;
      if (begin == width) begin = x;
      end = x + 1;
    }
    if (begin < width) add(begin, end);
  };
  const auto add = [&](Half kind, int y, std::size_t begin, std::size_t end) {
    runs_.push_back({kind, static_cast<std::int32_t>(begin), y,
                     static_cast<std::int32_t>(end - begin + (kind == Half::below ? 0 : 1))});
  };
  for (int y = first; y <= last + 1; ++y) {
    const auto here = row_of(y), under = row_of(y - 1);
    stretches([&](std::size_t x) { return (here[x] | under[x]) != 0; },
              [&](std::size_t begin, std::size_t end) {
                add(Half::below, y, begin, end), add(Half::corner, y, begin, end);
              });
    if (y <= last)
      stretches([&](std::size_t x) { return here[x] != 0; },
                [&](std::size_t begin, std::size_t end) { add(Half::beside, y, begin, end); });
  }
}

void HalfGrid::places(const Run& run, double* x, double* y) const {
  const double from_x = rect_.x0 + run.x + (run.kind == Half::below ? 0.5 : 0.0);
  const double from_y = rect_.y0 + run.y + (run.kind == Half::beside ? 0.5 : 0.0);
  for (std::int32_t i = 0; i < run.count; ++i) x[i] = from_x + i, y[i] = from_y;
}

}  // namespace pse::antialias
