// A program run at any places of the picture.
#pragma once

#include <vector>

#include "stream/program.h"
#include "stream/sample_source.h"

namespace pse::antialias {

// Places in pixels of the whole picture.
struct Places {
  std::vector<double> x, y;
  std::size_t size() const { return x.size(); }
  void add(double px, double py) { x.push_back(px), y.push_back(py); }
};

// outputs[o][i]: output o of the program at place i.
using Results = std::vector<std::vector<float>>;

class PlaceRunner {
 public:
  // `source` is made for the program's module. Inputs named "NAME$x" and "NAME$y" get the slopes of
  // NAME per pixel. All must outlive this; `state` has its frame computed.
  PlaceRunner(const Program& program, const FrameState& state, const SampleSource& source);

  // `status` may be cancelled; the results are then meaningless. May be called from several
  // threads at once.
  Results run(const Places& places, RunStatus& status) const;

 private:
  struct Slope {
    std::size_t input, of;  // indices of Module::inputs
    bool along_x;
    float even = 0;  // the slope, where it is the same everywhere
  };
  void fill(std::span<const double> x, std::span<const double> y,
            std::span<float* const> planes) const;

  const Program& program_;
  const FrameState& state_;
  const SampleSource& source_;
  std::vector<bool> used_;      // inputs that the source fills, and slopes
  std::vector<bool> sloping_;   // inputs whose slopes are wanted
  std::vector<Slope> slopes_;
  std::size_t id_ = no_id;  // the input that tells objects apart
  static constexpr auto no_id = static_cast<std::size_t>(-1);
};

}  // namespace pse::antialias
