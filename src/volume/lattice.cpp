// Places of voxels, computed in double and rounded once, so that a voxel's place is the same
// whatever block computes it.
#include "volume/lattice.h"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace pse::volume {
namespace {

// Room behind the lattice for the last block's voxels.
constexpr int padding = 16;

enum class Kind { place, unit, index, lowest, highest };

struct Brought {
  std::string_view name;
  Kind kind;
  int axis;  // of pse
};

constexpr std::array<Brought, 14> brought = {{{"point.0", Kind::place, 0},
                                              {"point.1", Kind::place, 1},
                                              {"point.2", Kind::place, 2},
                                              {"x", Kind::place, 0},
                                              {"y", Kind::place, 1},
                                              {"z", Kind::place, 2},
                                              {"u", Kind::unit, 0},
                                              {"v", Kind::unit, 1},
                                              {"w", Kind::unit, 2},
                                              {"px", Kind::index, 0},
                                              {"py", Kind::index, 1},
                                              {"pz", Kind::index, 2},
                                              {"prepass.near", Kind::lowest, 0},
                                              {"prepass.far", Kind::highest, 0}}};

}  // namespace

Lattice::Lattice(const Box& box, const LatticeSize& size, bool z_up) : z_up_(z_up) {
  double longest = 0;
  for (std::size_t a = 0; a < 3; ++a) longest = std::max(longest, box.high[a] - box.low[a]);
  for (int axis = 0; axis < 3; ++axis) {
    const auto from = static_cast<std::size_t>(axis),
               to = static_cast<std::size_t>(file_axis(axis));
    const double side = box.high[from] - box.low[from];
    if (size.each[0] > 0) {
      size_[to] = size.each[from];
      voxel_[to] = side / size_[to];
    } else {
      // Cubes that cover the box; what is too much lies on both sides.
      voxel_[to] = longest / size.longest;
      size_[to] = std::max(1, static_cast<int>(std::ceil(side / voxel_[to] - 1e-6)));
    }
    const double middle = 0.5 * (box.low[from] + box.high[from]);
    origin_[to] = (backwards(axis) ? -middle : middle) - 0.5 * (size_[to] - 1) * voxel_[to];
  }
}

std::array<double, 3> Lattice::point(const std::array<int, 3>& voxel) const {
  std::array<double, 3> place{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto from = static_cast<std::size_t>(file_axis(axis));
    const double along = origin_[from] + voxel_[from] * voxel[from];
    place[static_cast<std::size_t>(axis)] = backwards(axis) ? -along : along;
  }
  return place;
}

const std::vector<StreamName>& lattice_names() {
  using enum ir::Rate;
  constexpr auto even = ir::InputSlopes::of_frame;
  static const std::vector<StreamName> names = {
      {"point", 3, sample, even}, {"x", 1, sample, even}, {"y", 1, sample, even}, {"z", 1, sample},
      {"u", 1, sample},        {"v", 1, sample},         {"w", 1, sample},     {"px", 1, sample},
      {"py", 1, sample},       {"pz", 1, sample},        {"frame", 1, frame},  {"time", 1, frame},
      {"fps", 1, frame},       {"width", 1, frame},      {"height", 1, frame}, {"depth", 1, frame},
      {"aspect", 1, frame},    {"pixelsize", 1, frame},  {"seed", 1, frame},
      {"pixel_freq", 1, frame}, {"begin_frame", 1, frame}, {"prepass.near", 1, sample},
      {"prepass.far", 1, sample}, {"prepass.step", 1, frame}, {"xform", 16, frame}};
  return names;
}

void set_lattice_uniforms(const ir::Module& module, const Lattice& lattice,
                          const LatticeFrame& frame, FrameState& state) {
  const auto along = [&](int axis) {
    return double(lattice.size()[static_cast<std::size_t>(lattice.file_axis(axis))]);
  };
  const double voxel =
      std::max({lattice.voxel()[0], lattice.voxel()[1], lattice.voxel()[2]});
  // Of the three directions from voxel to voxel the first two stand for those of a picture.
  const std::array<std::pair<std::string_view, double>, 15> values = {
      {{"point.0$x", lattice.voxel()[static_cast<std::size_t>(lattice.file_axis(0))]},
       {"point.1$y", lattice.voxel()[static_cast<std::size_t>(lattice.file_axis(1))]},
       {"x$x", lattice.voxel()[static_cast<std::size_t>(lattice.file_axis(0))]},
       {"y$y", lattice.voxel()[static_cast<std::size_t>(lattice.file_axis(1))]},
       {"frame", frame.frame},
       {"time", frame.frame / frame.fps},
       {"fps", frame.fps},
       {"width", along(0)},
       {"height", along(1)},
       {"depth", along(2)},
       {"aspect", along(0) / along(1)},
       {"pixelsize", voxel},
       {"pixel_freq", 0.5 / voxel},
       {"seed", frame.seed},
       {"begin_frame", 1}}};
  state.uniforms.resize(module.inputs.size());
  for (std::size_t i = 0; i < module.inputs.size(); ++i) {
    if (module.inputs[i].rate == ir::Rate::sample) continue;
    for (const auto& [name, value] : values)
      if (module.inputs[i].name == name) state.uniforms[i] = static_cast<float>(value);
  }
}

LatticeSource::LatticeSource(const ir::Module& module, const Lattice& lattice) {
  for (std::size_t i = 0; i < module.inputs.size(); ++i) {
    if (module.inputs[i].rate != ir::Rate::sample) continue;
    const auto found = std::find_if(brought.begin(), brought.end(), [&](const Brought& name) {
      return name.name == module.inputs[i].name;
    });
    if (found == brought.end()) continue;
    const auto axis = static_cast<std::size_t>(lattice.file_axis(found->axis));
    const int count = lattice.size()[axis];
    Feed feed{i, axis, {}};
    for (int k = 0; k < count + padding; ++k) {
      std::array<int, 3> voxel{};
      voxel[axis] = k;
      const double index = (lattice.backwards(found->axis) ? count - 1 - k : k) + 0.5;
      const double value =
          found->kind == Kind::place ? lattice.point(voxel)[static_cast<std::size_t>(found->axis)]
          : found->kind == Kind::unit    ? index / count
          : found->kind == Kind::lowest  ? -1e30
          : found->kind == Kind::highest ? 1e30
                                         : index;
      feed.values.push_back(static_cast<float>(value));
    }
    feeds_.push_back(std::move(feed));
  }
}

void LatticeSource::fill(const std::array<int, 3>& first, int side, std::size_t at,
                         std::span<float* const> planes) const {
  for (const Feed& feed : feeds_) {
    float* out = planes[feed.input] + at;
    const float* values = feed.values.data() + first[feed.axis];
    for (int x = 0; x < side; ++x)
      for (int y = 0; y < side; ++y)
        for (int z = 0; z < side; ++z) *out++ = values[feed.axis == 0 ? x : feed.axis == 1 ? y : z];
  }
}

}  // namespace pse::volume
