// More samples where edges cross or the linear model failed (2002 chapter: "supersampling is then
// invoked"). Samples are drawn from the kernel itself, so all weigh the same and the result is
// their mean.
#include <algorithm>
#include <cmath>

#include "antialias/refine.h"
#include "antialias/spread.h"

namespace pse::antialias {
namespace {

// Places handed to the program at once.
constexpr std::size_t most_places = 1 << 14;
// So many samples tell whether a pixel needs the others: where they spread over less than
// mean_per_range times what can be seen, their mean is near enough.
constexpr std::uint32_t first_look = 16;
constexpr float mean_per_range = 12;

}  // namespace

// Sums of the samples [first, last) of each pixel, and in `uneven` whether they look different.
Refined Refiner::sample(std::vector<Pixel> pixels, std::uint32_t first, std::uint32_t last,
                        std::vector<bool>* uneven, RunStatus& status) const {
  const std::size_t each = last - first;
  const std::vector<std::array<float, 2>>& offsets = options_.filter.places();
  Refined result{std::move(pixels), Results(outputs_)};
  for (auto& values : result.values) values.resize(result.pixels.size());
  if (uneven) uneven->assign(result.pixels.size(), false);
  const std::size_t at_once = std::max<std::size_t>(1, most_places / each);
  for (std::size_t begin = 0; begin < result.pixels.size() && !status.cancel; begin += at_once) {
    const std::size_t end = std::min(begin + at_once, result.pixels.size());
    Places places;
    for (std::size_t i = begin; i < end; ++i) {
      const Pixel& pixel = result.pixels[i];
      const Spread spread(pixel.x, pixel.y);
      for (std::uint32_t k = first; k < last; ++k) {
        const auto [dx, dy] = offsets[spread.box(k)];
        places.add(pixel.x + 0.5 + double(dx), pixel.y + 0.5 + double(dy));
      }
    }
    const Results values = program_.run(places, status);
    for (std::size_t o = 0; o < outputs_; ++o)
      for (std::size_t i = begin; i < end; ++i) {
        const float* value = values[o].data() + (i - begin) * each;
        float sum = 0, low = value[0], high = value[0];
        for (std::size_t k = 0; k < each; ++k) {
          sum += value[k];
          low = std::min(low, value[k]), high = std::max(high, value[k]);
        }
        result.values[o][i] = sum;
        if (uneven && differ(low, low + (high - low) / mean_per_range)) (*uneven)[i] = true;
      }
  }
  return result;
}

Refined Refiner::supersample(std::vector<Pixel> pixels, RunStatus& status) const {
  const auto count = static_cast<std::uint32_t>(options_.samples);
  Refined result = sample(std::move(pixels), 0, count, nullptr, status);
  for (auto& values : result.values)
    for (float& value : values) value /= static_cast<float>(count);
  return result;
}

// Pixels that turn out even after a first look are left at that.
void Refiner::settle(std::vector<Pixel> unclear, Refined& result, RunStatus& status) const {
  if (unclear.empty()) return;
  const auto count = static_cast<std::uint32_t>(options_.samples);
  const std::uint32_t look = std::min(first_look, count);
  std::vector<bool> uneven;
  const Refined first = sample(std::move(unclear), 0, look, &uneven, status);
  std::vector<Pixel> more;
  for (std::size_t i = 0; i < uneven.size(); ++i)
    if (uneven[i] && look < count) more.push_back(first.pixels[i]);
  Refined rest{{}, Results(outputs_)};
  if (!more.empty()) rest = sample(std::move(more), look, count, nullptr, status);
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
