// Where a ray's matter cannot be, with proof: the density's bounds over whole blocks of pixels and
// stretches of depth (bounds/bounds.h), halved until a block is proven empty or is as small as
// asked for. Unlike the samples of the prepass it misses nothing. Chapter, "Smoke", "Optimization".
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "app/knobs.h"
#include "app/prepass.h"
#include "stream/image_plane.h"
#include "stream/sample_source.h"

namespace pse::app {

struct ProofReport {
  std::int64_t boxes = 0;    // whose bounds were computed
  double proven = 0;         // part of the space of rays that is proven empty
  bool complete = false;     // what is not in the spans is proven empty
};

// Asks the program of the bounds for boxes: pixels x0 <= x <= x1, y0 <= y <= y1, and the depths
// from near to far along their rays.
class BoxBounds {
 public:
  // `program` is that of bound_outputs() for `span` with prepass.step = -1: the depth and the
  // density there.
  BoxBounds(const Program& program, const ImagePlane& plane, const std::vector<Knob>& knobs,
            const std::vector<ExternalFunction>& externals, int threads, RunStatus& status);

  struct Box {
    int x = 0, y = 0, size = 0;     // in pixels
    float near = -1e30f, far = 1e30f;  // receive the part that the program marches through
    float least = 0, greatest = 0;  // receive the density's bounds
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

// Adds to `spans` all that is not proven empty, in blocks of at least spans.cell pixels. What the
// spans have already is not asked again. At most `most` boxes are asked for: where that is not
// enough, the spans stay as they are and the report says so. False when cancelled or failed.
bool add_possible(BoxBounds& bounds, int width, int height, std::int64_t most, Spans& spans,
                  ProofReport& report);

}  // namespace pse::app
