// Coordinates of the image plane. Everything is computed in double and rounded once, so that a
// pixel's coordinates are the same whatever tile, window or machine computes it.
#include "stream/image_plane.h"

#include <algorithm>
#include <memory>
#include <string>
#include <string_view>

namespace pse {
namespace {

enum class Coordinate { x, y, u, v, px, py, point_x, point_y, point_z, span_near, span_far };

constexpr std::array<std::string_view, 11> coordinate_names = {
    "x",       "y",       "u",       "v",            "px",         "py",
    "point.0", "point.1", "point.2", "prepass.near", "prepass.far"};

constexpr PlaneTransform no_transform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

// Where no prepass has looked, matter may be anywhere along a ray.
constexpr double anywhere_on_ray = 1e30;

// A coordinate, or its slope from pixel to pixel ("x$x", "point.1$y").
enum class Part { value, slope_x, slope_y };

struct PlaneInput {
  std::size_t input;  // index in Module::inputs
  Coordinate coordinate;
  Part part = Part::value;
};

std::vector<PlaneInput> find_plane_inputs(const ir::Module& module, ir::Rate rate) {
  std::vector<PlaneInput> found;
  for (std::size_t i = 0; i < module.inputs.size(); ++i) {
    if (module.inputs[i].rate != rate) continue;
    std::string_view full = module.inputs[i].name;
    Part part = Part::value;
    if (full.ends_with("$x")) part = Part::slope_x;
    if (full.ends_with("$y")) part = Part::slope_y;
    if (part != Part::value) full.remove_suffix(2);
    const auto name = std::find(coordinate_names.begin(), coordinate_names.end(), full);
    if (name != coordinate_names.end())
      found.push_back({i, static_cast<Coordinate>(name - coordinate_names.begin()), part});
  }
  return found;
}

struct Place {
  double x, y, z;
};

// Place (px, py) of the picture in the plane, before any transform.
Place plane_place(const ImagePlane& plane, double px, double py) {
  return {(2 * px - plane.width) / plane.height, (plane.height - 2 * py) / plane.height, 0};
}

Place transformed(const PlaneTransform& m, const Place& p) {
  const auto row = [&](std::size_t r) {
    return m[4 * r] * p.x + m[4 * r + 1] * p.y + m[4 * r + 2] * p.z + m[4 * r + 3];
  };
  const double w = row(3);
  return {row(0) / w, row(1) / w, row(2) / w};
}

// The coordinate at a place in pixels of the whole picture.
double coordinate_at(const ImagePlane& plane, Coordinate which, double px, double py) {
  switch (which) {
    case Coordinate::u:
      return px / plane.width;
    case Coordinate::v:
      return 1 - py / plane.height;
    case Coordinate::px:
      return px;
    case Coordinate::py:
      return py;
    case Coordinate::span_near:
      return -anywhere_on_ray;
    case Coordinate::span_far:
      return anywhere_on_ray;
    default:
      break;
  }
  Place place = plane_place(plane, px, py);
  if (plane.transform) place = transformed(*plane.transform, place);
  if (which == Coordinate::x || which == Coordinate::point_x) return place.x;
  if (which == Coordinate::y || which == Coordinate::point_y) return place.y;
  return place.z;
}

// What an input holds at a place in pixels of the whole picture.
double input_at(const ImagePlane& plane, const PlaneInput& input, double px, double py) {
  if (input.part == Part::value) return coordinate_at(plane, input.coordinate, px, py);
  const double dx = input.part == Part::slope_x ? 0.5 : 0,
               dy = input.part == Part::slope_y ? 0.5 : 0;
  return coordinate_at(plane, input.coordinate, px + dx, py + dy) -
         coordinate_at(plane, input.coordinate, px - dx, py - dy);
}

// The same at the sample of pixel (column, row).
double input_of(const ImagePlane& plane, const PlaneInput& input, int column, int row) {
  return input_at(plane, input, column + plane.sample_x, row + plane.sample_y);
}

bool varies_along_row(Coordinate which) {
  return which == Coordinate::x || which == Coordinate::u || which == Coordinate::px ||
         which == Coordinate::point_x;
}

// One coordinate's values over the window's columns or rows, where it depends on one of them only.
struct Axis {
  std::size_t input;
  bool along_row;
  std::vector<float> values;
};

Axis make_axis(const ImagePlane& plane, const PlaneInput& input, const Rect& window) {
  Axis axis{input.input, varies_along_row(input.coordinate), {}};
  if (axis.along_row) {
    for (int column = window.x0; column < window.x1; ++column)
      axis.values.push_back(static_cast<float>(input_of(plane, input, column, 0)));
  } else {
    for (int row = window.y0; row < window.y1; ++row)
      axis.values.push_back(static_cast<float>(input_of(plane, input, 0, row)));
  }
  return axis;
}

void fill_axis(const Axis& axis, const Rect& window, const TileView& tile) {
  float* out = tile.planes[axis.input];
  for (int row = tile.rect.y0; row < tile.rect.y1; ++row, out += tile.rect.width()) {
    if (axis.along_row)
      std::copy_n(axis.values.begin() + (tile.rect.x0 - window.x0), tile.rect.width(), out);
    else
      std::fill_n(out, tile.rect.width(), axis.values[static_cast<std::size_t>(row - window.y0)]);
  }
}

void fill_everywhere(const ImagePlane& plane, const PlaneInput& input, const TileView& tile) {
  float* out = tile.planes[input.input];
  for (int row = tile.rect.y0; row < tile.rect.y1; ++row)
    for (int column = tile.rect.x0; column < tile.rect.x1; ++column)
      *out++ = static_cast<float>(input_of(plane, input, column, row));
}

bool is_transformed(Coordinate which) {
  return which == Coordinate::x || which == Coordinate::y ||
         (which >= Coordinate::point_x && which <= Coordinate::point_z);
}

// The plane at any places.
class PlaneSamples : public SampleSource {
 public:
  PlaneSamples(const ir::Module& module, const ImagePlane& plane)
      : plane_(plane), inputs_(find_plane_inputs(module, ir::Rate::sample)) {}

  void fill(std::span<const double> x, std::span<const double> y,
            std::span<float* const> planes) const override {
    for (const PlaneInput& input : inputs_) {
      float* out = planes[input.input];
      if (out == nullptr) continue;
      const auto each = [&](auto&& value) {
        for (std::size_t i = 0; i < x.size(); ++i) out[i] = static_cast<float>(value(i));
      };
      // The usual ones in loops of their own.
      const double w = plane_.width, h = plane_.height, per_w = 1 / w, per_h = 1 / h;
      switch (plane_.transform || input.part != Part::value ? Coordinate::point_z
                                                            : input.coordinate) {
        case Coordinate::u:
          each([&](std::size_t i) { return x[i] * per_w; });
          break;
        case Coordinate::v:
          each([&](std::size_t i) { return 1 - y[i] * per_h; });
          break;
        case Coordinate::x:
        case Coordinate::point_x:
          each([&](std::size_t i) { return (2 * x[i] - w) * per_h; });
          break;
        case Coordinate::y:
        case Coordinate::point_y:
          each([&](std::size_t i) { return (h - 2 * y[i]) * per_h; });
          break;
        default:
          each([&](std::size_t i) { return input_at(plane_, input, x[i], y[i]); });
      }
    }
  }
  bool anywhere() const override { return true; }

 private:
  const ImagePlane plane_;
  const std::vector<PlaneInput> inputs_;
};

}  // namespace

std::optional<PlaneTransform> plane_transform(const std::vector<double>& n) {
  PlaneTransform m = no_transform;
  if (n.size() == 16) {
    std::copy(n.begin(), n.end(), m.begin());
  } else if (n.size() == 9 || n.size() == 6) {
    // Column 2 of a planar matrix is the translation: column 3 of ours.
    for (std::size_t r = 0; r < n.size() / 3; ++r) {
      const std::size_t to = r == 2 ? 3 : r;
      m[4 * to] = n[3 * r], m[4 * to + 1] = n[3 * r + 1], m[4 * to + 3] = n[3 * r + 2];
    }
  } else {
    return std::nullopt;
  }
  return m;
}

std::vector<StreamName> image_plane_names(const std::optional<PlaneTransform>& transform) {
  using enum ir::Rate;
  const bool projective = transform && ((*transform)[12] != 0 || (*transform)[13] != 0);
  const auto even = ir::InputSlopes::of_frame;
  const auto seen = projective ? ir::InputSlopes::of_sample : even;
  return {
      {"x", 1, sample, seen}, {"y", 1, sample, seen},     {"u", 1, sample, even},
      {"v", 1, sample, even}, {"point", 3, sample, seen}, {"px", 1, sample, even},
      {"py", 1, sample, even}, {"frame", 1, frame},      {"time", 1, frame},
      {"fps", 1, frame},    {"width", 1, frame},      {"height", 1, frame},
      {"aspect", 1, frame}, {"pixelsize", 1, frame},  {"pixel_freq", 1, frame},
      {"seed", 1, frame},   {"begin_frame", 1, frame},
      {"prepass.near", 1, sample}, {"prepass.far", 1, sample}, {"prepass.step", 1, frame},
      {"xform", 16, frame}};
}

void set_plane_uniforms(const ir::Module& module, const ImagePlane& plane, FrameState& state) {
  const double pixel_size = 2.0 / plane.height;
  const std::array<std::pair<std::string_view, double>, 11> values = {
      {{"frame", plane.frame},
       {"time", plane.frame / plane.fps},
       {"fps", plane.fps},
       {"width", plane.width},
       {"height", plane.height},
       {"aspect", double(plane.width) / plane.height},
       {"pixelsize", pixel_size},
       {"pixel_freq", 0.5 / pixel_size},
       {"seed", plane.seed},
       {"begin_frame", 1},
       {"prepass.step", 0}}};
  state.uniforms.resize(module.inputs.size());
  for (std::size_t i = 0; i < module.inputs.size(); ++i) {
    if (module.inputs[i].rate == ir::Rate::sample) continue;
    for (const auto& [name, value] : values)
      if (module.inputs[i].name == name) state.uniforms[i] = static_cast<float>(value);
  }
  const PlaneTransform xform = plane.transform.value_or(no_transform);
  for (std::size_t k = 0; k < xform.size(); ++k)
    for (std::size_t i = 0; i < module.inputs.size(); ++i)
      if (module.inputs[i].name == "xform." + std::to_string(k))
        state.uniforms[i] = static_cast<float>(xform[k]);
  // Slopes that are the same everywhere.
  for (const PlaneInput& input : find_plane_inputs(module, ir::Rate::frame))
    if (input.part != Part::value)
      state.uniforms[input.input] = static_cast<float>(input_at(plane, input, 0.5, 0.5));
}

TileSource image_plane_source(const ir::Module& module, const ImagePlane& plane,
                              const Rect& window) {
  // Tabulate what depends on the column or on the row alone; a transform mixes the two.
  struct Tables {
    std::vector<Axis> axes;
    std::vector<PlaneInput> others;
  };
  auto tables = std::make_shared<Tables>();
  for (const PlaneInput& input : find_plane_inputs(module, ir::Rate::sample)) {
    if (input.part != Part::value || (plane.transform && is_transformed(input.coordinate)))
      tables->others.push_back(input);
    else
      tables->axes.push_back(make_axis(plane, input, window));
  }
  return [tables = std::shared_ptr<const Tables>(tables), plane, window](const TileView& tile) {
    for (const Axis& axis : tables->axes) fill_axis(axis, window, tile);
    for (const PlaneInput& input : tables->others) fill_everywhere(plane, input, tile);
  };
}

std::unique_ptr<SampleSource> image_plane_samples(const ir::Module& module,
                                                  const ImagePlane& plane) {
  return std::make_unique<PlaneSamples>(module, plane);
}

InputChanges image_plane_changes(const std::optional<PlaneTransform>& transform) {
  using enum Change;
  // Without perspective a transform moves every point by a sum of even amounts.
  const bool is_flat = !transform || ((*transform)[12] == 0 && (*transform)[13] == 0 &&
                                      (*transform)[14] == 0);
  return [is_flat, is_moved = transform.has_value()](std::string_view name) -> Changes {
    const auto found = std::find(coordinate_names.begin(), coordinate_names.end(), name);
    if (found == coordinate_names.end()) return {};
    const auto which = static_cast<Coordinate>(found - coordinate_names.begin());
    if (which >= Coordinate::span_near) return {none, none};
    if (is_moved && is_transformed(which)) return is_flat ? Changes{even, even} : Changes{};
    if (which == Coordinate::point_z) return {none, none};
    return varies_along_row(which) ? Changes{even, none} : Changes{none, even};
  };
}

}  // namespace pse
