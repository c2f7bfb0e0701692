// Several programs as one: what a ray of one program meets belongs to the same run.
#include "surface/shader.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "../stream/fake_program.h"
#include "surface/shapes.h"

namespace pse::surface {
namespace {

using test::fake_program;

// The background sends a ray to a ball whose program loops until its run is stopped.
TEST(Shader, WhatARayMeetsIsStoppedWithTheRun) {
  Shader* whole = nullptr;
  std::atomic<bool> met = false, stopped = false;
  const auto mirror = std::make_shared<Program>(
      fake_program({{"id"}}, {"color"}, [&](auto, auto out, std::int64_t count, auto&) {
        std::vector<float> rgba(4 * 16);
        float* const planes[] = {rgba.data(), rgba.data() + 16, rgba.data() + 32, rgba.data() + 48};
        const std::vector<Ray> rays(1, Ray{.origin = {0, 0, 5}, .direction = {0, 0, -1}});
        whole->radiance(rays, 0, planes);
        std::fill_n(out[0], count, rgba[0]);
      }));
  const auto endless = std::make_shared<Program>(
      fake_program({{"id"}}, {"color"}, [&](auto, auto, auto, RunStatus& status) {
        met = true;
        for (int i = 0; i < 5'000'000 && !status.stopped(); ++i) std::this_thread::yield();
        stopped = status.stopped();
      }));
  mirror->outputs = endless->outputs = {ProgramOutput{"color", 1, {}}};
  const auto shader = std::make_shared<Shader>(
      std::vector<std::shared_ptr<const Program>>{mirror, endless}, std::vector<int>{0, 1});
  whole = shader.get();
  const auto scene = std::make_shared<const Scene>(
      std::vector<Object>{{.name = "ball", .shape = make_sphere(1), .to_world = {}, .program = 1}},
      std::vector<Light>{});
  shader->begin_frame(std::vector<FrameState>(2), scene, Lens({}, 4, 4));
  const auto program = Shader::combined(shader);

  FrameState state;
  RunStatus status;
  std::jthread canceller([&] {
    while (!met) std::this_thread::yield();
    status.cancel = true;
  });
  const ExecuteOptions window{.window = {0, 0, 1, 1}, .threads = 1};
  const auto source = [](const TileView& tile) { tile.planes[0][0] = 0; };
  execute(
      *program, state, source, [](const TileView&) {}, window, status);
  EXPECT_TRUE(met);
  EXPECT_TRUE(stopped);
}

}  // namespace
}  // namespace pse::surface
