// How the executor and the command line do: threads, edit to picture, start-up, the memory of a
// huge picture. Each result is checked before it is timed; the table gives the median and, behind
// it, the fastest and slowest run. usage: bench_stream [RUNS] [--large]      --large adds 16384 x
// 16384 pixels through files (minutes, 4 GiB on disk)
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>

#include "programs.h"
#include "stream/executor.h"
#include "stream/image_plane.h"

namespace {

using namespace pse;

int failures = 0;

void check(bool good, const char* what) {
  if (good) return;
  std::printf("WRONG: %s\n", what);
  ++failures;
}

struct Times {
  std::vector<double> seconds;
  double median() {
    std::sort(seconds.begin(), seconds.end());
    return seconds[seconds.size() / 2];
  }
};

Times repeat(int runs, const std::function<double()>& run) {
  Times times;
  for (int i = 0; i < runs; ++i) times.seconds.push_back(run());
  return times;
}

void row(const char* name, Times times, double unit, const char* unit_name, const char* goal) {
  const double median = times.median();
  std::printf("%-44s %9.2f %-4s [%.2f .. %.2f]   %s\n", name, median / unit, unit_name,
              times.seconds.front() / unit, times.seconds.back() / unit, goal);
}

std::string read_file(const std::filesystem::path& path) {
  std::ifstream stream(path);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

std::shared_ptr<const Program> compile_text(const std::string& text,
                                            Tier tier = Tier::optimised) {
  SourceMap sources;
  Diagnostics diagnostics;
  CompileOptions options;
  options.lower.stream = image_plane_names();
  options.lower.outputs = {"color"};
  options.tier = tier;
  const FileId file = sources.add("<bench>", text);
  auto program = compile(sources, file, {}, options, diagnostics);
  if (!program) {
    std::printf("%s", print_text(diagnostics, sources, false).c_str());
    std::exit(1);
  }
  return program;
}

// One picture into memory; the seconds in the executor.
double render(const Program& program, int size, int threads, std::vector<float>& picture) {
  const Rect window{0, 0, size, size};
  const ImagePlane plane{.width = size, .height = size};
  FrameState state;
  set_plane_uniforms(program.module(), plane, state);
  for (const Knob& knob : program.knobs)
    for (std::size_t c = 0; c < knob.value.size(); ++c)
      for (std::size_t i = 0; i < program.module().inputs.size(); ++i)
        if (program.module().inputs[i].name ==
            (knob.value.size() == 1 ? knob.name : knob.name + "." + std::to_string(c)))
          state.uniforms[i] = knob.value[c];
  picture.resize(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
  const auto sink = [&](const TileView& tile) {
    for (int y = tile.rect.y0; y < tile.rect.y1; ++y)
      std::copy_n(tile.planes[0] + std::ptrdiff_t{y - tile.rect.y0} * tile.rect.width(),
                  tile.rect.width(), picture.begin() + std::ptrdiff_t{y} * size + tile.rect.x0);
  };
  RunStatus status;
  const RunResult result =
      execute(program, state, image_plane_source(program.module(), plane, window), sink,
              {.window = window, .threads = threads}, status);
  check(result.end == RunEnd::finished, "a picture is finished");
  return result.seconds;
}

bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

void bench_threads(const std::string& text, int runs) {
  const auto program = compile_text(text);
  std::vector<float> one, two;
  render(*program, 1024, 1, one);
  render(*program, 1024, 2, two);
  check(same_bits(one, two), "two threads compute the same bits as one");
  // Runs take turns, so that what else the machine does falls on both.
  Times single, pair, ratio;
  for (int i = 0; i < runs; ++i) {
    single.seconds.push_back(render(*program, 1024, 1, one));
    pair.seconds.push_back(render(*program, 1024, 2, two));
    ratio.seconds.push_back(single.seconds.back() / pair.seconds.back());
  }
  row("marble 1024x1024, one thread", single, 1e-3, "ms", "");
  row("marble 1024x1024, two threads", pair, 1e-3, "ms", "");
  row("two threads over one", ratio, 1, "x", ">= 1.9");
}

void bench_edit(const std::string& text, int runs) {
  int edit = 0;
  std::vector<float> picture, before;
  const Times times = repeat(runs, [&] {
    const auto start = std::chrono::steady_clock::now();
    // Every edit changes a constant of the picture, so nothing can come from a cache.
    const auto program = compile_text(
        text + "\ncolor = color * " + std::to_string(++edit) + "\n", Tier::automatic);
    render(*program, 512, 0, picture);
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    check(!same_bits(picture, before), "an edit changes the picture");
    before = picture;
    return seconds;
  });
  row("edit to picture, marble 512x512", times, 1e-3, "ms", "<= 100");
}

void bench_start(int runs) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "pse_bench_stream";
  std::filesystem::create_directories(folder);
  const std::string marble = PSE_GALLERY "/2d/marble/marble.pse",
                    picture = (folder / "marble.png").string();
  const auto timed = [&](const char* name, const std::vector<std::string>& words,
                         const char* goal) {
    const Times times = repeat(runs, [&] {
      const bench::Measured measured = bench::run_pse(words);
      check(measured.status == 0, name);
      return measured.seconds;
    });
    row(name, times, 1e-3, "ms", goal);
  };
  timed("pse --version", {"--version"}, "<= 50");
  timed("pse check marble.pse", {"check", marble}, "<= 50");
  timed("pse render marble.pse, 64x64, warm", {"render", marble, "-o", picture, "--res", "64x64"},
        "<= 150");
  timed("pse render marble.pse, 512x512 PNG, warm", {"render", marble, "-o", picture}, "");
  timed("pse render marble.pse, 512x512 PNG, cold", {"render", marble, "-o", picture, "--no-cache"},
        "");
  std::filesystem::remove_all(folder);
}

// 16384 x 16384 pixels: what is resident at most, and the time for the record. The EXR goes through
// a compositing program, from its file and as standard input would bring it (which cannot seek).
void bench_large() {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "pse_bench_stream";
  std::filesystem::create_directories(folder);
  const auto path = [&](const char* name) { return (folder / name).string(); };
  std::ofstream(path("flat.pse")) << "t = Noise(40 * point)\ncolor = [t u v]\nalpha = 1\n";
  std::ofstream(path("over.pse")) << "color = color * 0.5 + [0 0 0.5] * alpha\n";
  const auto row = [&](const char* name, std::vector<std::string> words) {
    const bench::Measured measured = bench::run_pse(words);
    check(measured.status == 0, name);
    check(measured.peak_mebibytes <= 512, "a large picture stays below 512 MiB");
    std::printf("%-44s %9.1f MiB resident in %.0f s   <= 512\n", name, measured.peak_mebibytes,
                measured.seconds);
    std::fflush(stdout);
  };
  const std::vector<std::string> size = {"--res", "16384x16384", "--layers", "color,alpha"};
  const auto with = [](std::vector<std::string> words, const std::vector<std::string>& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  row("16384x16384, four channels, to EXR",
      with({"render", path("flat.pse"), "-o", path("large.exr")}, size));
  row("that EXR through a program, to EXR",
      {"render", path("over.pse"), path("large.exr"), "-o", path("over.exr")});
  std::filesystem::remove(path("over.exr"));
  row("two such EXRs, to PNG", {"render", path("over.pse"), path("large.exr"),
                                "fg=" + path("large.exr"), "-o", path("over.png")});
  std::filesystem::remove(path("over.png"));
  row("four channels, to PNG", with({"render", path("flat.pse"), "-o", path("large.png")}, size));
  row("that PNG through a program, to PNG",
      {"render", path("over.pse"), path("large.png"), "-o", path("over.png")});
  std::filesystem::remove(path("over.png"));
  row("marble, to EXR", {"render", PSE_GALLERY "/2d/marble/marble.pse", "-o", path("marble.exr"),
                         "--res", "16384x16384"});
  std::filesystem::remove_all(folder);
}

}  // namespace

int main(int argc, char** argv) {
  int runs = 9;
  bool large = false;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--large") == 0)
      large = true;
    else
      runs = std::max(1, std::atoi(argv[i]));
  }
  const std::string marble = read_file(PSE_GALLERY "/2d/marble/marble.pse");
  std::printf("%-44s %14s [fastest .. slowest of %d]   goal\n", "", "median", runs);
  bench_threads(marble, runs);
  bench_edit(marble, runs);
  bench_start(runs);
  if (large) bench_large();
  return failures == 0 ? 0 : 1;
}
