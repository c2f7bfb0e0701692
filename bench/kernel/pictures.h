// The scenes of gallery/measure as the user writes them: text -> kernel, run on tiles spread over
// the picture.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "stream/program.h"

namespace pse::bench {

class Picture {
 public:
  // Compiles gallery/measure/NAME.pse at one width; ends the program with the errors where that
  // fails.
  Picture(const std::string& name, int size, int width, const std::string& cpu);

  std::int64_t samples() const { return static_cast<std::int64_t>(tiles_.size()) * tile_samples; }
  const CompileTimes& times() const { return program_->times; }
  // Computes all tiles; the results stay in `results`.
  void run();
  // Compares some samples of the last run with the interpreter, bit for bit.
  bool agrees_with_interpreter() const;

 private:
  static constexpr int tile_size = 64;
  static constexpr std::int64_t tile_samples = tile_size * tile_size;
  struct Tile {
    std::vector<float> inputs, outputs;  // planes one after another
    std::vector<const float*> in;
    std::vector<float*> out;
  };

  std::shared_ptr<const Program> program_;
  FrameState state_;
  Scratch scratch_;
  std::vector<Tile> tiles_;
};

}  // namespace pse::bench
