// Small pictures from programs' texts, for tests of antialiasing.
#pragma once

#include <gtest/gtest.h>

#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "antialias/antialias.h"
#include "stream/image_plane.h"

namespace pse::antialias::test {

struct PictureOptions {
  int width = 32, height = 32;
  int tile = 64, threads = 1;
  int vector_width = 0;
  bool interpret = false;
  Options antialias;
  Rect clip{};           // empty: all
  bool reports = false;  // keep the program's expectations, and note where they fail
  bool optimize = true;
  passes::OutlineOptions outline;
};

struct Picture {
  int width = 0, height = 0;
  std::vector<std::string> names;
  std::vector<std::vector<float>> planes;  // one per output
  Counts counts;
  RunResult result;
  int width_run = 0;
  std::set<std::pair<float, float>> noted;  // places where an expectation fails

  const std::vector<float>& plane(const std::string& name = "c") const {
    for (std::size_t i = 0; i < names.size(); ++i)
      if (names[i] == name) return planes[i];
    ADD_FAILURE() << "no output " << name;
    return planes.front();
  }
  float at(int x, int y, const std::string& name = "c") const {
    return plane(name)[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                       static_cast<std::size_t>(x)];
  }
};

inline CompiledFront lowered(const std::string& text) {
  CompileOptions options;
  options.lower.stream = image_plane_names();
  SourceMap sources;
  Diagnostics diagnostics;
  auto front =
      compile_front(sources, sources.add("test.pse", text), LowerHost{}, options, diagnostics);
  if (!front) throw std::runtime_error(print_text(diagnostics, sources, false));
  return std::move(*front);
}

// What a host does with expectations: notes px and py.
struct Notes {
  std::mutex mutex;
  std::set<std::pair<float, float>>* places = nullptr;

  static void call(void* self, std::int64_t count, const float* const* arguments, float* const*) {
    auto& notes = *static_cast<Notes*>(self);
    const std::lock_guard lock(notes.mutex);
    for (std::int64_t i = 0; i < count; ++i)
      notes.places->emplace(arguments[0][i], arguments[1][i]);
  }
};

inline Programs compiled(const std::string& text, const PictureOptions& options = {}) {
  CompileOptions compile;
  compile.interpret = options.interpret;
  compile.codegen.width = options.vector_width;
  compile.optimize = options.optimize;
  compile.outline = options.outline;
  const auto programs = compile_programs(
      lowered(text), compile, options.antialias.mode, image_plane_changes(std::nullopt),
      options.antialias.filter, options.reports ? Expectations::reported : Expectations::dropped);
  if (!programs) throw std::runtime_error(programs.error());
  return *programs;
}

inline Picture render(const Programs& programs, const PictureOptions& options = {}) {
  const ImagePlane plane{.width = options.width, .height = options.height};
  const Rect window =
      options.clip.width() > 0 ? options.clip : Rect{0, 0, options.width, options.height};
  Picture picture{.width = window.width(), .height = window.height()};
  const ir::Module& module = programs.shown->module();
  for (std::size_t o = 0; o < programs.outputs; ++o) {
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
  Notes notes{.places = &picture.noted};
  const Host host{
      [&](const Program& program) {
        FrameState state;
        set_plane_uniforms(program.module(), plane, state);
        state.externals.assign(program.module().externals.size(), {&Notes::call, &notes});
        return state;
      },
      [&](const ir::Module& of) { return image_plane_samples(of, plane); }};
  RunStatus status;
  const TileSource source = image_plane_source(
      module, plane, {window.x0 - 2, window.y0 - 2, window.x1 + 2, window.y1 + 2});
  picture.result = execute(programs, host, options.antialias, source, sink,
                           {.window = window,
                            .tile_width = options.tile,
                            .tile_height = options.tile,
                            .threads = options.threads,
                            .ordered_sink = true},
                           status, picture.counts);
  return picture;
}

inline Picture render(const std::string& text, const PictureOptions& options = {}) {
  return render(compiled(text, options), options);
}

inline Options plain() { return {.mode = Mode::none}; }
inline Options samples(int count, FilterKind kind = FilterKind::cubic) {
  return {.mode = Mode::supersample, .samples = count, .filter = Filter(kind)};
}
inline Options procedural(FilterKind kind = FilterKind::cubic) {
  return {.mode = Mode::procedural, .samples = 64, .filter = Filter(kind)};
}

// The same bits in tiles of other sizes, by more threads, in other widths, interpreted, and where a
// part of the picture is drawn alone.
inline void expect_same_bits(const std::string& program) {
  PictureOptions options{.width = 75, .height = 41, .tile = 512, .antialias = procedural()};
  const Picture first = render(program, options);
  for (const int tile : {8, 33, 64}) {
    options.tile = tile, options.threads = tile == 33 ? 3 : 1;
    EXPECT_EQ(render(program, options).planes, first.planes) << program << tile;
  }
  for (const int width : {1, 4, 16}) {
    options.vector_width = width;
    EXPECT_EQ(render(program, options).planes, first.planes) << program << width;
  }
  options.interpret = true;
  EXPECT_EQ(render(program, options).planes, first.planes) << program;
  options.clip = {20, 10, 50, 30};
  const Picture part = render(program, options);
  for (int y = 10; y < 30; ++y)
    for (int x = 20; x < 50; ++x) EXPECT_EQ(part.at(x - 20, y - 10), first.at(x, y)) << program;
}

}  // namespace pse::antialias::test
