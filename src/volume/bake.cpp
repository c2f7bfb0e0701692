// Batches of 2 x 2 x 2 blocks through the kernel, and what of them is kept.
#include "volume/bake.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

namespace pse::volume {
namespace {

constexpr int batch_blocks = 2;  // along each side
constexpr int batch_side = batch_blocks * block_side;
constexpr std::int64_t estimated_batches = 256;  // that tell how much memory all will take
constexpr std::int64_t batch_voxels = std::int64_t{batch_side} * batch_side * batch_side;

// The nearest number that 16 bits can hold is 0 below the first of these, infinite from the second.
constexpr float least_half = 0x1p-25f, most_half = 65504.0f;

using Mask = std::array<std::uint64_t, 8>;

// Takes the results of batches, in order, and passes blocks with matter on.
class Gatherer {
 public:
  Gatherer(const Lattice& lattice, const std::vector<BakedGrid>& grids, GridWriter& writer,
           const BakeOptions& options, RunStatus& status, BakeResult& result)
      : lattice_(lattice),
        grids_(grids),
        writer_(writer),
        options_(options),
        status_(status),
        result_(result) {
    for (std::size_t g = 0; g < grids.size(); ++g)
      if (grids[g].spec.name == "density") density_ = g;
  }

  // One block, whose results start at `at` in the planes.
  void take(const std::array<int, 3>& block, std::size_t at, std::span<float* const> planes) {
    const Mask inside = inside_of(block);
    Mask shared{};
    if (density_ < grids_.size()) shared = values_of(density_, block, at, planes, inside);
    for (std::size_t g = 0; g < grids_.size(); ++g) {
      Mask active = g == density_ ? shared : values_of(g, block, at, planes, inside);
      if (density_ < grids_.size() && grids_[g].spec.kind != GridKind::level_set) active = shared;
      store(g, block, at, planes, active, inside);
    }
    if (writer_.bytes() > options_.memory_limit) {
      result_.out_of_memory = true;
      status_.cancel = true;
    }
  }

 private:
  // The voxels of the block that belong to the lattice.
  Mask inside_of(const std::array<int, 3>& block) const {
    Mask mask{};
    for (int x = 0; x < block_side; ++x)
      for (int y = 0; y < block_side; ++y)
        for (int z = 0; z < block_side; ++z)
          if (block[0] * block_side + x < lattice_.size()[0] &&
              block[1] * block_side + y < lattice_.size()[1] &&
              block[2] * block_side + z < lattice_.size()[2])
            mask[static_cast<std::size_t>(x)] |= std::uint64_t{1} << (8 * y + z);
    return mask;
  }

  // Makes the grid's values what will be stored, in place, and tells where there is matter.
  Mask values_of(std::size_t g, const std::array<int, 3>& block, std::size_t at,
                 std::span<float* const> planes, const Mask& inside) {
    const BakedGrid& grid = grids_[g];
    Mask active{};
    for (std::size_t i = 0; i < block_voxels; ++i) {
      const std::uint64_t bit = std::uint64_t{1} << (i & 63);
      if ((inside[i >> 6] & bit) == 0) continue;
      bool matter = false;
      for (const std::size_t output : grid.outputs) {
        float& value = planes[output][at + i];
        if (!std::isfinite(value)) note_not_finite(g, block, i), value = grid.spec.background;
        if (grid.spec.kind == GridKind::level_set) {
          matter = matter || std::abs(value) < grid.band;
          value = std::clamp(value, -grid.band, grid.band);
          continue;
        }
        if (g == density_) value = std::max(value, 0.0f);
        if (grid.spec.half)
          value = std::abs(value) <= least_half ? 0.0f : std::clamp(value, -most_half, most_half);
        matter = matter || value != grid.spec.background;
      }
      if (matter) active[i >> 6] |= bit;
    }
    return active;
  }

  void store(std::size_t g, const std::array<int, 3>& block, std::size_t at,
             std::span<float* const> planes, const Mask& active, const Mask& inside) {
    if (std::all_of(active.begin(), active.end(), [](std::uint64_t word) { return word == 0; }))
      return;
    const GridSpec& spec = grids_[g].spec;
    std::vector<const float*> values;
    for (std::size_t c = 0; c < grids_[g].outputs.size(); ++c) {
      float* plane = planes[grids_[g].outputs[c]] + at;
      for (std::size_t i = 0; i < block_voxels; ++i) {
        const bool is_active = (active[i >> 6] >> (i & 63) & 1) != 0;
        const bool is_inside = (inside[i >> 6] >> (i & 63) & 1) != 0;
        const bool keeps = spec.kind == GridKind::level_set ? is_inside : is_active;
        if (!keeps) plane[i] = spec.background;
        if (is_active && (g == 0 || g == density_) && on_face(block, i)) result_.cut = true;
      }
      values.push_back(plane);
    }
    if (g == (density_ < grids_.size() ? density_ : 0))
      for (const std::uint64_t word : active) result_.active += __builtin_popcountll(word);
    writer_.add(g, block, values, active);
  }

  std::array<int, 3> voxel_of(const std::array<int, 3>& block, std::size_t i) const {
    const int index = static_cast<int>(i);
    return {block[0] * block_side + (index >> 6), block[1] * block_side + (index >> 3 & 7),
            block[2] * block_side + (index & 7)};
  }

  bool on_face(const std::array<int, 3>& block, std::size_t i) const {
    const std::array<int, 3> voxel = voxel_of(block, i);
    for (std::size_t a = 0; a < 3; ++a)
      if (voxel[a] == 0 || voxel[a] == lattice_.size()[a] - 1) return true;
    return false;
  }

  void note_not_finite(std::size_t g, const std::array<int, 3>& block, std::size_t i) {
    if (result_.not_finite++ > 0) return;
    result_.not_finite_grid = g;
    result_.not_finite_at = lattice_.point(voxel_of(block, i));
    if (options_.stop_at_not_finite) status_.cancel = true;
  }

  const Lattice& lattice_;
  const std::vector<BakedGrid>& grids_;
  GridWriter& writer_;
  const BakeOptions& options_;
  RunStatus& status_;
  BakeResult& result_;
  std::size_t density_ = static_cast<std::size_t>(-1);  // which grid it is, if any
};

// Counts what blocks would take.
class Tally : public GridWriter {
 public:
  void add(std::size_t, const std::array<int, 3>&, std::span<const float* const> planes,
           const std::array<std::uint64_t, 8>& active) override {
    if (!is_even(planes, active)) bytes_ += block_bytes * planes.size();
  }
  std::size_t bytes() const override { return bytes_; }
  Result<void> write(const std::string&, const std::map<std::string, std::string>&,
                     const std::string&) override {
    return fail(ErrorKind::cannot_write, "there is nothing to write");
  }

 private:
  std::size_t bytes_ = 0;
};

}  // namespace

BakeResult bake(const Program& program, FrameState& state, const Lattice& lattice,
                const std::vector<BakedGrid>& grids, GridWriter& writer, const BakeOptions& options,
                RunStatus& status) {
  const auto start = std::chrono::steady_clock::now();
  BakeResult result;
  program.kernel->run_frame(state, status);
  if (status.failed_check >= 0) {
    result.end = RunEnd::failed;
    result.failed_check = status.failed_check;
    return result;
  }

  // Number the batches, x slowest.
  std::array<std::int64_t, 3> count{};
  for (std::size_t a = 0; a < 3; ++a) count[a] = (lattice.size()[a] + batch_side - 1) / batch_side;
  const auto first_voxel = [&](std::int64_t batch) -> std::array<int, 3> {
    return {static_cast<int>(batch / (count[1] * count[2])) * batch_side,
            static_cast<int>(batch / count[2] % count[1]) * batch_side,
            static_cast<int>(batch % count[2]) * batch_side};
  };
  const auto each_block = [&](std::int64_t batch, auto&& work) {
    const std::array<int, 3> first = first_voxel(batch);
    std::size_t at = 0;
    for (int x = 0; x < batch_blocks; ++x)
      for (int y = 0; y < batch_blocks; ++y)
        for (int z = 0; z < batch_blocks; ++z, at += block_voxels)
          work(std::array<int, 3>{first[0] / block_side + x, first[1] / block_side + y,
                                  first[2] / block_side + z},
               at);
  };

  // How some of them, or all, are run.
  const std::int64_t batches = count[0] * count[1] * count[2];
  const LatticeSource source(program.module(), lattice);
  const auto run = [&](std::int64_t number, const auto& pick, Gatherer& gatherer) {
    BatchPlan plan;
    plan.batches = number;
    plan.capacity = batch_voxels;
    plan.count = [](std::int64_t) { return batch_voxels; };
    plan.fill = [&](std::int64_t k, std::span<float* const> planes) {
      each_block(pick(k), [&](const std::array<int, 3>& block, std::size_t at) {
        source.fill({block[0] * block_side, block[1] * block_side, block[2] * block_side},
                    block_side, at, planes);
      });
    };
    plan.drain = [&](std::int64_t k, std::span<float* const> planes) {
      each_block(pick(k), [&](const std::array<int, 3>& block, std::size_t at) {
        gatherer.take(block, at, planes);
      });
    };
    plan.ordered = true;
    plan.threads = options.threads;
    if (number == batches) plan.progress = options.progress;
    BatchEnd end = run_batches(program, state, plan, status);
    if (end.end == RunEnd::failed) end.failed_batch = pick(end.failed_batch);
    return end;
  };

  // Where memory might not do, an estimate from batches spread over all.
  BatchEnd end;
  std::size_t components = 0;
  for (const BakedGrid& grid : grids) components += grid.outputs.size();
  const double most = double(batches) * batch_voxels / block_voxels * double(block_bytes);
  if (batches > estimated_batches && most * double(components) > double(options.memory_limit)) {
    Tally tally;
    BakeResult ignored;
    BakeOptions patient = options;
    patient.stop_at_not_finite = false;
    patient.memory_limit = std::numeric_limits<std::size_t>::max();
    Gatherer gatherer(lattice, grids, tally, patient, status, ignored);
    const std::int64_t stretch = batches / estimated_batches;
    end = run(
        estimated_batches, [&](std::int64_t k) { return k * stretch + (k * 2654435761) % stretch; },
        gatherer);
    const double all = double(tally.bytes()) * double(batches) / estimated_batches;
    if (end.end == RunEnd::finished && all > 2 * double(options.memory_limit)) {
      result.out_of_memory = true;
      result.estimate = all;
      return result;
    }
  }

  // All of them.
  Gatherer gatherer(lattice, grids, writer, options, status, result);
  if (end.end == RunEnd::finished)
    end = run(
        batches, [](std::int64_t k) { return k; }, gatherer);

  result.end = end.end;
  result.failed_check = end.failed_check;
  if (end.end == RunEnd::failed) {
    const std::array<int, 3> first = first_voxel(end.failed_batch);
    const int block = static_cast<int>(end.failed_sample / block_voxels);
    const int voxel = static_cast<int>(end.failed_sample % block_voxels);
    result.failed_at = lattice.point({first[0] + (block >> 2) * block_side + (voxel >> 6),
                                      first[1] + (block >> 1 & 1) * block_side + (voxel >> 3 & 7),
                                      first[2] + (block & 1) * block_side + (voxel & 7)});
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace pse::volume
