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
                     const std::vector<Knob>& knobs,
                     const std::vector<ExternalFunction>& externals, int threads,
                     RunStatus& status)
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
    return std::span(boxes).subspan(static_cast<std::size_t>(number * batch),
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

// Whether the spans have all of it.
bool is_known(const Spans& spans, const Box& box) {
  bool known = true;
  each_cell(spans, box, [&](std::size_t i) {
    known = known && spans.near[i] <= box.near && spans.far[i] >= box.far;
  });
  return known;
}

}  // namespace

bool add_possible(BoxBounds& bounds, int width, int height, std::int64_t most, Spans& spans,
                  ProofReport& report) {
  int size = spans.cell;
  while (size < largest_block) size *= 2;

  // What each block marches through, and that in pieces about as long as the block is wide, for a
  // box as deep as the picture is high.
  std::vector<Box> boxes;
  for (int y = 0; y < height; y += size)
    for (int x = 0; x < width; x += size) boxes.push_back({x, y, size});
  if (!bounds.look(boxes)) return false;
  report.boxes += static_cast<std::int64_t>(boxes.size());
  const int pieces = std::max(1, height / size);
  std::vector<Box> next;
  double all = 0, empty = 0;  // volume, in cells
  const auto volume = [&](const Box& box) {
    return double(box.size) * box.size * (double(box.far) - box.near);
  };
  for (const Box& box : boxes) {
    if (!(box.near < box.far)) continue;
    all += volume(box);
    if (box.greatest <= 0) {
      empty += volume(box);
      continue;
    }
    for (int k = 0; k < pieces; ++k) {
      Box piece{box.x, box.y, box.size};
      piece.near = std::lerp(box.near, box.far, float(k) / float(pieces));
      piece.far = std::lerp(box.near, box.far, float(k + 1) / float(pieces));
      next.push_back(piece);
    }
  }

  std::vector<Box> possible;
  for (;;) {
    std::erase_if(next, [&](const Box& box) { return is_known(spans, box); });
    boxes = std::move(next);
    next.clear();
    if (boxes.empty()) break;
    if (report.boxes + static_cast<std::int64_t>(boxes.size()) > most) return true;
    const std::vector<Box> asked = boxes;
    if (!bounds.look(boxes)) return false;
    report.boxes += static_cast<std::int64_t>(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const Box &box = boxes[i], &whole = asked[i];
      if (box.greatest <= 0 || !(box.near <= box.far)) {
        empty += volume(whole);
      } else if (box.least > 0 || box.size <= spans.cell) {
        possible.push_back(box);
      } else {
        const int half = box.size / 2;
        const float middle = box.near + (box.far - box.near) / 2;
        for (int part = 0; part < 8; ++part) {
          Box piece{box.x + (part & 1) * half, box.y + (part >> 1 & 1) * half, half};
          if (piece.x >= width || piece.y >= height) continue;
          piece.near = part < 4 ? box.near : middle;
          piece.far = part < 4 ? middle : box.far;
          next.push_back(piece);
        }
      }
    }
  }
  for (const Box& box : possible)
    each_cell(spans, box, [&](std::size_t i) { spans.widen(i, box.near, box.far); });
  report.proven = all > 0 ? empty / all : 1;
  report.complete = true;
  return true;
}

}  // namespace pse::app
