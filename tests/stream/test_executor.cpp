// The executor: every pixel once, whatever the tiles and threads; cancellation, failure and
// exceptions; ordered sinks.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <thread>

#include "fake_program.h"
#include "stream/executor.h"
#include "stream/image_plane.h"

namespace pse {
namespace {

using test::fake_program;

Program pass_coordinates() {
  return fake_program({{"px"}, {"py"}}, {"a", "b"},
                      [](auto inputs, auto outputs, auto count, auto& status) {
                        test::copy_planes(inputs, outputs, count, status, 2);
                      });
}

// Runs `program` over the window and gives how often each pixel came out, checking that it carries
// its coordinates.
std::vector<int> visits(const Rect& window, int tile_width, int tile_height, int threads,
                        bool ordered) {
  const Program program = pass_coordinates();
  ImagePlane plane{.width = window.x1, .height = window.y1};
  FrameState state;
  RunStatus status;
  std::mutex mutex;
  std::vector<int> seen(static_cast<std::size_t>(window.width() * window.height()), 0);
  const auto sink = [&](const TileView& tile) {
    const std::lock_guard lock(mutex);
    EXPECT_EQ(tile.count, tile.rect.width() * tile.rect.height());
    for (std::int64_t i = 0; i < tile.count; ++i) {
      const int x = tile.rect.x0 + static_cast<int>(i) % tile.rect.width();
      const int y = tile.rect.y0 + static_cast<int>(i) / tile.rect.width();
      EXPECT_EQ(tile.planes[0][i], static_cast<float>(x) + 0.5f);
      EXPECT_EQ(tile.planes[1][i], static_cast<float>(y) + 0.5f);
      ++seen[static_cast<std::size_t>((y - window.y0) * window.width() + x - window.x0)];
    }
  };
  const RunResult result =
      execute(program, state, image_plane_source(program.module(), plane, window), sink,
              {.window = window,
               .tile_width = tile_width,
               .tile_height = tile_height,
               .threads = threads,
               .ordered_sink = ordered},
              status);
  EXPECT_EQ(result.end, RunEnd::finished);
  return seen;
}

TEST(Executor, EveryPixelExactlyOnceAtOddSizes) {
  const Rect windows[] = {
      {0, 0, 1, 1}, {0, 0, 65, 63}, {3, 5, 130, 7}, {17, 2, 18, 201}, {0, 0, 64, 64}};
  for (const Rect& window : windows)
    for (const auto& [tile_width, tile_height] : {std::pair{64, 64}, {1, 7}, {16, 3}, {1000, 1000}})
      for (const int threads : {1, 2, 5})
        for (const bool ordered : {false, true}) {
          const std::vector<int> seen = visits(window, tile_width, tile_height, threads, ordered);
          EXPECT_EQ(std::count(seen.begin(), seen.end(), 1),
                    static_cast<std::ptrdiff_t>(seen.size()));
        }
}

TEST(Executor, AnEmptyWindowFinishes) {
  EXPECT_TRUE(visits({4, 4, 4, 4}, 64, 64, 2, false).empty());
}

TEST(Executor, PlanesAreAlignedPaddedAndApartModulo4096) {
  const std::vector<ir::Input> inputs = {{"px"}, {"knob", ir::Rate::frame}, {"py"}, {"x"}, {"y"}};
  std::atomic<int> runs{0};
  const Program program =
      fake_program(inputs, {"a", "b"}, [&](auto in, auto out, auto count, auto&) {
        ++runs;
        EXPECT_EQ(in[1], nullptr);
        const std::vector<const float*> planes = {in[0], in[2], in[3], in[4], out[0], out[1]};
        for (std::size_t i = 0; i < planes.size(); ++i) {
          const auto address = reinterpret_cast<std::uintptr_t>(planes[i]);
          EXPECT_EQ(address % 64, 0u);
          for (std::size_t j = 0; j < i && j < 4; ++j) {
            const auto apart = (address - reinterpret_cast<std::uintptr_t>(planes[j])) % 4096;
            if (i < 4) {
              EXPECT_GE(apart, 5 * 64u);
              EXPECT_LE(apart, 4096 - 5 * 64u);
            }
          }
        }
        // Whole vectors may be written: the sanitizers see whether the room is there.
        for (std::int64_t i = 0; i < (count + 15) / 16 * 16; ++i) out[0][i] = out[1][i] = 0;
      });
  FrameState state;
  RunStatus status;
  const Rect window{0, 0, 37, 3};
  execute(
      program, state, image_plane_source(program.module(), {.width = 37, .height = 3}, window),
      [](const TileView&) {}, {.window = window, .tile_width = 37, .tile_height = 1, .threads = 2},
      status);
  EXPECT_EQ(runs, 3);
}

TEST(Executor, OrderedSinkGetsTilesOneAtATimeInOrder) {
  const Program program = pass_coordinates();
  FrameState state;
  RunStatus status;
  const Rect window{0, 0, 100, 60};
  std::vector<std::pair<int, int>> order;
  std::atomic<int> inside{0};
  const auto sink = [&](const TileView& tile) {
    EXPECT_EQ(++inside, 1);
    order.emplace_back(tile.rect.y0, tile.rect.x0);
    --inside;
  };
  execute(
      program, state, image_plane_source(program.module(), {.width = 100, .height = 60}, window),
      sink,
      {.window = window, .tile_width = 16, .tile_height = 16, .threads = 4, .ordered_sink = true},
      status);
  EXPECT_EQ(order.size(), 7u * 4u);
  EXPECT_TRUE(std::is_sorted(order.begin(), order.end()));
}

TEST(Executor, MemoryLimitBoundsTilesInFlight) {
  // 64x64 tiles of 1 input and 1 output are a little over 32 KiB each: a limit of 80 KiB leaves two
  // alive.
  std::atomic<int> alive{0};
  std::atomic<int> most{0};
  const Program program = fake_program({{"px"}}, {"a"}, [&](auto, auto, auto, auto&) {
    const int now = ++alive;
    int before = most;
    while (before < now && !most.compare_exchange_weak(before, now)) {
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  });
  FrameState state;
  RunStatus status;
  const Rect window{0, 0, 512, 512};
  execute(
      program, state, [](const TileView&) {}, [&](const TileView&) { --alive; },
      {.window = window, .threads = 8, .ordered_sink = true, .memory_limit = 80 * 1024}, status);
  EXPECT_LE(most, 2);  // on a busy machine even fewer
}

// How soon is measured in bench/stream; that each vector of samples and each turn of a loop looks
// at the flag is held by tests/codegen/cancel_test.cpp.
TEST(Executor, CancelStopsEndlessLoops) {
  // The kernel loops until it is told to stop, as compiled loops do.
  std::atomic<bool> running = false;
  const Program program = fake_program({}, {"a"}, [&](auto, auto, auto, RunStatus& status) {
    running = true;
    while (!status.stopped()) std::this_thread::yield();
  });
  FrameState state;
  RunStatus status;
  std::jthread canceller([&] {
    while (!running) std::this_thread::yield();
    status.cancel = true;
  });
  int delivered = 0;
  const RunResult result = execute(
      program, state, [](const TileView&) {}, [&](const TileView&) { ++delivered; },
      {.window = {0, 0, 256, 256}, .threads = 2}, status);
  EXPECT_EQ(result.end, RunEnd::cancelled);
  EXPECT_EQ(delivered, 0);
}

TEST(Executor, CancelReachesTheKernelsWhileAReportTakesItsTime) {
  // A report may write a snapshot. This one goes on until a kernel has seen the flag.
  std::atomic<bool> seen = false, reporting = false;
  const Program program = fake_program({}, {"a"}, [&](auto, auto, auto, RunStatus& status) {
    while (!status.stopped()) std::this_thread::yield();
    seen = true;
  });
  FrameState state;
  RunStatus status;
  std::jthread canceller([&] {
    while (!reporting) std::this_thread::yield();
    status.cancel = true;
  });
  const auto report = [&](double) {
    reporting = true;
    while (!seen) std::this_thread::yield();
  };
  const RunResult result = execute(
      program, state, [](const TileView&) {}, [](const TileView&) {},
      {.window = {0, 0, 64, 64}, .threads = 2, .progress = report}, status);
  EXPECT_EQ(result.end, RunEnd::cancelled);
}

TEST(Executor, CancelledBeforeTheStartRunsNothing) {
  const Program program = pass_coordinates();
  FrameState state;
  RunStatus status;
  status.cancel = true;
  const RunResult result = execute(
      program, state, [](const TileView&) { FAIL(); }, [](const TileView&) { FAIL(); },
      {.window = {0, 0, 8, 8}}, status);
  EXPECT_EQ(result.end, RunEnd::cancelled);
}

TEST(Executor, ReportsTheFirstFailedTileAndItsPixelForAnyThreads) {
  // Pixels (70, 40) and (10, 100) fail check 3. With 32x32 tiles the first one's tile is number 4 +
  // 2 of four in a row.
  const Program program =
      fake_program({{"px"}, {"py"}}, {"a"}, [](auto in, auto, auto count, RunStatus& status) {
        for (std::int64_t i = 0; i < count; ++i) {
          const bool first = in[0][i] == 70.5f && in[1][i] == 40.5f,
                     second = in[0][i] == 10.5f && in[1][i] == 100.5f;
          if (first)
            std::this_thread::sleep_for(
                std::chrono::milliseconds(20));  // the later tile fails earlier
          if (first || second) {
            status.failed_check = first ? 3 : 4;
            status.failed_sample = static_cast<std::uint32_t>(i);
            return;
          }
        }
      });
  for (const int threads : {1, 2, 8}) {
    FrameState state;
    RunStatus status;
    const Rect window{0, 0, 128, 128};
    const RunResult result = execute(
        program, state, image_plane_source(program.module(), {.width = 128, .height = 128}, window),
        [](const TileView&) {},
        {.window = window, .tile_width = 32, .tile_height = 32, .threads = threads}, status);
    EXPECT_EQ(result.end, RunEnd::failed);
    EXPECT_EQ(result.failed_check, 3);
    EXPECT_EQ(result.x, 70);
    EXPECT_EQ(result.y, 40);
  }
}

TEST(Executor, AFailureInTheFramePartHasNoPixel) {
  const Program program = fake_program(
      {}, {}, [](auto, auto, auto, auto&) { FAIL(); },
      [](FrameState&, RunStatus& status) { status.failed_check = 2; });
  FrameState state;
  RunStatus status;
  const RunResult result = execute(
      program, state, [](const TileView&) {}, [](const TileView&) {}, {.window = {0, 0, 8, 8}},
      status);
  EXPECT_EQ(result.end, RunEnd::failed);
  EXPECT_EQ(result.failed_check, 2);
  EXPECT_EQ(result.x, -1);
}

TEST(Executor, ExceptionsOfSourceAndSinkComeOutWhileOtherTilesLoop) {
  for (const bool in_source : {true, false}) {
    // Every tile but the first loops until stopped.
    const Program program =
        fake_program({{"px"}}, {"a"}, [](auto in, auto, auto, RunStatus& status) {
          while (in[0][0] != 0.5f && !status.cancel) std::this_thread::yield();
        });
    FrameState state;
    RunStatus status;
    const auto source = [&](const TileView& tile) {
      tile.planes[0][0] = static_cast<float>(tile.rect.x0) + 0.5f;
      if (in_source && tile.rect.x0 == 0) throw std::runtime_error("source");
    };
    const auto sink = [&](const TileView&) { throw std::runtime_error("sink"); };
    try {
      execute(program, state, source, sink, {.window = {0, 0, 256, 64}, .threads = 3}, status);
      FAIL() << "no exception";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), in_source ? "source" : "sink");
    }
  }
}

TEST(Executor, ProgressRisesToOne) {
  const Program program = fake_program({}, {"a"}, [](auto, auto, auto, auto&) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  });
  FrameState state;
  RunStatus status;
  std::vector<double> reports;
  execute(
      program, state, [](const TileView&) {}, [](const TileView&) {},
      {.window = {0, 0, 512, 512},
       .threads = 2,
       .progress = [&](double done) { reports.push_back(done); }},
      status);
  ASSERT_FALSE(reports.empty());
  EXPECT_TRUE(std::is_sorted(reports.begin(), reports.end()));
  EXPECT_EQ(reports.back(), 1.0);
  EXPECT_GE(reports.front(), 0.0);
}

}  // namespace
}  // namespace pse
