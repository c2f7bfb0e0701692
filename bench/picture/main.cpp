// What antialiasing costs and what it is worth: for each program the CPU time per pixel without it,
// with procedural antialiasing and with 16 samples everywhere; how far each picture is from that of
// 256 samples with the same kernel; and the shares of pixels that were blended and supersampled.
//
//   bench_picture [--size N] [--runs N] [--threads N] [--pictures FOLDER] [PROGRAM...]
//
// --profile N only computes the procedural picture N times, for a profiler. Without programs: those
// of gallery/2002/antialiasing. Before it reports a time it checks that the procedural picture is
// the same in tiles of another size. --pictures also writes for each program a row of five enlarged
// pieces: none, procedural, 16, 256 samples, and eight times the difference of the second from the
// fourth.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "antialias/antialias.h"
#include "image/writer.h"
#include "stream/image_plane.h"

namespace {

using namespace pse;
namespace fs = std::filesystem;

struct Settings {
  int size = 512, runs = 5, threads = 1, profile = 0;
  fs::path pictures;
  std::vector<fs::path> programs;
};

struct Picture {
  std::array<std::vector<float>, 3> planes;
  antialias::Counts counts;
  double seconds = 0;
};

// Of all threads of this process: what a run costs, whatever else the machine does.
double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

antialias::Programs compile(const fs::path& file, antialias::Mode mode) {
  std::ifstream stream(file);
  std::stringstream text;
  text << stream.rdbuf();
  CompileOptions options;
  options.lower.stream = image_plane_names();
  options.lower.outputs = {"color"};
  SourceMap sources;
  Diagnostics diagnostics;
  auto front = compile_front(sources, sources.add(file.string(), text.str()), LowerHost{}, options,
                             diagnostics);
  if (!front) throw std::runtime_error(print_text(diagnostics, sources, false));
  auto programs = antialias::compile_programs(std::move(*front), options, mode,
                                              image_plane_changes(std::nullopt));
  if (!programs) throw std::runtime_error(programs.error());
  if (programs->edges.valid()) programs->edges.wait();  // not part of a picture's time
  return *programs;
}

Picture render(const antialias::Programs& programs, const Settings& settings, int samples,
               int tile = 64) {
  const int size = settings.size;
  const ImagePlane plane{.width = size, .height = size};
  Picture picture;
  for (auto& values : picture.planes)
    values.resize(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
  const antialias::Options options{
      .mode = samples > 0 ? antialias::Mode::supersample : antialias::Mode::procedural,
      .samples = samples > 0 ? samples : antialias::Options().samples};
  const antialias::Host host{
      [&](const Program& program) {
        FrameState state;
        set_plane_uniforms(program.module(), plane, state);
        for (const Knob& knob : program.knobs)
          for (std::size_t c = 0; c < knob.value.size(); ++c)
            for (std::size_t i = 0; i < program.module().inputs.size(); ++i)
              if (program.module().inputs[i].name ==
                  (knob.value.size() == 1 ? knob.name : fmt::format("{}.{}", knob.name, c)))
                state.uniforms[i] = knob.value[c];
        return state;
      },
      [&](const ir::Module& module) { return image_plane_samples(module, plane); }};
  const auto sink = [&](const TileView& view) {
    for (std::size_t c = 0; c < 3; ++c)
      for (int y = view.rect.y0; y < view.rect.y1; ++y)
        std::copy_n(view.planes[c] + (y - view.rect.y0) * view.rect.width(), view.rect.width(),
                    picture.planes[c].begin() + y * size + view.rect.x0);
  };
  RunStatus status;
  const double start = cpu_seconds();
  antialias::execute(
      programs, host, options,
      image_plane_source(programs.shown->module(), plane, {-2, -2, size + 2, size + 2}), sink,
      {.window = {0, 0, size, size},
       .tile_width = tile,
       .tile_height = tile,
       .threads = settings.threads},
      status, picture.counts);
  picture.seconds = cpu_seconds() - start;
  return picture;
}

double error(const Picture& a, const Picture& b) {
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < a.planes[c].size(); ++i) {
      const double apart = double(a.planes[c][i]) - b.planes[c][i];
      sum += apart * apart;
    }
  return std::sqrt(sum / (3.0 * static_cast<double>(a.planes[0].size())));
}

// Median and spread (half the distance of the quartiles, relative) of times.
struct Timing {
  double median, spread;
};
Timing timing(std::vector<double> times) {
  std::ranges::sort(times);
  const double median = times[times.size() / 2];
  return {median, (times[times.size() * 3 / 4] - times[times.size() / 4]) / 2 / median};
}

// The piece of the picture where the plain one is farthest from the truth.
std::pair<int, int> busiest(const Picture& plain, const Picture& truth, int size, int piece) {
  std::pair<int, int> best{0, 0};
  double most = -1;
  for (int y = 0; y + piece <= size; y += piece / 2)
    for (int x = 0; x + piece <= size; x += piece / 2) {
      double sum = 0;
      for (int j = y; j < y + piece; ++j)
        for (int i = x; i < x + piece; ++i) {
          const auto at = static_cast<std::size_t>(j * size + i);
          sum += std::abs(plain.planes[1][at] - truth.planes[1][at]);
        }
      if (sum > most) most = sum, best = {x, y};
    }
  return best;
}

void write_row(const fs::path& file, const std::array<Picture, 4>& pictures, int size) {
  constexpr int piece = 48, zoom = 6, gap = 8;
  const auto [x0, y0] = busiest(pictures[0], pictures[3], size, piece);
  const int width = 5 * piece * zoom + 4 * gap, height = piece * zoom;
  image::ImageSpec spec;
  spec.display = spec.data = {0, 0, width, height};
  for (const char* name : {"R", "G", "B"}) spec.channels.push_back({name});
  image::Image sheet(spec);
  for (int panel = 0; panel < 5; ++panel)
    for (int c = 0; c < 3; ++c)
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < piece * zoom; ++x) {
          const auto at = static_cast<std::size_t>((y0 + y / zoom) * size + x0 + x / zoom);
          const auto plane = static_cast<std::size_t>(c);
          const float value =
              panel < 4
                  ? pictures[static_cast<std::size_t>(panel)].planes[plane][at]
                  : 8 * std::abs(pictures[1].planes[plane][at] - pictures[3].planes[plane][at]);
          sheet.pixel(c, panel * (piece * zoom + gap) + x, y) = value;
        }
  if (const auto written = image::write_image(file.string(), sheet); !written)
    throw std::runtime_error(written.error().message);
}

Settings read(int count, char** words) {
  Settings settings;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    const auto value = [&] { return std::string(i + 1 < count ? words[++i] : "0"); };
    if (word == "--size")
      settings.size = std::atoi(value().c_str());
    else if (word == "--runs")
      settings.runs = std::max(1, std::atoi(value().c_str()));
    else if (word == "--threads")
      settings.threads = std::atoi(value().c_str());
    else if (word == "--profile")
      settings.profile = std::atoi(value().c_str());
    else if (word == "--pictures")
      settings.pictures = value();
    else
      settings.programs.emplace_back(word);
  }
  if (settings.programs.empty())
    for (const auto& entry : fs::directory_iterator(PSE_GALLERY "/2002/antialiasing"))
      if (entry.path().extension() == ".pse") settings.programs.push_back(entry.path());
  std::ranges::sort(settings.programs);
  return settings;
}

// One line of the table; the ratio of procedural to plain.
double measure(const fs::path& file, const Settings& settings) {
  const antialias::Programs plain = compile(file, antialias::Mode::none);
  const antialias::Programs programs = compile(file, antialias::Mode::procedural);
  for (int run = 0; run < settings.profile; ++run) render(programs, settings, 0);
  if (settings.profile > 0) return 0;
  std::array<Picture, 4> pictures = {render(plain, settings, 1), render(programs, settings, 0),
                                     render(plain, settings, 16), render(plain, settings, 256)};
  pictures[0] = render(plain, settings, 0);  // no paths: the plain picture
  if (render(programs, settings, 0, 33).planes != pictures[1].planes)
    throw std::runtime_error(file.string() + ": another picture in tiles of 33");

  std::array<std::vector<double>, 3> times;
  for (int run = 0; run < settings.runs; ++run) {
    times[0].push_back(render(plain, settings, 0).seconds);
    times[1].push_back(render(programs, settings, 0).seconds);
    times[2].push_back(render(plain, settings, 16).seconds);
  }
  const double pixels = double(settings.size) * settings.size;
  const Timing none = timing(times[0]), ours = timing(times[1]), many = timing(times[2]);
  const auto& counts = pictures[1].counts;
  fmt::print(
      "{:<14} {:7.1f} {:7.1f} {:8.1f} {:6.2f} {:4.0f}% {:6.1f} {:9.5f} {:9.5f} {:9.5f} "
      "{:6.2f}% {:6.2f}%\n",
      file.stem().string(), none.median / pixels * 1e9, ours.median / pixels * 1e9,
      many.median / pixels * 1e9, ours.median / none.median,
      100 * std::hypot(none.spread, ours.spread), many.median / none.median,
      error(pictures[0], pictures[3]), error(pictures[1], pictures[3]),
      error(pictures[2], pictures[3]), 100 * double(counts.blended) / pixels,
      100 * double(counts.supersampled) / pixels);
  if (!settings.pictures.empty()) {
    fs::create_directories(settings.pictures);
    write_row(settings.pictures / (file.stem().string() + "_compared.png"), pictures,
              settings.size);
  }
  return ours.median / none.median;
}

}  // namespace

int main(int count, char** words) try {
  const Settings settings = read(count, words);
  fmt::print("{}x{}, {} thread{}; ns per pixel; error: root mean square from 256 samples\n\n",
             settings.size, settings.size, settings.threads, settings.threads == 1 ? "" : "s");
  fmt::print("{:<14} {:>7} {:>7} {:>8} {:>12} {:>6} {:>9} {:>9} {:>9} {:>7} {:>7}\n", "program",
             "plain", "ours", "16x", "ours/plain", "16x/", "err plain", "err ours", "err 16x",
             "blended", "sampled");
  std::vector<double> ratios;
  for (const fs::path& file : settings.programs) ratios.push_back(measure(file, settings));
  std::ranges::sort(ratios);
  if (!ratios.empty()) fmt::print("\nmedian of ours/plain: {:.2f}\n", ratios[ratios.size() / 2]);
  return 0;
} catch (const std::exception& problem) {
  fmt::print(stderr, "{}\n", problem.what());
  return 1;
}
