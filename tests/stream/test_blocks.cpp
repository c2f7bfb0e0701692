// The order in which a tile's pixels are computed where they may part: any 8, 16 or 32 that a
// vector holds are a small rectangle; results and failures are those of the order of rows.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "fake_program.h"
#include "stream/blocks.h"
#include "stream/planes.h"

namespace pse {
namespace {

using test::fake_program;

struct Ran {
  std::vector<float> x, y;  // the results, row by row
  RunStatus status;
};

void run(const Program& program, int width, int height, Ran& ran) {
  const std::int64_t count = std::int64_t{width} * height;
  const Planes in({true, true}, count), out({true, true}, count);
  for (std::int64_t i = 0; i < count; ++i) {
    in.pointers()[0][i] = static_cast<float>(i % width);
    in.pointers()[1][i] = static_cast<float>(i / width);
  }
  FrameState state;
  Scratch scratch;
  run_tile(program, state, ran.status, scratch, in.pointers(), out.pointers(), width, height);
  ran.x.assign(out.pointers()[0], out.pointers()[0] + count);
  ran.y.assign(out.pointers()[1], out.pointers()[1] + count);
}

// The extent of samples [first, first + count) along both axes.
std::pair<float, float> extent(const float* const* inputs, std::int64_t first, std::int64_t count) {
  const auto of = [&](const float* plane) {
    const auto [low, high] = std::minmax_element(plane + first, plane + first + count);
    return *high - *low + 1;
  };
  return {of(inputs[0]), of(inputs[1])};
}

TEST(Blocks, VectorsAreSmallRectangles) {
  Program program = fake_program(
      {{"px"}, {"py"}}, {"a", "b"}, [](auto inputs, auto outputs, auto count, auto& status) {
        ASSERT_EQ(count, 16 * 8);
        for (std::int64_t i = 0; i < count; i += 8)
          EXPECT_EQ(extent(inputs, i, 8), std::pair(4.0f, 2.0f)) << i;
        for (std::int64_t i = 0; i < count; i += 16)
          EXPECT_EQ(extent(inputs, i, 16), std::pair(4.0f, 4.0f)) << i;
        for (std::int64_t i = 0; i < count; i += 32)
          EXPECT_EQ(extent(inputs, i, 32), std::pair(8.0f, 4.0f)) << i;
        test::copy_planes(inputs, outputs, count, status, 2);
      });
  program.parts = true;
  Ran ran;
  run(program, 16, 24, ran);
}

TEST(Blocks, EachSampleComesBackToItsPlace) {
  for (const bool parts : {false, true})
    for (const auto& [width, height] :
         {std::pair{1, 1}, {64, 64}, {65, 3}, {7, 9}, {1, 17}, {80, 1}}) {
      Program program = fake_program({{"px"}, {"py"}}, {"a", "b"},
                                     [](auto inputs, auto outputs, auto count, auto& status) {
                                       test::copy_planes(inputs, outputs, count, status, 2);
                                     });
      program.parts = parts;
      Ran ran;
      run(program, width, height, ran);
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          EXPECT_EQ(ran.x[static_cast<std::size_t>(y * width + x)], static_cast<float>(x));
          EXPECT_EQ(ran.y[static_cast<std::size_t>(y * width + x)], static_cast<float>(y));
        }
    }
}

// Of two samples that fail, by different checks, the first in the order of rows is told: (9, 10)
// and not (0, 11), which is computed before.
TEST(Blocks, TheFirstFailureIsThatOfTheRows) {
  for (const bool parts : {false, true}) {
    Program program = fake_program(
        {{"px"}, {"py"}}, {"a", "b"}, [](auto inputs, auto, auto count, auto& status) {
          for (std::int64_t i = 0; i < count; ++i) {
            const bool first = inputs[0][i] == 9 && inputs[1][i] == 10;
            if (!first && !(inputs[0][i] == 0 && inputs[1][i] == 11)) continue;
            status.failed_check = first ? 1 : 2;
            status.failed_sample = static_cast<std::uint32_t>(i);
            return;
          }
        });
    program.parts = parts;
    Ran ran;
    run(program, 20, 30, ran);
    EXPECT_EQ(ran.status.failed_check, 1);
    EXPECT_EQ(ran.status.failed_sample, 10 * 20 + 9);
  }
}

}  // namespace
}  // namespace pse
