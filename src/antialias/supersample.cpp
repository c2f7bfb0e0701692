// More samples where edges cross or the linear model failed (2002 chapter: "supersampling is then
// invoked"). Samples are drawn from the kernel itself, so all weigh the same and the result is
// their mean.
#include <algorithm>
#include <array>

#include "antialias/lanes.h"
#include "antialias/refine.h"

namespace pse::antialias {
namespace {

// Places handed to the program at once.
constexpr std::size_t most_places = 1 << 10;
// So many samples tell whether there is anything in a narrow pixel.
constexpr std::uint32_t first_glance = 8;
// So many samples tell whether a pixel needs the others: where they spread over less than
// mean_per_range times what can be seen, their mean is near enough.
constexpr std::uint32_t first_look = 16;
constexpr float mean_per_range = 12;

// Sums are taken in a fixed order: of every eighth value, then of these.
constexpr std::size_t lanes = 2 * four;
using Sums = std::array<Four, 2>;

float total(const Sums& sums, std::span<const float> rest) {
  float all = 0;
  for (const Four& part : sums)
    for (std::size_t l = 0; l < four; ++l) all += part[l];
  for (const float value : rest) all += value;
  return all;
}

float sum_of(std::span<const float> values) {
  Sums sums{};
  std::size_t k = 0;
  for (; k + lanes <= values.size(); k += lanes)
    sums[0] += load<Four>(&values[k]), sums[1] += load<Four>(&values[k + four]);
  return total(sums, values.subspan(k));
}

struct Range {
  float low, high;
};

Range range_of(std::span<const float> values) {
  Four lows = Four{} + values[0], highs = lows;
  std::size_t k = 0;
  for (; k + four <= values.size(); k += four) {
    const Four some = load<Four>(&values[k]);
    lows = smaller(some, lows), highs = larger(some, highs);
  }
  Range range{values[0], values[0]};
  for (std::size_t l = 0; l < four; ++l)
    range = {smaller(lows[l], range.low), larger(highs[l], range.high)};
  for (; k < values.size(); ++k)
    range = {smaller(values[k], range.low), larger(values[k], range.high)};
  return range;
}

// Whether what is spread over them can be seen in their mean.
bool is_uneven(std::span<const float> values) {
  const auto [low, high] = range_of(values);
  return differ(low, low + (high - low) / mean_per_range);
}

}  // namespace

// Runs the samples [first, last) of each pixel; `visit` gets the pixel's number and where its
// results begin.
template <class Visit>
void Refiner::sample(const std::vector<Pixel>& pixels, std::uint32_t first, std::uint32_t last,
                     Work& work, RunStatus& status, const Visit& visit) const {
  const std::size_t each = last - first;
  const std::size_t at_once = std::max<std::size_t>(1, most_places / each);
  for (std::size_t begin = 0; begin < pixels.size() && !status.stopped(); begin += at_once) {
    const std::size_t end = std::min(begin + at_once, pixels.size());
    Places& places = work.places;
    places.x.resize((end - begin) * each), places.y.resize((end - begin) * each);
    double *to_x = places.x.data(), *to_y = places.y.data();
    for (std::size_t i = begin; i < end; ++i) {
      const Pixel& pixel = pixels[i];
      const double x = pixel.x + 0.5, y = pixel.y + 0.5;
      const Offsets offsets = patterns_.of(pixel.x, pixel.y).part(first, each);
      for (std::size_t k = 0; k < each; ++k) {
        *to_x++ = x + double(offsets.x[k]);
        *to_y++ = y + double(offsets.y[k]);
      }
    }
    const Results& results = program_.run(work, status);
    for (std::size_t i = begin; i < end; ++i) visit(i, results, (i - begin) * each);
  }
}

Refined Refiner::supersample(std::vector<Pixel> pixels, Work& work, RunStatus& status) const {
  const std::uint32_t count = this->count();
  Refined all(std::move(pixels), outputs_);
  sample(all.pixels, 0, count, work, status,
         [&](std::size_t i, const Results& results, std::size_t at) {
           for (std::size_t o = 0; o < outputs_; ++o)
             all.values[o][i] = sum_of({results[o] + at, count}) / static_cast<float>(count);
         });
  return all;
}

// The pixel's values from samples of each region of two edges; false where the samples of a region
// disagree or there are none.
bool Refiner::by_regions(const Unclear& pixel, std::uint32_t look, const Results& results,
                         std::size_t at, std::span<float> values) const {
  constexpr float least_weight = 0.004f;
  const float reach = options_.filter.reach();
  if (!(std::abs(pixel.lines.first.distance) < reach) ||
      !(std::abs(pixel.lines.second.distance) < reach))
    return false;
  const Offsets offsets = patterns_.of(pixel.pixel.x, pixel.pixel.y);
  const Corner corner(pixel.lines);
  std::array<std::uint32_t, 4> counts{};
  std::array<float, 4> paths{};
  const float* path = results[outputs_] + at;
  std::array<std::uint8_t, first_look> regions{};
  for (std::uint32_t k = 0; k < look; ++k) {
    const std::uint8_t region = regions[k] = corner.region(offsets.x[k], offsets.y[k]);
    if (region == Corner::unsure) continue;
    if (counts[region]++ == 0) paths[region] = path[k];
    if (paths[region] != path[k]) return false;
  }
  std::array<float, 4> weights = corner.weights(options_.filter, offsets);
  float total = 0;
  for (std::size_t r = 0; r < 4; ++r) {
    if (counts[r] == 0 && weights[r] > least_weight) return false;
    if (counts[r] == 0) weights[r] = 0;
    total += weights[r];
  }
  for (std::size_t o = 0; o < outputs_; ++o) {
    std::array<float, 5> sums{};
    for (std::uint32_t k = 0; k < look; ++k) sums[regions[k]] += results[o][at + k];
    float value = 0;
    for (std::size_t r = 0; r < 4; ++r)
      if (counts[r] > 0) value += weights[r] / total * (sums[r] / static_cast<float>(counts[r]));
    values[o] = value;
  }
  return true;
}

// Narrow pixels join `unclear` where a few samples show what none of the pixels around does; the
// others stay as they are.
void Refiner::glance(const Tile& tile, const std::vector<Pixel>& narrow,
                     std::vector<Unclear>& unclear, Work& work, RunStatus& status) const {
  const std::uint32_t few = std::min(first_glance, count());
  sample(narrow, 0, few, work, status, [&](std::size_t i, const Results& results, std::size_t at) {
    for (std::size_t o = 0; o < outputs_; ++o) {
      const float* middle = tile.planes[o] + tile.at(narrow[i].x, narrow[i].y);
      Range around = range_of({middle - 1, 3});
      for (const std::ptrdiff_t row : {-tile.area.width(), tile.area.width()}) {
        const auto [low, high] = range_of({middle + row - 1, 3});
        around = {smaller(low, around.low), larger(high, around.high)};
      }
      const auto [low, high] = range_of({results[o] + at, few});
      if ((low < around.low && differ(low, around.low)) ||
          (high > around.high && differ(high, around.high))) {
        unclear.push_back({narrow[i]});
        return;
      }
    }
  });
}

// Pixels that turn out even after a first look are left at that, and those whose samples confirm
// two edges are put together from their regions.
void Refiner::settle(const std::vector<Unclear>& unclear, Refined& result, Work& work,
                     RunStatus& status) const {
  if (unclear.empty()) return;
  const std::uint32_t count = this->count();
  const std::uint32_t look = std::min(first_look, count);
  const std::size_t start = result.pixels.size();
  for (const Unclear& pixel : unclear) result.pixels.push_back(pixel.pixel);
  for (auto& values : result.values) values.resize(result.pixels.size());
  const std::vector<Pixel> pixels(result.pixels.begin() + static_cast<std::ptrdiff_t>(start),
                                  result.pixels.end());

  std::vector<Pixel> more;
  std::vector<std::size_t> places;  // of these in the result, with the sums of the first look
  std::vector<float> values(outputs_);
  sample(pixels, 0, look, work, status, [&](std::size_t i, const Results& results, std::size_t at) {
    bool unsettled = false;
    for (std::size_t o = 0; o < outputs_; ++o) {
      const std::span<const float> seen(results[o] + at, look);
      result.values[o][start + i] = sum_of(seen);
      unsettled = unsettled || is_uneven(seen);
    }
    if (unsettled && look < count) {
      if (!by_regions(unclear[i], look, results, at, values)) {
        more.push_back(pixels[i]);
        places.push_back(start + i);
        return;
      }
      for (std::size_t o = 0; o < outputs_; ++o) result.values[o][start + i] = values[o];
    } else {
      for (std::size_t o = 0; o < outputs_; ++o)
        result.values[o][start + i] /= static_cast<float>(look);
    }
  });
  // Half of the samples are enough, but for outlines: theirs are long, and nothing else smooths
  // them.
  std::uint32_t taken = look;
  for (const std::uint32_t next : {std::max(look, count / 2), count}) {
    if (next > taken)
      sample(more, taken, next, work, status,
             [&](std::size_t i, const Results& results, std::size_t at) {
               for (std::size_t o = 0; o < outputs_; ++o)
                 result.values[o][places[i]] += sum_of({results[o] + at, next - taken});
             });
    taken = next;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < more.size(); ++i) {
      if (next < count && more[i].silhouette) {
        more[kept] = more[i], places[kept] = places[i];
        ++kept;
        continue;
      }
      for (std::size_t o = 0; o < outputs_; ++o)
        result.values[o][places[i]] /= static_cast<float>(taken);
    }
    more.resize(kept), places.resize(kept);
  }
}

}  // namespace pse::antialias
