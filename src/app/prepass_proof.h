// Where a ray's matter cannot be, with proof: the density's bounds over whole blocks of pixels and
// stretches of depth (bounds/bounds.h), halved until a block is proven empty or is as small as
// asked for. Unlike the samples of the prepass it misses nothing. Chapter, "Smoke", "Optimization".
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "app/knobs.h"
#include "app/prepass.h"
#include "stream/image_plane.h"
#include "stream/sample_source.h"

namespace pse::app {

// Asks the program of the bounds for boxes: pixels x0 <= x <= x1, y0 <= y <= y1, and the depths
// from near to far along their rays.
class BoxBounds {
 public:
  // `program` is that of bound_outputs() for `span` with prepass.step = -1: the depth and the
  // density there.
  BoxBounds(const Program& program, const ImagePlane& plane, const std::vector<Knob>& knobs,
            const std::vector<ExternalFunction>& externals, int threads, RunStatus& status);

  struct Box {
    int x = 0, y = 0, size = 0;        // in pixels
    float near = -1e30f, far = 1e30f;  // receive the part that the program marches through
    float least = 0, greatest = 0;     // receive the density's bounds
  };
  // False when cancelled or failed.
  bool look(std::vector<Box>& boxes);

 private:
  const Program& program_;
  std::vector<std::size_t> low_, high_;  // per named input: where its ends are in the module
  ir::Module named_;                     // only the inputs, by the names that the plane knows
  std::unique_ptr<SampleSource> places_;
  FrameState state_;
  int threads_;
  RunStatus& status_;
};

// What is not proven empty.
struct Possible {
  Spans spans;             // all of it, and where a ray has two stretches, what is between
  double part = 1;         // of what the rays march through, the part in the spans
  std::int64_t asked = 0;  // boxes whose bounds were computed
  std::vector<BoxBounds::Box> boxes;  // all of it, without what is between
  double all = 0;                     // what the rays march through, in pixels times depth
  double rest = 1;                    // of that, the part that prove_rest() has left
};

// Halves boxes down to pixels, or as long as no more than `most` are asked for. Nothing when
// cancelled or failed.
std::optional<Possible> find_possible(BoxBounds& bounds, int width, int height, std::int64_t most);

// Halves what is possible and not in `found`, as far as `most` more boxes go. What is left then is
// added to `found` where it is at most the part `little` of all. False when cancelled or failed.
bool prove_rest(BoxBounds& bounds, Possible& possible, Spans& found, std::int64_t most,
                double little);

}  // namespace pse::app
