// A program run at any places of the picture.
#pragma once

#include <utility>
#include <vector>

#include "antialias/corner.h"
#include "antialias/crossings.h"
#include "antialias/half_grid.h"
#include "antialias/tile.h"
#include "stream/planes.h"
#include "stream/program.h"
#include "stream/sample_source.h"

namespace pse::antialias {

// Places in pixels of the whole picture.
struct Places {
  std::vector<double> x, y;  // what lies behind `count` has no meaning
  std::size_t count = 0;
  void resize(std::size_t places) {
    count = places;
    if (x.size() < count) x.resize(count), y.resize(count);
  }
};

// results[o][i]: output o of the program at place i.
class Results {
 public:
  // Makes room; what was there is lost.
  void resize(std::size_t outputs, std::size_t places);
  float* operator[](std::size_t output) const { return planes_.pointers()[output]; }
  // For Steps::see_nearness() and the like.
  const float* const* lists() const { return planes_.pointers().data(); }

 private:
  Planes planes_;
  std::size_t capacity_ = 0;
};

class PlaceRunner;

// A pixel that needs more than one look, and the edges that are known to be near.
struct Unclear {
  Pixel pixel;
  Lines lines = {};
};

// A pixel with an edge near that may be a circle's; one that could be followed has what came of it.
struct Bent {
  Pixel pixel;
  bool is_followed = false;
  CrossingLists::Edge edge = {};
};

// What is known of unclear pixels while they are settled (supersample.cpp): of output o and pixel i
// number o * pixels + i of `sums` and `ranges`.
struct Range {
  float low = 0, high = 0;
  Range with(const Range& other) const {
    return {std::min(other.low, low), std::max(other.high, high)};
  }
};
struct Settling {
  std::vector<float> sums;
  std::vector<Range> ranges;
  std::vector<std::size_t> open, corners, kept;  // numbers of pixels
  std::vector<Pixel> now;
  // Of the pixels that are looked at together; see Steps::judge().
  std::vector<float> known_lows, known_highs, spread_lows, spread_highs;
  std::vector<std::int32_t> asks, more, uneven;
};

// One thread's memory, used again from run to run.
struct Work {
  Found found;
  Crossings crossings;
  std::vector<Unclear> unclear;
  std::vector<Bent> bent;
  std::vector<Pixel> between;  // between the bends of a steep ramp
  std::vector<Pixel> fine;     // memory of find_fine_pixels()
  std::vector<Pixel> noisy;    // of these, with fine grain and no edge near
  std::vector<Pixel> halved;   // the others with no edge near
  HalfGrid halves;             // the samples of these
  Places places;               // where the next run is to be
  Results results;             // of the last run
  Scratch scratch;
  std::vector<std::pair<const PlaceRunner*, Planes>> inputs;
  std::vector<float*> outputs;  // of a run
  std::vector<std::int32_t> flags;
  std::vector<float> sums, lows, highs;
  Settling settling;
};

// An input "NAME$x" or "NAME$y" that is the slope of the input NAME per pixel; both are indices of
// Module::inputs.
struct InputSlope {
  std::size_t input, of;
  bool along_x;
  bool is_even;  // the same everywhere, and a uniform that the stream sets
};
std::vector<InputSlope> input_slopes(const ir::Module& module);

class PlaceRunner {
 public:
  // `source` is made for the program's module. Inputs that are slopes get their values. All must
  // outlive this; `state` has its frame computed.
  PlaceRunner(const Program& program, const FrameState& state, const SampleSource& source);

  // Runs the program at work.places. `status` may be cancelled; the results are then meaningless.
  // May be called from several threads at once, each with its own memory.
  const Results& run(Work& work, RunStatus& status) const;

 private:
  void fill(std::span<const double> x, std::span<const double> y,
            std::span<float* const> planes) const;
  const Planes& inputs(Work& work) const;

  const Program& program_;
  const FrameState& state_;
  const SampleSource& source_;
  std::vector<bool> used_;          // inputs that the source fills, and slopes
  std::vector<bool> sloping_;       // inputs whose slopes are wanted
  std::vector<InputSlope> slopes_;  // those that are not even
  std::size_t id_ = no_id;          // the input that tells objects apart
  static constexpr auto no_id = static_cast<std::size_t>(-1);
};

}  // namespace pse::antialias
