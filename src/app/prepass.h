// The coarse prepass of a ray marcher: where matter is on each pixel's ray is found out at a lower
// resolution and kept as an image, which restricts the picture's own march. Chapter, "Smoke",
// "Optimization". The program says where matter is by `span = raymarch_interval(...)`
// (library/raymarch.pse); what was found comes back to it as `prepass.near` and `prepass.far`.
#pragma once

#include <memory>
#include <vector>

#include "app/knobs.h"
#include "app/program_file.h"
#include "app/signals.h"
#include "app/textures.h"
#include "stream/image_plane.h"
#include "stream/sample_source.h"

namespace pse::app {

// Where there is matter on the rays through the cells of a picture; near above far: nowhere.
struct Spans {
  int width = 0, height = 0;  // in cells
  int cell = 1;               // side of a cell in pixels
  std::vector<float> near, far;

  // Of a picture of this size in pixels, without matter.
  static Spans nowhere(int width, int height, int cell);
  // All of it may be matter.
  static Spans everywhere(int width, int height);
  std::size_t at(int x, int y) const {
    return std::size_t(y) * std::size_t(width) + std::size_t(x);
  }
  bool empty(std::size_t i) const { return !(near[i] <= far[i]); }
  // What the rays march through, in pixels times depth.
  double marched() const;
  // Adds a stretch to a cell's; true where that changes it.
  bool widen(std::size_t i, float from, float to);
};

class BoxBounds;

struct PrepassReport {
  std::int64_t boxes = 0;     // whose bounds were computed (prepass_proof.h)
  double possible = 1;        // part of the rays that is not proven empty
  double left = 0;            // part neither in the spans nor proven empty, only sampled
  std::int64_t met = 0;       // rays after the first search that met matter
  std::int64_t met_new = 0;   // of these, how many met what was not yet known
  std::int64_t searched = 0;  // rays looked at, of whatever step
  std::int64_t missed = 0;    // rays that met what the first search had not found
  int step = 1;               // of the search that missed nothing; 1: all that may hold matter
  double evaluations = 0;     // sum of the program's `evaluations`, where it sets them
};

// Looks for matter along rays through any places of the picture.
class SpanSearch {
 public:
  // `program` sets `span`, and perhaps `evaluations`.
  SpanSearch(const Program& program, const ImagePlane& plane, const std::vector<Knob>& knobs,
             const std::vector<ExternalFunction>& externals, int threads, RunStatus& status);

  struct Ray {
    double x = 0, y = 0;               // in pixels
    float near = -1e30f, far = 1e30f;  // look here only; receives what was found
  };
  // Takes every `step`th step of each ray. False when cancelled or failed.
  bool look(std::vector<Ray>& rays, int step);
  double evaluations() const { return evaluations_; }

 private:
  const Program& program_;
  std::unique_ptr<SampleSource> places_;
  FrameState start_;  // before the frame function has run
  int threads_;
  RunStatus& status_;
  std::size_t near_output_ = 0, far_output_ = 0, count_output_ = 0;
  double evaluations_ = 0;
};

// The whole prepass of one frame. With `bounds`, what is not proven empty is all there is to look
// at; where it is little, or much of it is found, it is the result, and nothing is missed. Else
// every `factor`th pixel and step of it is looked at and widened by one cell on all sides; then
// followed wherever matter goes on beyond the cells found. Then others of these steps and all steps
// of single pixels are looked at: where they meet what was not found, all is done again with half
// the factor, and with the factor 1 all that may hold matter is the result. `report.left` is what
// was only looked at in samples: where it is 0, nothing is missed. Nothing when cancelled or
// failed.
std::optional<Spans> find_spans(SpanSearch& search, BoxBounds* bounds, int width, int height,
                                int factor, PrepassReport& report);

// Writes the spans as an image with the pixels of the picture and the channels near and far.
// Throws Failure (output).
void write_spans(const Spans& spans, int width, int height, const std::string& file);

}  // namespace pse::app
