// From large boxes to small ones, a level at a time.
#include "app/prepass_proof.h"

#include <algorithm>
#include <cmath>

#include "app/surfaces.h"
#include "stream/batches.h"

namespace pse::app {
namespace {

constexpr int largest_block = 64;  // pixels
constexpr std::int64_t batch = 1024;

bool ends_with(const std::string& name, std::string_view end) {
  return name.size() > end.size() && name.ends_with(end);
}

// Ends moved outward by more than the rounding of a coordinate.
float below(float value) { return value - std::abs(value) * 0x1p-21f - 1e-9f; }
float above(float value) { return value + std::abs(value) * 0x1p-21f + 1e-9f; }

}  // namespace

BoxBounds::BoxBounds(const Program& program, const ImagePlane& plane,
                     const std::vector<Knob>& knobs, const std::vector<ExternalFunction>& externals,
                     int threads, RunStatus& status)
    : program_(program),
      state_(plane_state(program.module(), plane, knobs)),
      threads_(threads),
      status_(status) {
  const auto& inputs = program.module().inputs;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (!ends_with(inputs[i].name, "$lo")) continue;
    const std::string name = inputs[i].name.substr(0, inputs[i].name.size() - 3);
    for (std::size_t k = 0; k < inputs.size(); ++k)
      if (inputs[k].name == name + "$hi") high_.push_back(k);
    low_.push_back(i);
    named_.inputs.push_back({name, ir::Rate::sample});
  }
  places_ = image_plane_samples(named_, plane);
  state_.externals = externals;
  program_.kernel->run_frame(state_, status_);
}

bool BoxBounds::look(std::vector<Box>& boxes) {
  if (status_.failed_check >= 0 || status_.cancel) return false;
  const auto part = [&](std::int64_t number) {
    const auto size = static_cast<std::int64_t>(boxes.size());
    return std::span(boxes).subspan(
        static_cast<std::size_t>(number * batch),
        static_cast<std::size_t>(std::min(batch, size - number * batch)));
  };
  BatchPlan plan;
  plan.batches = (static_cast<std::int64_t>(boxes.size()) + batch - 1) / batch;
  plan.capacity = batch;
  plan.threads = threads_;
  plan.count = [&](std::int64_t number) { return static_cast<std::int64_t>(part(number).size()); };
  plan.fill = [&](std::int64_t number, std::span<float* const> planes) {
    const auto some = part(number);
    const std::size_t n = some.size();
    // The coordinates at the four corners; between them lies what is within.
    std::vector<std::vector<float>> corner(named_.inputs.size(), std::vector<float>(n));
    std::vector<float*> pointers;
    for (auto& values : corner) pointers.push_back(values.data());
    std::vector<double> x(n), y(n);
    for (int c = 0; c < 4; ++c) {
      for (std::size_t i = 0; i < n; ++i) {
        x[i] = some[i].x + (c & 1) * some[i].size;
        y[i] = some[i].y + (c >> 1) * some[i].size;
      }
      places_->fill(x, y, pointers);
      for (std::size_t k = 0; k < corner.size(); ++k) {
        float *low = planes[low_[k]], *high = planes[high_[k]];
        for (std::size_t i = 0; i < n; ++i) {
          const float value = corner[k][i];
          if (low != nullptr) low[i] = c == 0 ? below(value) : std::min(low[i], below(value));
          if (high != nullptr) high[i] = c == 0 ? above(value) : std::max(high[i], above(value));
        }
      }
    }
    // `prepass.near` is every depth of the stretch, `prepass.far` every random number of a ray.
    for (std::size_t k = 0; k < corner.size(); ++k) {
      const bool depth = named_.inputs[k].name == "prepass.near";
      if (!depth && named_.inputs[k].name != "prepass.far") continue;
      for (std::size_t i = 0; i < n; ++i) {
        if (planes[low_[k]] != nullptr) planes[low_[k]][i] = depth ? some[i].near : 0.0f;
        if (planes[high_[k]] != nullptr) planes[high_[k]][i] = depth ? some[i].far : 1.0f;
      }
    }
  };
  plan.drain = [&](std::int64_t number, std::span<float* const> planes) {
    const auto some = part(number);
    for (std::size_t i = 0; i < some.size(); ++i) {
      some[i].near = std::max(some[i].near, planes[0][i]);
      some[i].far = std::min(some[i].far, planes[1][i]);
      some[i].least = planes[2][i];
      some[i].greatest = planes[3][i];
    }
  };
  return run_batches(program_, state_, plan, status_).end == RunEnd::finished;
}

namespace {

using Box = BoxBounds::Box;

// The cells of `spans` under a box.
template <class Work>
void each_cell(const Spans& spans, const Box& box, const Work& work) {
  const int x1 = std::min((box.x + box.size - 1) / spans.cell, spans.width - 1);
  const int y1 = std::min((box.y + box.size - 1) / spans.cell, spans.height - 1);
  for (int y = box.y / spans.cell; y <= y1; ++y)
    for (int x = box.x / spans.cell; x <= x1; ++x) work(spans.at(x, y));
}

bool may_hold(const Box& box) { return box.near <= box.far && box.greatest > 0; }

// A stretch of a box in equal pieces.
std::vector<Box> pieces_of(const Box& box, int count) {
  std::vector<Box> pieces(static_cast<std::size_t>(count), {box.x, box.y, box.size});
  for (int k = 0; k < count; ++k) {
    Box& piece = pieces[static_cast<std::size_t>(k)];
    piece.near = std::lerp(box.near, box.far, float(k) / float(count));
    piece.far = std::lerp(box.near, box.far, float(k + 1) / float(count));
  }
  return pieces;
}

// The boxes of half the size within these that lie in the picture.
std::vector<Box> halved(const std::vector<Box>& boxes, int width, int height) {
  std::vector<Box> parts;
  for (const Box& box : boxes)
    for (Box piece : pieces_of(box, 2)) {
      piece.size /= 2;
      for (int part = 0; part < 4; ++part) {
        Box quarter = piece;
        quarter.x += (part & 1) * piece.size;
        quarter.y += (part >> 1) * piece.size;
        if (quarter.x < width && quarter.y < height) parts.push_back(quarter);
      }
    }
  return parts;
}

// What the rays of a box march through.
double march(const Box& box) {
  return double(box.size) * box.size * std::max(0.0, double(box.far) - double(box.near));
}

}  // namespace

std::optional<Possible> find_possible(BoxBounds& bounds, int width, int height, std::int64_t most) {
  Possible found{.spans = Spans::nowhere(width, height, 1)};

  // What each block marches through.
  std::vector<Box> boxes;
  for (int y = 0; y < height; y += largest_block)
    for (int x = 0; x < width; x += largest_block) boxes.push_back({x, y, largest_block});
  if (!bounds.look(boxes)) return std::nullopt;
  found.asked = static_cast<std::int64_t>(boxes.size());
  for (const Box& box : boxes)
    found.all += march(box) / (double(box.size) * box.size) * std::min(box.size, width - box.x) *
                 std::min(box.size, height - box.y);
  std::erase_if(boxes, [](const Box& box) { return !may_hold(box); });

  // In pieces about as long as wide, for a march as long as the picture is high; then halved.
  std::vector<Box> next;
  for (const Box& box : boxes)
    for (const Box& piece : pieces_of(box, std::max(1, height / largest_block)))
      next.push_back(piece);
  while (!next.empty() && found.asked + static_cast<std::int64_t>(next.size()) <= most) {
    if (!bounds.look(next)) return std::nullopt;
    found.asked += static_cast<std::int64_t>(next.size());
    std::erase_if(next, [](const Box& box) { return !may_hold(box); });
    boxes = std::move(next);
    next.clear();
    if (!boxes.empty() && boxes.front().size > 1) next = halved(boxes, width, height);
  }

  for (const Box& box : boxes)
    each_cell(found.spans, box, [&](std::size_t i) { found.spans.widen(i, box.near, box.far); });
  found.part = found.all > 0 ? found.spans.marched() / found.all : 0;
  found.boxes = std::move(boxes);
  return found;
}

bool prove_rest(BoxBounds& bounds, Possible& possible, Spans& found, std::int64_t most,
                double little) {
  const auto is_found = [&](const Box& box) {
    bool all = true;
    each_cell(found, box, [&](std::size_t i) {
      all = all && found.near[i] <= box.near && found.far[i] >= box.far;
    });
    return all;
  };
  std::vector<Box> boxes = possible.boxes;
  std::erase_if(boxes, is_found);
  while (!boxes.empty() && boxes.front().size > 1) {
    std::vector<Box> next = halved(boxes, found.width * found.cell, found.height * found.cell);
    std::erase_if(next, is_found);
    most -= static_cast<std::int64_t>(next.size());
    if (most < 0) break;
    if (!bounds.look(next)) return false;
    possible.asked += static_cast<std::int64_t>(next.size());
    std::erase_if(next, [](const Box& box) { return !may_hold(box); });
    boxes = std::move(next);
  }
  double left = 0;
  for (const Box& box : boxes) left += march(box);
  possible.rest = possible.all > 0 ? left / possible.all : 0;
  if (possible.rest > little) return true;
  for (const Box& box : boxes)
    each_cell(found, box, [&](std::size_t i) { found.widen(i, box.near, box.far); });
  return true;
}

}  // namespace pse::app
