// Rays and shading of surfaces at 1024 x 1024: the bunny beside a loop over Embree alone, the marble
// vase, and shading again from stored surfaces. Each result is checked before it is timed; the table
// gives the median and, behind it, the fastest and slowest run. usage: bench_surface [RUNS] [bunny|vase]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <functional>

#include "embree_loop.h"
#include "surface/gbuffer.h"
#include "surface/shader.h"
#include "surface/shapes.h"

namespace {

using namespace pse;
using namespace pse::surface;

constexpr int size = 1024;
int failures = 0;

void check(bool good, const char* what) {
  if (good) return;
  std::printf("WRONG: %s\n", what);
  ++failures;
}

// Times of one piece of work; one thread's by the processor's clock, which others on the machine
// disturb less.
struct Times {
  std::vector<double> all;  // milliseconds, as they came
  double at(double part) const {
    std::vector<double> sorted = all;
    std::sort(sorted.begin(), sorted.end());
    const auto place = static_cast<std::size_t>(part * double(sorted.size()));
    return sorted[std::min(sorted.size() - 1, place)];
  }
};
void measure(Times& times, int threads, const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  const std::clock_t clock = std::clock();
  work();
  const std::chrono::duration<double, std::milli> passed = std::chrono::steady_clock::now() - start;
  times.all.push_back(threads == 1 ? 1e3 * double(std::clock() - clock) / CLOCKS_PER_SEC
                                   : passed.count());
}
void print(const char* name, const Times& times, const char* unit, const char* note = "") {
  std::printf("%-52s %8.2f %s [%.2f .. %.2f]   %s\n", name, times.at(0.5), unit, times.at(0),
              times.at(1), note);
}
// One against another, run by run.
Times ratio(const Times& a, const Times& b) {
  Times r;
  for (std::size_t i = 0; i < a.all.size(); ++i) r.all.push_back(a.all[i] / b.all[i]);
  return r;
}
void row(const char* name, int runs, int threads, const std::function<void()>& work,
         const char* note = "") {
  Times times;
  for (int i = 0; i < runs; ++i) measure(times, threads, work);
  print(name, times, "ms", note);
}

std::shared_ptr<const Program> compile_text(const std::string& text,
                                            std::vector<StreamName> stream) {
  SourceMap sources;
  Diagnostics diagnostics;
  CompileOptions options;
  options.lower.stream = std::move(stream);
  for (const StreamName& name : image_plane_names()) options.lower.stream.push_back(name);
  return compile(sources, sources.add("bench", text), {}, options, diagnostics);
}

// The gallery's marble, and a light.
constexpr const char* marble =
    "t = turbulence(2 * point)\n"
    "c = spline(0.5 + 0.5 * sin(6 * point.x + 6 * t), [[0.9 0.88 0.82] [0.8 0.75 0.66] "
    "[0.45 0.35 0.28] [0.9 0.88 0.82]])\n"
    "color = plastic(c, normal, light_direction, view)\n";

// A picture: one scene, one program, kept in memory.
struct Job {
  std::shared_ptr<const Program> part;
  std::shared_ptr<Shader> shader;
  std::shared_ptr<const Program> whole;
  std::vector<std::vector<float>> planes;

  Job(const char* text, std::vector<StreamName> names)
      : part(compile_text(text, std::move(names))),
        shader(std::make_shared<Shader>(std::vector{part}, std::vector<int>{-1, 0})),
        whole(Shader::combined(shader)),
        planes(whole->module().outputs.size(), std::vector<float>(std::size_t{size} * size)) {}

  FrameState state() const {
    FrameState state;
    ImagePlane plane;
    plane.width = plane.height = size;
    set_plane_uniforms(part->module(), plane, state);
    return state;
  }
  void run(const std::shared_ptr<const SampleSource>& source, int threads) {
    FrameState state;
    RunStatus status;
    const auto sink = [&](const TileView& tile) {
      for (std::size_t o = 0; o < planes.size(); ++o)
        for (int y = 0; y < tile.rect.height(); ++y)
          std::copy_n(tile.planes[o] + std::ptrdiff_t{y} * tile.rect.width(), tile.rect.width(),
                      planes[o].begin() + std::ptrdiff_t{tile.rect.y0 + y} * size + tile.rect.x0);
    };
    execute(*whole, state, at_pixel_centres(source), sink,
            {.window = {0, 0, size, size}, .threads = threads}, status);
  }
};

void bench_bunny(int runs) {
  const std::filesystem::path file =
      std::filesystem::path(PSE_SOURCE_DIR) / "../shared/data/stanford-bunny.obj";
  if (!std::filesystem::exists(file)) {
    std::printf("the bunny is not here: ../shared/data is missing\n");
    return;
  }
  const auto loaded = load_mesh(file.string(), {.fit = true});
  const auto shape = make_mesh_shape(loaded->mesh);
  const Scene scene({{"bunny", *shape, {}, 0}}, {});
  const Lens lens(framing(scene.bounds(), 1, 30), size, size);

  // The same rays: a loop over Embree that notes the triangle; ours that find the place in double as
  // well, and what is to be seen there; in turn, so that both meet the same disturbances.
  const EmbreeLoop loop(*loaded->mesh);
  std::vector<std::uint32_t> triangles;
  std::vector<Ray> rays(512), seen_rays;
  std::vector<Hit> hits(rays.size()), seen_hits;
  std::vector<Spot> spots;
  std::size_t seen = 0;
  const auto ours = [&](bool describe) {
    seen = 0;
    for (int piece = 0; piece < size * size / 512; ++piece) {
      const int x0 = piece % 16 * 64, y0 = piece / 16 * 8;
      for (int i = 0; i < 512; ++i) {
        const int block = i / 16, x = x0 + block % 16 * 4 + i % 4,
                  y = y0 + block / 16 * 4 + i % 16 / 4;
        rays[static_cast<std::size_t>(i)] = lens.ray(x + 0.5, y + 0.5);
      }
      scene.trace(rays, hits);
      for (const Hit& hit : hits) seen += hit.found() ? 1 : 0;
      if (!describe) continue;
      seen_rays.clear(), seen_hits.clear();
      for (std::size_t i = 0; i < rays.size(); ++i)
        if (hits[i].found()) seen_rays.push_back(rays[i]), seen_hits.push_back(hits[i]);
      spots.resize(seen_hits.size());
      scene.describe(seen_rays, seen_hits, true, spots);
    }
  };
  Times alone, eight, sixteen, where, all;
  for (int i = 0; i < runs; ++i) {
    measure(alone, 1, [&] { loop.triangles(lens, size, 1); });
    measure(sixteen, 1, [&] { triangles = loop.triangles(lens, size, 16); });
    measure(eight, 1, [&] { loop.triangles(lens, size, 8); });
    measure(where, 1, [&] { ours(false); });
    measure(all, 1, [&] { ours(true); });
  }
  print("bunny, Embree alone, single rays, 1 thread", alone, "ms");
  print("bunny, Embree alone, packets of 16", sixteen, "ms");
  print("bunny, Embree alone, packets of 8", eight, "ms");
  print("bunny, pse, object, triangle, t, u, v", where, "ms");
  print("bunny, pse, the same with place, normals and uv", all, "ms");
  std::size_t expected = 0;
  for (const std::uint32_t triangle : triangles) expected += triangle != 0xffffffff ? 1 : 0;
  check(expected > 100'000, "the bunny fills a part of the picture");
  check(seen == expected, "as many pixels see the bunny as in the loop over Embree");
  const Times& best = eight.at(0.5) < sixteen.at(0.5) ? eight : sixteen;
  print("  visibility over Embree's best", ratio(where, best), "times", "goal: 1.2");
  print("  the same with place, normals and uv", ratio(all, best), "times");
}

void bench_vase(int runs) {
  const auto scene = std::make_shared<Scene>(
      std::vector<Object>{{"vase", make_revolution(vase_profile(), false), {}, 0}},
      std::vector<Light>{{{-0.55, 0.75, 0.6}, false, {1, 1, 1}, 0}});
  const Lens lens(framing(scene->bounds(), 1, 30), size, size);
  Job job(marble, surface_names(1));
  job.shader->begin_frame({job.state()}, scene, lens);
  const std::shared_ptr<const SampleSource> source =
      std::make_shared<SurfaceSource>(job.whole->module(), scene, lens, false);
  for (const int threads : {1, 2})
    row(threads == 1 ? "marble vase, one sample, 1 thread" : "marble vase, one sample, 2 threads",
        runs, threads, [&] { job.run(source, threads); }, threads == 2 ? "goal: 60" : "");
  double sum = 0;
  for (const float value : job.planes[0]) sum += value;
  check(sum > 50'000 && sum < 1e6, "the vase is there");

  // Stored and shaded again.
  const image::ImageSpec spec{.display = {0, 0, size, size},
                              .data = {0, 0, size, size},
                              .channels = {{"A"}, {"point.X"}, {"point.Y"}, {"point.Z"}, {"N.X"},
                                           {"N.Y"}, {"N.Z"}, {"direction.X"}, {"direction.Y"},
                                           {"direction.Z"}, {"pixelsize.Y"}, {"dPdx.X"}, {"dPdx.Y"},
                                           {"dPdx.Z"}, {"dPdy.X"}, {"dPdy.Y"}, {"dPdy.Z"}}};
  Job writer("a = hit\np = point\nn = normal\nd = direction\nw = pixelsize\n"
             "dx = dPdx\ndy = dPdy\n",
             surface_names(1));
  writer.shader->begin_frame({writer.state()}, scene, lens);
  writer.run(std::make_shared<SurfaceSource>(writer.whole->module(), scene, lens, false), 2);
  auto picture = std::make_shared<image::Image>(spec);
  for (std::size_t i = 0; i < spec.channels.size(); ++i) picture->planes[i] = writer.planes[i];
  const std::vector<image::Layer> layers = image::layers_of(spec);
  const SurfaceLayers found = surface_layers(layers);
  check(!found.empty(), "the stored picture is one of surfaces");
  const GBufferFrame frame{lens.eye(), scene->lights()};
  Job again(marble, gbuffer_names(found, layers, frame));
  again.shader->begin_frame({again.state()});
  const std::shared_ptr<const SampleSource> stored = std::make_shared<GBuffer>(
      again.whole->module(), found, layers, spec, picture, frame);
  row("marble vase, shaded again from stored, 2 threads", runs, 2, [&] { again.run(stored, 2); },
      "goal: 100");
  check(again.planes == job.planes, "shaded again it has the same bits");
}

}  // namespace

int main(int argc, char** argv) {
  const int runs = argc > 1 ? std::max(1, std::atoi(argv[1])) : 9;
  const std::string only = argc > 2 ? argv[2] : "";
  if (only != "vase") bench_bunny(runs);
  if (only != "bunny") bench_vase(runs);
  return failures == 0 ? 0 : 1;
}
