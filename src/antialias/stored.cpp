// Round by round: all branches that are open are run at their pixels and at the neighbours that
// take them, and each either meets another condition that crosses its pixel, and divides, or adds
// its share to the picture.
#include "antialias/stored.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>

#include "stream/planes.h"

namespace pse::antialias {
namespace {

// Conditionals that cross one pixel; more are left as they fall.
constexpr int most_depth = 6;
constexpr std::size_t branches_at_once = 4096;

}  // namespace

// A way through the program at one pixel, with some conditions forced.
struct StoredRefiner::Branch {
  std::size_t pixel;  // of Refined
  std::uint32_t high = 0, low = 0;
  unsigned neighbours = 0;  // those that take it too, as bits of `eight_around`
  float weight = 1;
  int depth = 0;
};

struct StoredRefiner::Samples {
  std::vector<std::size_t> at;  // places in the tile's planes
  std::vector<std::uint32_t> high, low;
};

StoredRefiner::StoredRefiner(const Program& program, const FrameState& state, const Program& shown,
                             const Options& options, std::size_t outputs, const Rect& known)
    : program_(program), state_(state), options_(options), known_(known) {
  const std::vector<ir::Output>& made = program.module().outputs;
  for (std::size_t o = 0; o < outputs; ++o) {
    const auto found = std::ranges::find(made, shown.module().outputs[o].name, &ir::Output::name);
    output_of_.push_back(found == made.end() ? 0 : static_cast<std::size_t>(found - made.begin()));
  }
  const std::string_view prefix = condition_name;
  for (std::size_t o = 0; o < made.size(); ++o) {
    if (!made[o].name.starts_with(prefix)) continue;
    const auto number = static_cast<std::uint32_t>(std::stoul(made[o].name.substr(prefix.size())));
    conditions_.push_back({o, 1u << number, made[o].name.ends_with(step_suffix)});
  }
  const std::vector<ir::Input>& tile_inputs = shown.module().inputs;
  const std::vector<ir::Input>& inputs = program.module().inputs;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    from_.push_back(nowhere);
    if (inputs[i].rate != ir::Rate::sample) continue;
    if (inputs[i].name == force_high_name) high_ = i;
    if (inputs[i].name == force_low_name) low_ = i;
    const auto found = std::ranges::find(tile_inputs, inputs[i].name, &ir::Input::name);
    if (found != tile_inputs.end())
      from_[i] = static_cast<std::size_t>(found - tile_inputs.begin());
  }
}

StoredRefiner::Values StoredRefiner::run(std::span<float* const> inputs, const Samples& samples,
                                         RunStatus& status) const {
  const std::size_t outputs = program_.module().outputs.size(), count = samples.at.size();
  std::vector<bool> used;
  for (const ir::Input& input : program_.module().inputs)
    used.push_back(input.rate == ir::Rate::sample);
  const auto capacity = static_cast<std::int64_t>(std::min(count, branches_at_once));
  const Planes in(used, capacity), out(std::vector<bool>(outputs, true), capacity);
  Values results(outputs, std::vector<float>(count));
  Scratch scratch;
  for (std::size_t first = 0; first < count && !status.cancel; first += branches_at_once) {
    const std::size_t size = std::min(branches_at_once, count - first);
    for (std::size_t i = 0; i < used.size(); ++i) {
      if (!used[i]) continue;
      float* to = in.pointers()[i];
      for (std::size_t k = 0; k < size; ++k)
        to[k] = i == high_                    ? static_cast<float>(samples.high[first + k])
                : i == low_                   ? static_cast<float>(samples.low[first + k])
                : from_[i] == nowhere         ? 0
                : inputs[from_[i]] == nullptr ? 0
                                              : inputs[from_[i]][samples.at[first + k]];
    }
    program_.kernel->run_samples(state_, status, scratch, in.pointers().data(),
                                 out.pointers().data(), static_cast<std::int64_t>(size));
    for (std::size_t o = 0; o < outputs; ++o)
      std::copy_n(out.pointers()[o], size, results[o].begin() + static_cast<std::ptrdiff_t>(first));
  }
  return results;
}

Refined StoredRefiner::refine(const Tile& tile, std::span<float* const> inputs, RunStatus& status,
                              Counts& counts) const {
  Found memory;
  std::vector<Pixel> edges;
  std::ranges::copy_if(find_edge_pixels(tile, options_.filter, memory), std::back_inserter(edges),
                       [](const Pixel& pixel) { return !pixel.narrow; });
  Refined refined(std::move(edges), output_of_.size());
  const std::vector<Pixel>& pixels = refined.pixels;
  counts.filtered += static_cast<std::int64_t>(pixels.size());
  for (auto& values : refined.values) values.assign(pixels.size(), 0);
  std::vector<bool> failed(pixels.size()), crossed(pixels.size());

  // At first every pixel has all neighbours of its object.
  std::vector<Branch> branches;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    Branch branch{.pixel = i};
    for (std::size_t n = 0; n < eight_around.size(); ++n) {
      const int x = pixels[i].x + eight_around[n][0], y = pixels[i].y + eight_around[n][1];
      const bool is_there = x >= known_.x0 && x < known_.x1 && y >= known_.y0 && y < known_.y1;
      if (is_there &&
          (!tile.ids || tile.ids[tile.at(x, y)] == tile.ids[tile.at(pixels[i].x, pixels[i].y)]))
        branch.neighbours |= 1u << n;
    }
    branches.push_back(branch);
  }

  while (!branches.empty() && !status.cancel) {
    Samples samples;
    const auto add = [&](const Branch& branch, int dx, int dy) {
      samples.at.push_back(tile.at(pixels[branch.pixel].x + dx, pixels[branch.pixel].y + dy));
      samples.high.push_back(branch.high), samples.low.push_back(branch.low);
    };
    std::vector<std::size_t> first;
    for (const Branch& branch : branches) {
      first.push_back(samples.at.size());
      add(branch, 0, 0);
      for (std::size_t n = 0; n < eight_around.size(); ++n)
        if (branch.neighbours >> n & 1) add(branch, eight_around[n][0], eight_around[n][1]);
    }
    const Values results = run(inputs, samples, status);
    std::vector<Branch> next;
    for (std::size_t i = 0; i < branches.size(); ++i)
      advance(branches[i], results, first[i], tile, next, refined, failed, crossed);
    branches = std::move(next);
  }

  // Pixels that no condition crosses, or that could not be told, stay as they are.
  std::size_t kept = 0;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    counts.left += failed[i] ? 1 : 0;
    if (failed[i] || !crossed[i]) continue;
    refined.pixels[kept] = pixels[i];
    for (auto& values : refined.values) values[kept] = values[i];
    ++kept;
  }
  refined.pixels.resize(kept);
  for (auto& values : refined.values) values.resize(kept);
  counts.blended += static_cast<std::int64_t>(kept);
  return refined;
}

// Divides a branch at the first condition that crosses its pixel, or adds its value to the pixel.
void StoredRefiner::advance(const Branch& branch, const Values& results, std::size_t first,
                            const Tile& tile, std::vector<Branch>& next, Refined& refined,
                            std::vector<bool>& failed, std::vector<bool>& crossed) const {
  const bool reaches_far = options_.filter.reach() > 1.01f;
  const std::uint32_t forced = branch.high | branch.low;
  bool explained = false;
  // The neighbours that are on the same side of all conditions so far: what follows a condition may
  // jump where it does.
  unsigned list = branch.neighbours;
  for (const Condition& condition : conditions_) {
    if (branch.depth == most_depth) break;
    if (forced & condition.bit) continue;
    const std::vector<float>& values = results[condition.output];
    float here = values[first];
    if (std::isnan(here)) continue;
    // A step's value counts from the step that is nearest to the pixel's.
    const float level = condition.is_step ? std::nearbyint(here) : 0;
    here -= level;
    std::array<float, 8> there{};
    unsigned known = 0, same_side = 0;
    bool changes = false;
    std::size_t next_sample = first + 1;
    for (std::size_t n = 0; n < eight_around.size(); ++n) {
      if (!(branch.neighbours >> n & 1)) continue;
      there[n] = values[next_sample++] - level;
      if (std::isnan(there[n]) || !(list >> n & 1)) continue;
      known |= 1u << n;
      if ((there[n] > 0) == (here > 0))
        same_side |= 1u << n;
      else
        changes = true;
    }
    explained = explained || changes;
    if (!changes && !reaches_far) continue;
    FittedEdge edge{};
    const Fit fit = fit_edge(here, there, known, options_.filter, edge);
    if (fit == Fit::failed && changes) failed[branch.pixel] = true;
    if (fit != Fit::edge) {
      list = (list & ~known) | same_side;
      continue;
    }
    // Both sides, with the neighbours whose kernels reach into them.
    const float reach = options_.filter.reach();
    crossed[branch.pixel] = true;
    Branch high = branch, low = branch;
    high.neighbours = low.neighbours = list;
    high.high |= condition.bit, low.low |= condition.bit;
    high.weight *= edge.share, low.weight *= 1 - edge.share;
    high.depth = low.depth = branch.depth + 1;
    for (std::size_t n = 0; n < eight_around.size(); ++n) {
      if (!(edge.distances[n] > -reach)) high.neighbours &= ~(1u << n);
      if (!(edge.distances[n] < reach)) low.neighbours &= ~(1u << n);
    }
    if (high.weight > 0) next.push_back(high);
    if (low.weight > 0) next.push_back(low);
    return;
  }
  // A loop, or a clamp, that no condition tells of.
  if (branch.depth == 0 && !explained && !refined.pixels[branch.pixel].silhouette)
    failed[branch.pixel] = true;
  const std::size_t here = tile.at(refined.pixels[branch.pixel].x, refined.pixels[branch.pixel].y);
  for (std::size_t o = 0; o < output_of_.size(); ++o) {
    const float value = results[output_of_[o]][first];
    // What a branch cannot compute where it does not belong.
    if (!std::isfinite(value) && std::isfinite(tile.planes[o][here])) failed[branch.pixel] = true;
    refined.values[o][branch.pixel] += branch.weight * value;
  }
}

void extend_stored(const Rect& area, const Rect& known, std::span<float* const> planes) {
  const auto at = [&](int x, int y) {
    return static_cast<std::size_t>(y - area.y0) * static_cast<std::size_t>(area.width()) +
           static_cast<std::size_t>(x - area.x0);
  };
  for (int y = area.y0; y < area.y1; ++y)
    for (int x = area.x0; x < area.x1; ++x) {
      const int inside_x = std::clamp(std::clamp(x, known.x0, known.x1 - 1), area.x0, area.x1 - 1);
      const int inside_y = std::clamp(std::clamp(y, known.y0, known.y1 - 1), area.y0, area.y1 - 1);
      if (inside_x == x && inside_y == y) continue;
      for (float* plane : planes)
        if (plane != nullptr) plane[at(x, y)] = plane[at(inside_x, inside_y)];
    }
}

}  // namespace pse::antialias
