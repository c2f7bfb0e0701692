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
      const Offsets offsets = patterns_.of(pixel.x, pixel.y, last).part(first, each);
      steps().place(pixel.x + 0.5, pixel.y + 0.5, offsets.x.data(), offsets.y.data(), each, to_x,
                    to_y);
      to_x += each, to_y += each;
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
Range Refiner::range_around(const float* middle, std::ptrdiff_t width) {
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

// What the samples [first, last) of the unclear pixels `now`, summed up in `work`, say of each:
// whether it needs any, and whether these are too few.
void Refiner::judge(const Tile& tile, std::span<const std::size_t> now, std::uint32_t first,
                    std::uint32_t last, Work& work) const {
  Settling& s = work.settling;
  const std::size_t number = now.size(), pixels = work.unclear.size();
  const std::size_t room = number + CrossingLists::beyond;
  for (auto* list : {&s.known_lows, &s.known_highs, &s.spread_lows, &s.spread_highs})
    if (list->size() < room) list->resize(room);
  for (auto* list : {&s.asks, &s.more, &s.uneven})
    if (list->size() < room) list->resize(room);
  // The first few may have missed what a neighbour shows.
  const bool looks_around = last <= first_look;
  for (std::size_t k = 0; k < number; ++k) {
    const Pixel& pixel = work.unclear[now[k]].pixel;
    s.more[k] = pixel.narrow && first == 0 ? 0 : -1;
    s.uneven[k] = 0;
    s.asks[k] = looks_around || pixel.hidden ? -1 : 0;
  }
  for (std::size_t o = 0; o < outputs_; ++o) {
    float *const lows = &work.lows[o * number], *const highs = &work.highs[o * number];
    for (std::size_t k = 0; k < number; ++k) {
      const std::size_t i = now[k], of = o * pixels + i;
      s.sums[of] = first == 0 ? work.sums[o * number + k] : s.sums[of] + work.sums[o * number + k];
      Range range{lows[k], highs[k]};
      if (first > 0) range = s.ranges[of].with(range);
      s.ranges[of] = range;
      lows[k] = range.low, highs[k] = range.high;
      const Pixel& pixel = work.unclear[i].pixel;
      const float* middle = tile.planes[o] + tile.at(pixel.x, pixel.y);
      Range known{*middle, *middle};
      if (looks_around) {
        const Range around = range_around(middle, tile.area.width());
        if (!pixel.hidden) known = around;
        range = range.with(around);
      }
      s.known_lows[k] = known.low, s.known_highs[k] = known.high;
      s.spread_lows[k] = range.low, s.spread_highs[k] = range.high;
    }
    steps().judge({lows, highs}, {s.known_lows.data(), s.known_highs.data()}, s.asks.data(),
                  {s.spread_lows.data(), s.spread_highs.data()},
                  mean_per_range * static_cast<float>(last), number,
                  {s.more.data(), s.uneven.data()});
  }
}

// Samples in steps, each as many as before it together. Narrow pixels whose first samples show
// nothing stay as they are; those whose samples confirm two edges are put together from their
// regions. Half of the samples are enough, but for outlines: theirs are long, and nothing else
// smooths them.
void Refiner::settle(const Tile& tile, Refined& result, Counts& counts, Work& work,
                     RunStatus& status) const {
  const std::vector<Unclear>& unclear = work.unclear;
  if (unclear.empty()) return;
  Settling& s = work.settling;
  const std::uint32_t count = this->count(), look = std::min(corner_look, count);
  const std::size_t size = unclear.size() * outputs_;
  if (s.sums.size() < size) s.sums.resize(2 * size), s.ranges.resize(2 * size);
  std::vector<float> values(outputs_);
  const auto done = [&](std::size_t i, const float* of, std::size_t apart, float number) {
    result.pixels.push_back(unclear[i].pixel);
    for (std::size_t o = 0; o < outputs_; ++o) result.values[o].push_back(of[o * apart] / number);
    ++counts.supersampled;
  };

  // The samples [first, last) of some pixels; those that need more are kept.
  const auto step = [&](const std::vector<std::size_t>& of, std::uint32_t first,
                        std::uint32_t last) {
    if (of.empty()) return;
    s.now.clear();
    for (const std::size_t i : of) s.now.push_back(unclear[i].pixel);
    const std::size_t each = last - first;
    const auto look_at = [&](std::size_t begin, std::size_t number, const Results& results) {
      const Summary all = summaries(work, outputs_, number);
      for (std::size_t o = 0; o < outputs_; ++o) {
        const std::size_t at = o * number;
        steps().summarise(results[o], number, each, {all.sums + at, all.lows + at, all.highs + at});
      }
      judge(tile, std::span(of).subspan(begin, number), first, last, work);
      for (std::size_t k = 0; k < number; ++k) {
        if (s.more[k] == 0) continue;
        const std::size_t i = of[begin + k];
        const std::uint32_t most = unclear[i].pixel.silhouette ? count : std::max(look, count / 2);
        const bool is_uneven = s.uneven[k] != 0;
        if (is_uneven && first == 0 && last == look &&
            by_regions(unclear[i], look, results, k * each, values))
          done(i, values.data(), 1, 1);
        else if (!is_uneven || last >= most)
          done(i, &s.sums[i], unclear.size(), static_cast<float>(last));
        else
          s.kept.push_back(i);
      }
    };
    sample(s.now, first, last, work, status, look_at);
  };

  // The first samples of what may be two edges are looked at together.
  s.open.clear(), s.corners.clear();
  const float reach = options_.filter.reach();
  for (std::size_t i = 0; i < unclear.size(); ++i)
    (unclear[i].lines.are_within(reach) ? s.corners : s.open).push_back(i);
  std::uint32_t taken = 0;
  for (std::uint32_t next = std::min(first_look, look);
       !(s.open.empty() && s.corners.empty()) && !status.stopped();
       next = std::min(2 * next, count)) {
    s.kept.clear();
    step(s.open, taken, next);
    if (next >= look) {
      step(s.corners, 0, next);
      s.corners.clear();
    }
    std::swap(s.open, s.kept);
    taken = next;
  }
}

}  // namespace pse::antialias
