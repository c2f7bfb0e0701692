// Edges through stored pixels: ramps that a program thresholds, against the exact response of the
// kernel to the edge that the ramp is of.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "antialias/fit.h"
#include "exact_share.h"
#include "picture.h"

namespace pse::antialias::test {
namespace {

constexpr double one_step = 1.0 / 255;

using Ramp = std::function<double(double x, double y)>;

struct StoredOptions {
  int width = 32, height = 32, tile = 64, threads = 1, vector_width = 0;
  bool interpret = false;
  Mode mode = Mode::procedural;
  Rect clip{};
};

// The program's picture of stored pixels: `image`, `other` and, where it is given, `id`.
Picture render_stored(const std::string& text, const Ramp& image, const StoredOptions& options = {},
                      const Ramp& other = {}, const Ramp& id = {}) {
  CompileOptions compile;
  compile.lower.stream = image_plane_names();
  compile.lower.stream.push_back({"image", 1, ir::Rate::sample});
  compile.lower.stream.push_back({"other", 1, ir::Rate::sample});
  compile.lower.stream.push_back({"id", 1, ir::Rate::sample});
  compile.interpret = options.interpret;
  compile.codegen.width = options.vector_width;
  SourceMap sources;
  Diagnostics diagnostics;
  auto front =
      compile_front(sources, sources.add("test.pse", text), LowerHost{}, compile, diagnostics);
  if (!front) throw std::runtime_error(print_text(diagnostics, sources, false));
  const auto programs = compile_programs(std::move(*front), compile, options.mode);
  if (!programs) throw std::runtime_error(programs.error());

  const ImagePlane plane{.width = options.width, .height = options.height};
  const Rect all{0, 0, options.width, options.height};
  const Rect window = options.clip.width() > 0 ? options.clip : all;
  const ir::Module& module = programs->shown->module();
  const TileSource coordinates =
      image_plane_source(module, plane, {-2, -2, options.width + 2, options.height + 2});
  const auto source = [&](const TileView& tile) {
    coordinates(tile);
    for (std::size_t i = 0; i < module.inputs.size(); ++i) {
      const std::string& name = module.inputs[i].name;
      const Ramp* ramp = name == "image"   ? &image
                         : name == "other" ? &other
                         : name == "id"    ? &id
                                           : nullptr;
      if (ramp == nullptr) continue;
      float* out = tile.planes[i];
      for (int y = tile.rect.y0; y < tile.rect.y1; ++y)
        for (int x = tile.rect.x0; x < tile.rect.x1; ++x) {
          const bool inside = x >= 0 && y >= 0 && x < options.width && y < options.height;
          // Nothing beyond the picture may be looked at.
          *out++ = inside ? static_cast<float>((*ramp)(x + 0.5, y + 0.5))
                          : std::numeric_limits<float>::quiet_NaN();
        }
    }
  };
  Picture picture{.width = window.width(), .height = window.height()};
  for (std::size_t o = 0; o < programs->outputs; ++o) {
    picture.names.push_back(module.outputs[o].name);
    picture.planes.emplace_back(
        static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height), -99.0f);
  }
  const auto sink = [&](const TileView& tile) {
    for (std::size_t o = 0; o < picture.planes.size(); ++o)
      for (int y = tile.rect.y0; y < tile.rect.y1; ++y)
        for (int x = tile.rect.x0; x < tile.rect.x1; ++x)
          picture.planes[o][static_cast<std::size_t>((y - window.y0) * picture.width + x -
                                                     window.x0)] =
              tile.planes[o][(y - tile.rect.y0) * tile.rect.width() + x - tile.rect.x0];
  };
  const Host host{[&](const Program& program) {
                    FrameState state;
                    set_plane_uniforms(program.module(), plane, state);
                    return state;
                  },
                  [&](const ir::Module& of) { return image_plane_samples(of, plane); }, all};
  RunStatus status;
  picture.result = execute(*programs, host, {.mode = options.mode}, source, sink,
                           {.window = window,
                            .tile_width = options.tile,
                            .tile_height = options.tile,
                            .threads = options.threads,
                            .ordered_sink = true},
                           status, picture.counts);
  return picture;
}

Ramp half_plane(double degrees, double out) {
  const double nx = std::cos(degrees * std::numbers::pi / 180),
               ny = std::sin(degrees * std::numbers::pi / 180);
  return [=](double x, double y) { return 0.5 + 0.1 * ((x - 16) * nx + (y - 16) * ny - out); };
}

const std::string threshold = "if image > 0.5\n    c = 1\nelse\n    c = 0\n";

TEST(Stored, HalfPlanesAtEveryAngleAreExact) {
  for (int step = 0; step < 24; ++step) {
    const double angle = step * 15 + 3.7, out = 0.37 * step - 4;
    const double nx = std::cos(angle * std::numbers::pi / 180),
                 ny = std::sin(angle * std::numbers::pi / 180);
    const Picture picture = render_stored(threshold, half_plane(angle, out), {.interpret = true});
    double worst = 0;
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 32; ++x) {
        const double d = (x + 0.5 - 16) * nx + (y + 0.5 - 16) * ny - out;
        const double exact = Filter().share(static_cast<float>(d), 1, 0);
        worst = std::max(worst, std::abs(picture.at(x, y) - exact));
      }
    EXPECT_LT(worst, one_step / 2) << angle;
    EXPECT_GT(picture.counts.blended, 0);
    EXPECT_EQ(picture.counts.left, 0);
  }
}

TEST(Stored, DiscsOfRampsAreExact) {
  // The fit is exact where the ramp is one of r^2. One of r has a tip, and bends differently at
  // each neighbour: below a radius of 5 pixels that shows.
  for (const double radius : {12.1, 7.3, 4.6, 3.1, 2.2})
    for (const bool squared : {true, false}) {
      if (!squared && radius < 5) continue;
      const double cx = 16.2, cy = 15.7;
      const Ramp ramp = [=](double x, double y) {
        const double r = std::hypot(x - cx, y - cy);
        return squared ? 0.5 + 0.02 * (radius * radius - r * r) : 0.5 + 0.1 * (radius - r);
      };
      const Picture picture = render_stored(threshold, ramp, {.interpret = true});
      double worst = 0;
      for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x)
          worst = std::max(worst,
                           std::abs(picture.at(x, y) -
                                    share_of_disc(std::hypot(x + 0.5 - cx, y + 0.5 - cy), radius)));
      EXPECT_LT(worst, one_step) << radius << (squared ? " of r^2" : " of r");
    }
}

TEST(Stored, BranchesAreRunAtThePixelWithItsOwnValues) {
  // c is 2 image on one side and -image on the other.
  const Picture picture = render_stored("if image > 0.5\n    c = 2 * image\nelse\n    c = -image\n",
                                        half_plane(30, 0.3), {.interpret = true});
  const double nx = std::cos(std::numbers::pi / 6), ny = 0.5;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      const double d = (x + 0.5 - 16) * nx + (y + 0.5 - 16) * ny - 0.3, image = 0.5 + 0.1 * d;
      const double share = Filter().share(static_cast<float>(d), 1, 0);
      EXPECT_NEAR(picture.at(x, y), share * 2 * image + (1 - share) * -image, 0.005);
    }
}

// Two edges that cross: the inner condition is known on one side of the outer only. Their shares
// multiply, as LERP within LERP does.
TEST(Stored, NestedConditionsWithIncompleteNeighbourhoods) {
  const Picture picture = render_stored(
      "if image > 0.5\n    if other > 0.5\n        c = 1\n    else\n        c = 0.25\nelse\n    c "
      "= 0\n",
      half_plane(10, 0.2), {.interpret = true}, half_plane(105, 1.3));
  const auto share = [&](double degrees, double out, int x, int y) {
    const double nx = std::cos(degrees * std::numbers::pi / 180),
                 ny = std::sin(degrees * std::numbers::pi / 180);
    return double(
        Filter().share(static_cast<float>((x + 0.5 - 16) * nx + (y + 0.5 - 16) * ny - out), 1, 0));
  };
  double worst = 0;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      const double outer = share(10, 0.2, x, y), inner = share(105, 1.3, x, y);
      worst = std::max(worst, std::abs(picture.at(x, y) - outer * (inner + (1 - inner) * 0.25)));
    }
  EXPECT_LT(worst, one_step);
  EXPECT_EQ(picture.counts.left, 0);
}

TEST(Stored, StepsAreEdges) {
  const Picture picture =
      render_stored("c = floor(10 * image) / 10\n", half_plane(20, 0.1), {.interpret = true});
  const double nx = std::cos(std::numbers::pi / 9), ny = std::sin(std::numbers::pi / 9);
  for (int y = 2; y < 30; ++y)
    for (int x = 2; x < 30; ++x) {
      const double f = 5 + (x + 0.5 - 16) * nx + (y + 0.5 - 16) * ny - 0.1, level = std::round(f);
      const double share = Filter().share(static_cast<float>(f - level), 1, 0);
      EXPECT_NEAR(picture.at(x, y), (level - 1 + share) / 10, one_step) << x << " " << y;
    }
}

// Many programs; nothing depends on how the picture is cut.
TEST(Stored, TheSameBitsInEveryPiece) {
  const Ramp disc = [](double x, double y) {
    return 0.5 + 0.03 * (9.3 - std::hypot(x - 21.4, y - 17.9));
  };
  const Ramp wave = [](double x, double y) {
    return 0.5 + 0.4 * std::sin(0.3 * x) * std::cos(0.23 * y + 0.1 * x);
  };
  for (const std::string& text :
       {threshold,
        std::string("if image > 0.5\n    if other > 0.6\n        c = x\n    else\n        c = "
                    "other\nelse\n    c = floor(5 * other)\n"),
        std::string("c = 0\nfor i in [1 .. 4]\n    if other > i / 5\n        c += image\n"),
        std::string("n = 0\nt = other\nwhile t < 0.9\n    t += 0.21\n    n += 1\nc = n\n")}) {
    const auto with = [&](StoredOptions options) {
      options.width = 70, options.height = 41;
      return render_stored(text, disc, options, wave);
    };
    const Picture whole = with({.tile = 512});
    for (const int tile : {8, 33})
      EXPECT_EQ(with({.tile = tile, .threads = 2}).planes, whole.planes) << text << tile;
    for (const int width : {1, 4, 8})
      EXPECT_EQ(with({.vector_width = width}).planes, whole.planes) << text;
    EXPECT_EQ(with({.interpret = true}).planes, whole.planes) << text;
    const Picture part = with({.tile = 16, .clip = {11, 7, 40, 30}});
    for (int y = 7; y < 30; ++y)
      for (int x = 11; x < 40; ++x) ASSERT_EQ(part.at(x - 11, y - 7), whole.at(x, y)) << text;
  }
}

// Pixels of different objects are never mixed: each side of the border keeps values of its own.
TEST(Stored, ObjectsAreNotMixed) {
  const Ramp id = [](double x, double) { return x < 16 ? 1.0 : 2.0; };
  const Ramp image = [](double x, double y) { return x < 16 ? 0.1 + 0.01 * y : 0.9 + 0.01 * y; };
  const Picture picture =
      render_stored(threshold + "c += 0 * id\n", image, {.interpret = true}, {}, id);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) EXPECT_EQ(picture.at(x, y), x < 16 ? 0 : 1);
}

TEST(Stored, WhatCannotBeToldIsLeftAndCounted) {
  // Grain: no plane fits.
  const Ramp grain = [](double x, double y) {
    return std::fmod(std::abs(std::sin(12.9 * x + 78.2 * y) * 43758.5), 1);
  };
  const Picture picture = render_stored(threshold, grain, {.interpret = true});
  const Picture none = render_stored(threshold, grain, {.interpret = true, .mode = Mode::none});
  EXPECT_GT(picture.counts.left, 300);
  int same = 0;
  for (std::size_t i = 0; i < picture.plane().size(); ++i)
    same += picture.plane()[i] == none.plane()[i];
  EXPECT_GE(same, picture.counts.left);
  // A branch that cannot be computed where it does not belong leaves the pixel as it is.
  const Picture roots = render_stored("c = 0\nif image > 0.5\n    c = sqrt(image - 0.5)\n",
                                      half_plane(30, 0.3), {.interpret = true});
  for (const float value : roots.plane()) EXPECT_FALSE(std::isnan(value));
}

TEST(Fit, APlaneNeedsOneNeighbourEachWay) {
  FittedEdge edge;
  // Values x / 4 + y / 8 + 0.05 at the right (bit 4) and below (bit 6).
  const std::array<float, 8> values = {0, 0, 0, 0, 0.3f, 0, 0.175f, 0};
  ASSERT_EQ(fit_edge(0.05f, values, 1u << 4 | 1u << 6, Filter(), edge), Fit::edge);
  const double length = std::hypot(0.25, 0.125);
  EXPECT_NEAR(edge.distance, 0.05 / length, 1e-6);
  EXPECT_NEAR(edge.nx, 0.25 / length, 1e-6);
  EXPECT_NEAR(edge.bend, 0, 1e-6);
  EXPECT_EQ(fit_edge(0.05f, values, 1u << 4 | 1u << 3, Filter(), edge), Fit::failed);  // one row
  EXPECT_EQ(fit_edge(0.05f, values, 0, Filter(), edge), Fit::failed);
}

}  // namespace
}  // namespace pse::antialias::test
