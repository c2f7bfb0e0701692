// bench_kernel [rounds]: checks what every kernel computes, then prints how fast it is.
// One thread. In each round everything runs once, so that whatever disturbs the machine disturbs
// all; times are of the thread, not of the clock on the wall. "limit" is the best of the
// hand-written loops that run here; ratios are medians over rounds.
#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "codegen/kernel.h"
#include "codegen/target.h"
#include "hand_noise.h"
#include "pictures.h"
#include "scenes.h"

namespace pse::bench {
namespace {

constexpr std::int64_t samples = 4096;
// Planes are padded so that their addresses differ modulo 4096.
constexpr std::size_t plane = samples + 48;

double now() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Points {
  std::vector<float> memory = std::vector<float>(8 * plane);
  float* in(std::size_t i) { return memory.data() + i * plane; }
  float* out(std::size_t i) { return memory.data() + (3 + i) * plane; }

  // Scattered points in a box of 32 cells.
  Points() {
    std::uint32_t state = 1;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::int64_t s = 0; s < samples; ++s) {
        state = state * 1664525u + 1013904223u;
        in(i)[s] = static_cast<float>(state >> 8) * 0x1p-19f - 16.0f;
      }
    }
  }
};

struct Row {
  std::string name;
  double noises = 1;
  int repeat = 1;
  std::int64_t count = samples;
  double compile_ms = 0;
  std::function<void()> run;
  std::vector<double> ns;  // per sample, one for each round
};

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

std::unique_ptr<Kernel> compiled(const Scene& scene, int width, const std::string& cpu,
                                 double& ms) {
  CodegenOptions options;
  options.width = width;
  options.cpu = cpu;
  CodegenStats stats;
  auto kernel = compile_kernel(scene.split, options, &stats);
  if (!kernel) {
    std::fprintf(stderr, "%s: %s\n", scene.name.c_str(), kernel.error().c_str());
    std::exit(1);
  }
  ms = stats.seconds * 1000;
  return std::move(*kernel);
}

void check(const std::string& name, const Scene& scene, Points& points) {
  for (std::int64_t s = 0; s < samples; ++s) {
    const float expected = scene.expected(points.in(0)[s], points.in(1)[s], points.in(2)[s]);
    // Large values have the same bits.
    const float found = points.out(0)[s];
    if (found == expected || std::fabs(found - expected) <= 4e-6f) continue;
    std::fprintf(stderr, "%s: sample %d is %.9g, not %.9g\n", name.c_str(), static_cast<int>(s),
                 found, expected);
    std::exit(1);
  }
}

void print(const std::vector<Row>& rows, const std::vector<double>& limit) {
  std::printf("%-46s %8s %8s %8s %8s %9s %8s\n", "", "ns", "+-%", "M/s", "noise/s", "of limit",
              "compile");
  for (const Row& row : rows) {
    const double middle = median(row.ns);
    std::vector<double> sorted = row.ns, ratios;
    std::ranges::sort(sorted);
    for (std::size_t i = 0; i < row.ns.size() && i < limit.size(); ++i)
      ratios.push_back(limit[i] * row.noises / row.ns[i]);
    const double spread = 50 * (sorted[sorted.size() * 3 / 4] - sorted[sorted.size() / 4]) / middle;
    std::printf("%-46s %8.3f %8.1f %8.1f %8.1f %9.3f %8.1f\n", row.name.c_str(), middle, spread,
                1e3 / middle, 1e3 * row.noises / middle, ratios.empty() ? 0.0 : median(ratios),
                row.compile_ms);
  }
}

int run(int rounds) {
  Points points;
  std::vector<Scene> scenes = noise_scenes();
  std::vector<Row> rows;
  // The hand-written loops come first.
  using Loop = void (*)(const float*, const float*, const float*, float*, std::int64_t);
  std::size_t limits = 0;
  const auto add_by_hand = [&](const std::string& name, Loop loop) {
    rows.push_back({name,
                    1,
                    8,
                    samples,
                    0,
                    [&points, loop] {
                      loop(points.in(0), points.in(1), points.in(2), points.out(0), samples);
                    },
                    {}});
    rows.back().run();
    check(name, scenes[0], points);
    ++limits;
  };
  if (hand_noise_runs_here()) {
    add_by_hand("noise 3-D by hand, AVX-512", hand_noise);
    add_by_hand("noise 3-D by hand, AVX-512, two at a time", hand_noise_twice);
  }
  if (hand_noise_avx2_runs_here()) {
    add_by_hand("noise 3-D by hand, AVX2", hand_noise_avx2);
    add_by_hand("noise 3-D by hand, AVX2, two at a time", hand_noise_avx2_twice);
  }
  std::vector<std::unique_ptr<Kernel>> kernels;
  for (const Scene& scene : scenes) {
    const auto add = [&](int width, const Target& target) {
      Row row;
      const std::string cpu(target.name);
      kernels.push_back(compiled(scene, width, cpu, row.compile_ms));
      row.name = scene.name + ", " + cpu.substr(7) + " x" + std::to_string(width);
      row.noises = scene.noises;
      row.repeat = scene.noises > 1 ? 2 : 8;
      row.run = [&points, outputs = scene.split.module.outputs.size(),
                 kernel = kernels.back().get()] {
        FrameState state;
        state.uniforms.resize(3);
        RunStatus status;
        Scratch scratch;
        const float* in[] = {points.in(0), points.in(1), points.in(2)};
        float* out[5];
        for (std::size_t i = 0; i < outputs; ++i) out[i] = points.out(i);
        kernel->run_samples(state, status, scratch, in, out, samples);
      };
      row.run();
      check(row.name, scene, points);
      rows.push_back(std::move(row));
    };
    for (const Target& target : targets) {
      if (!host_target() || &target > host_target()) continue;
      // The levels between are shown once.
      if (&scene != scenes.data() && !target.vbmi && (!target.avx2 || target.avx512)) continue;
      add(target.width, target);
      if (target.vbmi) add(32, target);
    }
  }
  // Noises per pixel: hyper's is what DESIGN.md counts.
  std::vector<std::unique_ptr<Picture>> pictures;
  const auto add_picture = [&](const std::string& name, int size, double noises, int width,
                               const Target& target) {
    const std::string cpu(target.name);
    pictures.push_back(std::make_unique<Picture>(name, size, width, cpu));
    Picture* picture = pictures.back().get();
    picture->run();
    if (!picture->agrees_with_interpreter()) {
      std::fprintf(stderr, "%s: kernel and interpreter differ\n", name.c_str());
      std::exit(1);
    }
    Row row;
    row.name = name + ".pse, " + cpu.substr(7) + " x" + std::to_string(width);
    row.noises = noises;
    row.count = picture->samples();
    row.compile_ms = (picture->times().parse + picture->times().lower + picture->times().passes +
                      picture->times().codegen) *
                     1000;
    row.run = [picture] { picture->run(); };
    rows.push_back(std::move(row));
  };
  for (const Target& target : targets) {
    if (!host_target() || &target > host_target() || !target.avx2 ||
        (target.avx512 && !target.vbmi))
      continue;
    for (const int width : {target.width, 2 * target.width}) {
      if (width > target.width && !target.vbmi) continue;
      add_picture("fbm8", 1024, 8, width, target);
      add_picture("marble", 1024, 6, width, target);
      add_picture("hyper", 512, 234, width, target);
    }
  }
  std::vector<double> limit;
  for (int round = 0; round < rounds; ++round) {
    for (Row& row : rows) {
      const double start = now();
      for (int i = 0; i < row.repeat; ++i) row.run();
      row.ns.push_back((now() - start) * 1e9 / static_cast<double>(row.count * row.repeat));
    }
    double best = 0;
    for (std::size_t i = 0; i < limits; ++i)
      best = i == 0 ? rows[i].ns.back() : std::min(best, rows[i].ns.back());
    if (limits > 0) limit.push_back(best);
  }
  print(rows, limit);
  return 0;
}

}  // namespace
}  // namespace pse::bench

int main(int argc, char** argv) {
  return pse::bench::run(argc > 1 ? std::max(1, std::atoi(argv[1])) : 101);
}
