// More samples where edges cross or the linear model failed (2002 chapter: "supersampling is then
// invoked"). Samples are drawn from the kernel itself, so all weigh the same and the result is
// their mean.
#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

#include "antialias/lanes.h"
#include "antialias/refine.h"
#include "antialias/steps.h"

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
// So many are enough where noise is fine and no edge is near.
constexpr std::uint32_t noise_look = 16;

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

namespace {

// Room for `lists` summaries of so many pixels, one behind the other.
Summary summaries(Work& work, std::size_t lists, std::size_t pixels) {
  for (auto* list : {&work.sums, &work.lows, &work.highs})
    list->resize(lists * pixels + CrossingLists::beyond);
  return {work.sums.data(), work.lows.data(), work.highs.data()};
}

}  // namespace

// Runs the samples [first, last) of each pixel, for so many pixels at once; `visit` gets the number
// of the first of these, how many they are, and the results, one pixel's after the other.
template <class Visit>
void Refiner::sample(std::span<const Pixel> pixels, std::uint32_t first, std::uint32_t last,
                     Work& work, RunStatus& status, const Visit& visit) const {
  const std::size_t each = last - first;
  const std::size_t at_once = std::max<std::size_t>(1, most_places / each);
  for (std::size_t begin = 0; begin < pixels.size() && !status.stopped(); begin += at_once) {
    const std::size_t end = std::min(begin + at_once, pixels.size());
    Places& places = work.places;
    places.resize((end - begin) * each);
    double *to_x = places.x.data(), *to_y = places.y.data();
    for (std::size_t i = begin; i < end; ++i) {
      const Pixel& pixel = pixels[i];
      const double x = pixel.x + 0.5, y = pixel.y + 0.5;
      const Offsets offsets = patterns_.of(pixel.x, pixel.y, last).part(first, each);
      for (std::size_t k = 0; k < each; ++k) {
        *to_x++ = x + double(offsets.x[k]);
        *to_y++ = y + double(offsets.y[k]);
      }
    }
    const Results& results = program_.run(work, status);
    visit(begin, end - begin, results);
  }
}

Refined Refiner::supersample(std::vector<Pixel> pixels, Work& work, RunStatus& status) const {
  Refined all({}, outputs_);
  add_means(pixels, count(), all, work, status);
  return all;
}

void Refiner::settle_noise(Refined& result, Counts& counts, Work& work, RunStatus& status) const {
  counts.supersampled += static_cast<std::int64_t>(work.noisy.size());
  result.first_mean = result.pixels.size();
  result.samples = std::min(noise_look, count());
  add_means(work.noisy, result.samples, result, work, status);
}

void Refiner::add_means(std::span<const Pixel> pixels, std::uint32_t count, Refined& result,
                        Work& work, RunStatus& status) const {
  const std::size_t before = result.pixels.size();
  result.pixels.insert(result.pixels.end(), pixels.begin(), pixels.end());
  result.resize(result.pixels.size());
  sample(pixels, 0, count, work, status,
         [&](std::size_t begin, std::size_t number, const Results& results) {
           const Summary summary = summaries(work, 1, number);
           for (std::size_t o = 0; o < outputs_; ++o) {
             steps().summarise(results[o], number, count, summary);
             for (std::size_t i = 0; i < number; ++i)
               result.values[o][before + begin + i] = summary.sums[i] / static_cast<float>(count);
           }
         });
}

// The pixel's values from samples of each region of two edges; false where the samples of a region
// disagree, or of a large one there are none.
bool Refiner::by_regions(const Unclear& pixel, std::uint32_t look, const Results& results,
                         std::size_t at, std::span<float> values) const {
  constexpr float least_weight = 0.004f;
  const float reach = options_.filter.reach();
  if (!pixel.lines.are_within(reach)) return false;
  const Offsets offsets = patterns_.of(pixel.pixel.x, pixel.pixel.y, look);
  const Corner corner(pixel.lines);
  // Samples of one region go one way, and those that may be beyond a line one of these ways: else
  // there is more than the two edges.
  const Corner::Regions regions = corner.regions(offsets);
  const float* path = results[outputs_] + at;
  std::uint32_t known = 0, unsure = 0;
  for (std::size_t r = 0; r < 4; ++r) {
    const std::uint32_t sure = regions.sure[r];
    if (sure == 0) continue;
    const float way = path[std::countr_zero(sure)];
    std::uint32_t alike = 0;
    for (std::uint32_t k = 0; k < look; k += four)
      alike |= mask_of(load<Four>(path + k) == way) << k;
    if ((sure & ~alike) != 0) return false;
    known |= alike, unsure |= regions.unsure[r];
  }
  if ((unsure & ~known) != 0) return false;

  const std::array<float, 4> weights = corner.weights(options_.filter, patterns_.all());
  float total = 0;
  for (std::size_t r = 0; r < 4; ++r) {
    if (regions.sure[r] == 0 && weights[r] > least_weight) return false;
    total += regions.sure[r] != 0 ? weights[r] : 0;
  }
  for (std::size_t o = 0; o < outputs_; ++o) {
    float value = 0;
    for (std::size_t r = 0; r < 4; ++r) {
      if (regions.sure[r] == 0) continue;
      float sum = 0;
      for (std::uint32_t some = regions.sure[r]; some != 0; some &= some - 1)
        sum += results[o][at + static_cast<std::size_t>(std::countr_zero(some))];
      value += weights[r] / total * (sum / static_cast<float>(std::popcount(regions.sure[r])));
    }
    values[o] = value;
  }
  return true;
}

// What an output is at a pixel and the eight around it.
Range Refiner::range_around(const Tile& tile, const Pixel& pixel, std::size_t output) {
  const std::ptrdiff_t width = tile.area.width();
  const float* middle = tile.planes[output] + tile.at(pixel.x, pixel.y);
  Four lows = Four{} + middle[0], highs = lows;
  for (const std::ptrdiff_t row : {-width, std::ptrdiff_t{0}, width}) {
    const Four four_of = load<Four>(middle + row - 1);
    const Four three = __builtin_shufflevector(four_of, four_of, 0, 1, 2, 1);
    lows = smaller(three, lows), highs = larger(three, highs);
  }
  Range range{lows[0], highs[0]};
  for (std::size_t l = 1; l < 3; ++l)
    range = {smaller(lows[l], range.low), larger(highs[l], range.high)};
  return range;
}

// Samples in steps, each as many as before it together. Narrow pixels whose first samples show
// nothing stay as they are; those whose samples confirm two edges are put together from their
// regions. Half of the samples are enough, but for outlines: theirs are long, and nothing else
// smooths them.
void Refiner::settle(const Tile& tile, Refined& result, Counts& counts, Work& work,
                     RunStatus& status) const {
  const std::vector<Unclear>& unclear = work.unclear;
  if (unclear.empty()) return;
  const std::uint32_t count = this->count(), look = std::min(corner_look, count);
  std::vector<float> sums(unclear.size() * outputs_);
  std::vector<Range> ranges(sums.size());
  std::vector<std::size_t> open(unclear.size());
  std::iota(open.begin(), open.end(), std::size_t{0});
  std::vector<float> values(outputs_);
  result.reserve(result.pixels.size() + unclear.size());
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
    const std::size_t each = last - first;
    const auto look_at = [&](std::size_t k, std::size_t number, std::size_t s,
                             const Results& results) {
      const std::size_t i = now[k];
      const Pixel& pixel = unclear[i].pixel;
      float* sum = &sums[i * outputs_];
      bool uneven = false, more = !pixel.narrow || first > 0;
      for (std::size_t o = 0; o < outputs_; ++o) {
        const std::size_t of = o * number + s;
        const Range seen{work.lows[of], work.highs[of]};
        sum[o] += work.sums[of];
        Range& range = ranges[i * outputs_ + o];
        range = first == 0 ? seen : range.with(seen);
        const float own = tile.planes[o][tile.at(pixel.x, pixel.y)];
        if (last > first_look) {
          uneven = uneven || is_uneven(range, last);
          more = more || (pixel.hidden && exceeds(range, {own, own}));
          continue;
        }
        // The first few may have missed what a neighbour shows.
        const Range around = range_around(tile, pixel, o);
        more = more || exceeds(range, pixel.hidden ? Range{own, own} : around);
        uneven = uneven || is_uneven(range.with(around), last);
      }
      if (!more) return;
      const std::uint32_t most = pixel.silhouette ? count : std::max(look, count / 2);
      if (uneven && first == 0 && last == look &&
          by_regions(unclear[i], look, results, s * each, values))
        done(i, values.data(), 1);
      else if (!uneven || last >= most)
        done(i, sum, static_cast<float>(last));
      else
        kept.push_back(i);
    };
    sample(pixels, first, last, work, status,
           [&](std::size_t begin, std::size_t number, const Results& results) {
             const Summary all = summaries(work, outputs_, number);
             for (std::size_t o = 0; o < outputs_; ++o) {
               const std::size_t of = o * number;
               steps().summarise(results[o], number, each,
                                 {all.sums + of, all.lows + of, all.highs + of});
             }
             for (std::size_t s = 0; s < number; ++s) look_at(begin + s, number, s, results);
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
