// The lattice of a volume as a source of samples: a box of voxels with the program run at the
// centre of each. Axes of pse: x right, y up, z towards the viewer, in metres. The lattice lies
// along the axes of the file, which are the same unless its z points up.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "stream/program.h"

namespace pse::volume {

struct Box {
  std::array<double, 3> low{-1, -1, -1}, high{1, 1, 1};  // in pse's axes
};

// How many voxels: along the longest side, with cubes for voxels, or along each of pse's axes.
struct LatticeSize {
  int longest = 128;
  std::array<int, 3> each{};  // counts where not 0
};

class Lattice {
 public:
  Lattice(const Box& box, const LatticeSize& size, bool z_up);

  // Of the file's axes: voxels, the centre of voxel (0, 0, 0), sides of a voxel.
  const std::array<int, 3>& size() const { return size_; }
  const std::array<double, 3>& origin() const { return origin_; }
  const std::array<double, 3>& voxel() const { return voxel_; }
  std::int64_t voxels() const { return std::int64_t{size_[0]} * size_[1] * size_[2]; }

  // The centre of a voxel in pse's axes.
  std::array<double, 3> point(const std::array<int, 3>& voxel) const;

  // Along which of the file's axes one of pse's runs, and whether backwards.
  int file_axis(int axis) const { return z_up_ && axis > 0 ? 3 - axis : axis; }
  bool backwards(int axis) const { return z_up_ && axis == 2; }

 private:
  bool z_up_;
  std::array<int, 3> size_{};
  std::array<double, 3> origin_{}, voxel_{};
};

// point x y z u v w px py pz per sample; frame time fps width height depth pixelsize pixel_freq
// seed begin_frame per frame, as far as they mean something here.
const std::vector<StreamName>& lattice_names();

struct LatticeFrame {
  double frame = 0, fps = 24;
  std::uint32_t seed = 0;
};

// Sets the uniforms of the module's frame-rate inputs that the lattice brings. Makes room in
// state.uniforms for every input.
void set_lattice_uniforms(const ir::Module& module, const Lattice& lattice,
                          const LatticeFrame& frame, FrameState& state);

// The sample-rate inputs of a module at the voxels of a cube: x slowest, z fastest.
class LatticeSource {
 public:
  LatticeSource(const ir::Module& module, const Lattice& lattice);
  // Writes side^3 values behind `at` in every plane that the lattice feeds; voxels outside the
  // lattice are given as well.
  void fill(const std::array<int, 3>& first, int side, std::size_t at,
            std::span<float* const> planes) const;

 private:
  struct Feed {
    std::size_t input;
    std::size_t axis;  // of the file
    std::vector<float> values;
  };
  std::vector<Feed> feeds_;
};

}  // namespace pse::volume
