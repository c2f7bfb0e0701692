// More samples where edges cross or the linear model failed (2002 chapter: "supersampling is then
// invoked"). Samples are drawn from the kernel itself, so all weigh the same and the result is
// their mean.
#include <algorithm>
#include <array>

#include "antialias/refine.h"

namespace pse::antialias {
namespace {

// Places handed to the program at once.
constexpr std::size_t most_places = 1 << 12;
// So many samples tell whether a pixel needs the others: where they spread over less than
// mean_per_range times what can be seen, their mean is near enough.
constexpr std::uint32_t first_look = 16;
constexpr float mean_per_range = 12;

struct Summary {
  float sum, low, high;
};

// Of `count` values, in a fixed order: as many sums as lanes, then these.
Summary summary(const float* values, std::size_t count) {
  constexpr std::size_t lanes = 8;
  std::array<float, lanes> sum{}, low, high;
  low.fill(values[0]), high.fill(values[0]);
  std::size_t k = 0;
  for (; k + lanes <= count; k += lanes)
    for (std::size_t l = 0; l < lanes; ++l) {
      const float value = values[k + l];
      sum[l] += value;
      low[l] = value < low[l] ? value : low[l];
      high[l] = value > high[l] ? value : high[l];
    }
  Summary all{0, values[0], values[0]};
  for (std::size_t l = 0; l < lanes; ++l) {
    all.sum += sum[l];
    all.low = std::min(all.low, low[l]), all.high = std::max(all.high, high[l]);
  }
  for (; k < count; ++k) {
    all.sum += values[k];
    all.low = std::min(all.low, values[k]), all.high = std::max(all.high, values[k]);
  }
  return all;
}

}  // namespace

// Sums of the samples [first, last) of each pixel, and in `uneven` whether they look different.
Refined Refiner::sample(std::vector<Pixel> pixels, std::uint32_t first, std::uint32_t last,
                        std::vector<bool>* uneven, Work& work, RunStatus& status) const {
  const std::size_t each = last - first;
  Refined result(std::move(pixels), outputs_);
  if (uneven) uneven->assign(result.pixels.size(), false);
  const std::size_t at_once = std::max<std::size_t>(1, most_places / each);
  for (std::size_t begin = 0; begin < result.pixels.size() && !status.stopped(); begin += at_once) {
    const std::size_t end = std::min(begin + at_once, result.pixels.size());
    Places& places = work.places;
    places.x.resize((end - begin) * each), places.y.resize((end - begin) * each);
    double *to_x = places.x.data(), *to_y = places.y.data();
    for (std::size_t i = begin; i < end; ++i) {
      const Pixel& pixel = result.pixels[i];
      const double x = pixel.x + 0.5, y = pixel.y + 0.5;
      for (const auto& [dx, dy] : patterns_.of(pixel.x, pixel.y).subspan(first, each))
        *to_x++ = x + double(dx), *to_y++ = y + double(dy);
    }
    const Results& values = program_.run(work, status);
    for (std::size_t o = 0; o < outputs_; ++o)
      for (std::size_t i = begin; i < end; ++i) {
        const auto [sum, low, high] = summary(values[o] + (i - begin) * each, each);
        result.values[o][i] = sum;
        if (uneven && differ(low, low + (high - low) / mean_per_range)) (*uneven)[i] = true;
      }
  }
  return result;
}

Refined Refiner::supersample(std::vector<Pixel> pixels, Work& work, RunStatus& status) const {
  const auto count = static_cast<std::uint32_t>(options_.samples);
  Refined result = sample(std::move(pixels), 0, count, nullptr, work, status);
  for (auto& values : result.values)
    for (float& value : values) value /= static_cast<float>(count);
  return result;
}

// Pixels that turn out even after a first look are left at that.
void Refiner::settle(std::vector<Pixel> unclear, Refined& result, Work& work,
                     RunStatus& status) const {
  if (unclear.empty()) return;
  const auto count = static_cast<std::uint32_t>(options_.samples);
  const std::uint32_t look = std::min(first_look, count);
  std::vector<bool> uneven;
  const Refined first = sample(std::move(unclear), 0, look, &uneven, work, status);
  std::vector<Pixel> more;
  for (std::size_t i = 0; i < uneven.size(); ++i)
    if (uneven[i] && look < count) more.push_back(first.pixels[i]);
  Refined rest({}, outputs_);
  if (!more.empty()) rest = sample(std::move(more), look, count, nullptr, work, status);
  std::size_t next = 0;
  for (std::size_t i = 0; i < uneven.size(); ++i) {
    const bool has_more = uneven[i] && look < count;
    result.pixels.push_back(first.pixels[i]);
    for (std::size_t o = 0; o < outputs_; ++o)
      result.values[o].push_back(has_more ? (first.values[o][i] + rest.values[o][next]) /
                                                static_cast<float>(count)
                                          : first.values[o][i] / static_cast<float>(look));
    if (has_more) ++next;
  }
}

}  // namespace pse::antialias
