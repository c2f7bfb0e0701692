// Rays and shading of surfaces at 1024 x 1024: the bunny beside a loop over Embree alone, the marble
// vase, and shading again from stored surfaces. Each result is checked before it is timed; the table
// gives the median and, behind it, the fastest and slowest run. usage: bench_surface [RUNS] [bunny|vase]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
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

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double row(const char* name, int runs, const std::function<void()>& work, const char* note) {
  std::vector<double> times;
  for (int i = 0; i < runs; ++i) times.push_back(1000 * seconds_of(work));
  std::sort(times.begin(), times.end());
  const double median = times[times.size() / 2];
  std::printf("%-52s %8.1f ms [%.1f .. %.1f]   %s\n", name, median, times.front(), times.back(),
              note);
  return median;
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

  const EmbreeLoop loop(*loaded->mesh);
  std::vector<std::uint32_t> single, packets;
  row("bunny, Embree alone, single rays, 1 thread", runs,
      [&] { single = loop.triangles(lens, size, false); }, "");
  const double best = row("bunny, Embree alone, packets of 16, 1 thread", runs,
                          [&] { packets = loop.triangles(lens, size, true); }, "");
  // The same in pse: rays from the lens, hits with places and normals.
  std::vector<Ray> rays(64 * 64);
  std::vector<Hit> hits(rays.size());
  std::size_t seen = 0;
  const double ours = row("bunny, pse, hits with place, normal and uv, 1 thread", runs, [&] {
    seen = 0;
    for (int tile = 0; tile < 256; ++tile) {
      const int x0 = tile % 16 * 64, y0 = tile / 16 * 64;
      for (int i = 0; i < 64 * 64; ++i)
        rays[static_cast<std::size_t>(i)] = lens.ray(x0 + i % 64 + 0.5, y0 + i / 64 + 0.5);
      scene.trace(rays, hits);
      for (const Hit& hit : hits) seen += hit.found() ? 1 : 0;
    }
  }, "");
  std::size_t expected = 0;
  for (const std::uint32_t triangle : packets) expected += triangle != 0xffffffff ? 1 : 0;
  check(expected > 100'000, "the bunny fills a part of the picture");
  check(std::llabs(static_cast<long long>(seen) - static_cast<long long>(expected)) <= 20,
        "as many pixels see the bunny as in the loop over Embree");
  std::printf("%-52s %8.2f\n", "  pse over Embree's packets", ours / best);
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
        runs, [&] { job.run(source, threads); }, threads == 2 ? "goal: 60" : "");
  double sum = 0;
  for (const float value : job.planes[0]) sum += value;
  check(sum > 50'000 && sum < 1e6, "the vase is there");

  // Stored and shaded again.
  const image::ImageSpec spec{.display = {0, 0, size, size},
                              .data = {0, 0, size, size},
                              .channels = {{"A"}, {"point.X"}, {"point.Y"}, {"point.Z"}, {"N.X"},
                                           {"N.Y"}, {"N.Z"}, {"direction.X"}, {"direction.Y"},
                                           {"direction.Z"}, {"pixelsize.Y"}}};
  Job writer("a = hit\np = point\nn = normal\nd = direction\nw = pixelsize\n", surface_names(1));
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
  row("marble vase, shaded again from stored, 2 threads", runs, [&] { again.run(stored, 2); },
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
