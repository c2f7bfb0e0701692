// Gathering a list's samples into batches, scattering the results, and the neighbour table.
#include "stream/sample_list.h"

#include <algorithm>
#include <numeric>

namespace pse {
namespace {

struct Step {
  Neighbour which;
  int dx, dy;
};

constexpr std::array<Step, neighbour_count> steps = {{{Neighbour::left, -1, 0},
                                                      {Neighbour::right, 1, 0},
                                                      {Neighbour::up, 0, -1},
                                                      {Neighbour::down, 0, 1},
                                                      {Neighbour::up_left, -1, -1},
                                                      {Neighbour::up_right, 1, -1},
                                                      {Neighbour::down_left, -1, 1},
                                                      {Neighbour::down_right, 1, 1}}};

// Places in row-major order; wide enough for the neighbours of the extreme coordinates.
using RowAndColumn = std::pair<std::int64_t, std::int64_t>;

}  // namespace

SampleList samples_of(const Rect& rect) {
  SampleList list;
  list.reserve(static_cast<std::size_t>(rect.width()) * static_cast<std::size_t>(rect.height()));
  for (int y = rect.y0; y < rect.y1; ++y)
    for (int x = rect.x0; x < rect.x1; ++x)
      list.push_back({x, y, static_cast<std::int64_t>(list.size())});
  return list;
}

SampleList select_samples(const SampleList& list, const float* plane, bool wanted) {
  SampleList chosen;
  std::copy_if(list.begin(), list.end(), std::back_inserter(chosen),
               [&](const Sample& sample) { return (plane[sample.at] != 0.0f) == wanted; });
  return chosen;
}

NeighbourTable::NeighbourTable(const SampleList& list) : table_(list.size()) {
  // Sort the samples by place; of several at one place the first in the list stands for it.
  std::vector<std::int32_t> order(list.size());
  std::iota(order.begin(), order.end(), 0);
  const auto place_of = [&](std::int32_t i) {
    const Sample& sample = list[static_cast<std::size_t>(i)];
    return RowAndColumn{sample.y, sample.x};
  };
  const auto before = [&](std::int32_t a, std::int32_t b) { return place_of(a) < place_of(b); };
  if (!std::is_sorted(order.begin(), order.end(), before))
    std::stable_sort(order.begin(), order.end(), before);

  // Look up each direction with a cursor of its own: places are asked for in rising order, so it
  // only moves forward.
  for (const Step& step : steps) {
    auto cursor = order.begin();
    for (const std::int32_t i : order) {
      const Sample& sample = list[static_cast<std::size_t>(i)];
      const RowAndColumn wanted = {std::int64_t{sample.y} + step.dy,
                                   std::int64_t{sample.x} + step.dx};
      while (cursor != order.end() && place_of(*cursor) < wanted) ++cursor;
      const bool found = cursor != order.end() && place_of(*cursor) == wanted;
      table_[static_cast<std::size_t>(i)][static_cast<std::size_t>(step.which)] =
          found ? *cursor : -1;
    }
  }
}

ListResult run_list(const Program& segment, const FrameState& state, const SampleList& list,
                    std::span<const float* const> inputs, std::span<float* const> outputs,
                    const ListOptions& options, RunStatus& status) {
  const auto size = static_cast<std::int64_t>(list.size());
  const std::int64_t batch =
      std::clamp<std::int64_t>(options.batch, 1, std::max<std::int64_t>(size, 1));
  const auto part = [&](std::int64_t number) {
    return std::span(list).subspan(
        static_cast<std::size_t>(number * batch),
        static_cast<std::size_t>(std::min(batch, size - number * batch)));
  };

  BatchPlan plan;
  plan.batches = (size + batch - 1) / batch;
  plan.capacity = batch;
  plan.threads = options.threads;
  plan.count = [&](std::int64_t number) { return static_cast<std::int64_t>(part(number).size()); };
  plan.fill = [&](std::int64_t number, std::span<float* const> planes) {
    const auto samples = part(number);
    for (std::size_t p = 0; p < planes.size(); ++p)
      if (planes[p] != nullptr)
        for (std::size_t i = 0; i < samples.size(); ++i) planes[p][i] = inputs[p][samples[i].at];
  };
  plan.drain = [&](std::int64_t number, std::span<float* const> planes) {
    const auto samples = part(number);
    for (std::size_t p = 0; p < planes.size(); ++p)
      if (outputs[p] != nullptr)
        for (std::size_t i = 0; i < samples.size(); ++i) outputs[p][samples[i].at] = planes[p][i];
  };
  const BatchEnd end = run_batches(segment, state, plan, status);
  return {end.end, end.failed_check,
          static_cast<std::size_t>(end.failed_batch * batch + end.failed_sample)};
}

}  // namespace pse
