// More samples where edges cross or the linear model failed (2002 chapter: "supersampling is then
// invoked"). Samples are drawn from the kernel itself, so all weigh the same and the result is
// their mean.
#include <algorithm>
#include <array>
#include <numeric>

#include "antialias/lanes.h"
#include "antialias/refine.h"

namespace pse::antialias {
namespace {

// Places handed to the program at once.
constexpr std::size_t most_places = 1 << 10;
// A pixel gets this many samples, then twice as many and so on: until their mean is near enough,
// which is so where they spread over less than this part of their number times what can be seen.
constexpr std::uint32_t first_look = 8;
constexpr float mean_per_range = 3;
// So many samples tell the values of the regions of two edges.
constexpr std::uint32_t corner_look = 16;

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

// Whether some of what is in the range can be told from all that is in the other.
bool exceeds(const Range& range, const Range& other) {
  return (range.low < other.low && differ(range.low, other.low)) ||
         (range.high > other.high && differ(range.high, other.high));
}

// Whether what `count` samples are spread over can be seen in their mean.
bool is_uneven(const Range& range, std::uint32_t count) {
  const float part = (range.high - range.low) / (mean_per_range * static_cast<float>(count));
  return differ(range.low, range.low + part);
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
  if (!pixel.lines.are_within(reach)) return false;
  const Offsets offsets = patterns_.of(pixel.pixel.x, pixel.pixel.y);
  const Corner corner(pixel.lines);
  std::array<std::uint32_t, 4> counts{};
  std::array<float, 4> paths{};
  const float* path = results[outputs_] + at;
  std::array<std::uint8_t, corner_look> regions{};
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

// What an output is at a pixel and the eight around it.
Range Refiner::range_around(const Tile& tile, const Pixel& pixel, std::size_t output) {
  const float* middle = tile.planes[output] + tile.at(pixel.x, pixel.y);
  Range around = range_of({middle - 1, 3});
  for (const std::ptrdiff_t row : {-tile.area.width(), tile.area.width()})
    around = around.with(range_of({middle + row - 1, 3}));
  return around;
}

// Samples in steps, each as many as before it together. Narrow pixels whose first samples show
// nothing stay as they are; those whose samples confirm two edges are put together from their
// regions. Half of the samples are enough, but for outlines: theirs are long, and nothing else
// smooths them.
void Refiner::settle(const Tile& tile, const std::vector<Unclear>& unclear, Refined& result,
                     Counts& counts, Work& work, RunStatus& status) const {
  const std::uint32_t count = this->count(), look = std::min(corner_look, count);
  std::vector<float> sums(unclear.size() * outputs_);
  std::vector<Range> ranges(sums.size());
  std::vector<std::size_t> open(unclear.size());
  std::iota(open.begin(), open.end(), std::size_t{0});
  std::vector<float> values(outputs_);
  const auto done = [&](std::size_t i, const float* of, float number) {
    result.pixels.push_back(unclear[i].pixel);
    for (std::size_t o = 0; o < outputs_; ++o) result.values[o].push_back(of[o] / number);
    ++counts.supersampled;
  };

  std::vector<std::size_t> kept, now;
  std::vector<Pixel> pixels;
  // The samples [first, last) of the pixels `now`; those that need more are kept.
  const auto step = [&](std::uint32_t first, std::uint32_t last) {
    pixels.clear();
    for (const std::size_t i : now) pixels.push_back(unclear[i].pixel);
    sample(
        pixels, first, last, work, status,
        [&](std::size_t k, const Results& results, std::size_t at) {
          const std::size_t i = now[k];
          const Pixel& pixel = unclear[i].pixel;
          float* sum = &sums[i * outputs_];
          bool uneven = false, more = !pixel.narrow || first > 0;
          for (std::size_t o = 0; o < outputs_; ++o) {
            const std::span<const float> seen(results[o] + at, last - first);
            sum[o] += sum_of(seen);
            Range& range = ranges[i * outputs_ + o];
            range = first == 0 ? range_of(seen) : range.with(range_of(seen));
            if (last > first_look) {
              uneven = uneven || is_uneven(range, last);
              continue;
            }
            // The first few may have missed what a neighbour shows.
            const Range around = range_around(tile, pixel, o);
            more = more || exceeds(range, around);
            uneven = uneven || is_uneven(range.with(around), last);
          }
          if (!more) return;
          const std::uint32_t most = pixel.silhouette ? count : std::max(look, count / 2);
          if (!uneven || last >= most)
            done(i, sum, static_cast<float>(last));
          else if (first == 0 && last == look && by_regions(unclear[i], look, results, at, values))
            done(i, values.data(), 1);
          else
            kept.push_back(i);
        });
  };
  const float reach = options_.filter.reach();
  std::uint32_t taken = 0;
  for (std::uint32_t next = std::min(first_look, look); !open.empty() && !status.stopped();
       next = std::min(2 * next, count)) {
    kept.clear();
    // The samples of two edges are looked at together.
    std::vector<std::size_t> later;
    for (const bool corners : {false, true}) {
      now.clear();
      for (const std::size_t i : open)
        if (next > look ? !corners : unclear[i].lines.are_within(reach) == corners)
          now.push_back(i);
      if (corners && next < look)
        later = now;
      else if (!now.empty())
        step(corners ? 0 : taken, next);
    }
    open = kept;
    open.insert(open.end(), later.begin(), later.end());
    taken = next;
  }
}

}  // namespace pse::antialias
