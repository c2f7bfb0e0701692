// Segments of a program over lists of samples: gathering, scattering and neighbours, with cases
// worked out by hand.
#include <gtest/gtest.h>

#include <limits>

#include "fake_program.h"
#include "stream/sample_list.h"

namespace pse {
namespace {

using enum Neighbour;

TEST(NeighbourTable, TheEightNeighboursOfTheMiddleOfAThreeByThree) {
  const SampleList list = samples_of({0, 0, 3, 3});
  const NeighbourTable table(list);
  ASSERT_EQ(table.size(), 9u);
  EXPECT_EQ(table.of(4, left), 3);
  EXPECT_EQ(table.of(4, right), 5);
  EXPECT_EQ(table.of(4, up), 1);
  EXPECT_EQ(table.of(4, down), 7);
  EXPECT_EQ(table.of(4, up_left), 0);
  EXPECT_EQ(table.of(4, up_right), 2);
  EXPECT_EQ(table.of(4, down_left), 6);
  EXPECT_EQ(table.of(4, down_right), 8);
  // A corner has three; the end of one row is no neighbour of the start of the next.
  EXPECT_EQ(table.of(2, right), -1);
  EXPECT_EQ(table.of(2, left), 1);
  EXPECT_EQ(table.of(2, down), 5);
  EXPECT_EQ(table.of(2, down_left), 4);
  EXPECT_EQ(table.of(2, up), -1);
}

TEST(NeighbourTable, SamplesOutsideTheListAreNobodysNeighbours) {
  // An L in the order of a shuffle, with negative coordinates:  (-1,-1)
  //                                                             (-1, 0) (0, 0)        and far away
  //                                                             (5, 0)
  const SampleList list = {{0, 0, 10}, {5, 0, 11}, {-1, -1, 12}, {-1, 0, 13}};
  const NeighbourTable table(list);
  EXPECT_EQ(table.of(0, left), 3);
  EXPECT_EQ(table.of(0, up_left), 2);
  EXPECT_EQ(table.of(0, up), -1);
  EXPECT_EQ(table.of(3, up), 2);
  EXPECT_EQ(table.of(2, down_right), 0);
  for (const Neighbour which : {left, right, up, down, up_left, up_right, down_left, down_right})
    EXPECT_EQ(table.of(1, which), -1);
}

TEST(NeighbourTable, ExtremeCoordinatesDoNotWrap) {
  const int low = std::numeric_limits<int>::min(), high = std::numeric_limits<int>::max();
  const NeighbourTable table(
      SampleList{{high, 0, 0}, {low, 0, 1}, {low, 1, 2}, {0, high, 3}, {0, low, 4}});
  EXPECT_EQ(table.of(0, right), -1);
  EXPECT_EQ(table.of(1, left), -1);
  EXPECT_EQ(table.of(1, down), 2);
  EXPECT_EQ(table.of(3, down), -1);
}

TEST(NeighbourTable, EmptyListAndRepeatedPlaces) {
  EXPECT_EQ(NeighbourTable(SampleList{}).size(), 0u);
  const NeighbourTable table(SampleList{{0, 0, 0}, {1, 0, 1}, {1, 0, 2}});
  EXPECT_EQ(table.of(0, right), 1);
  EXPECT_EQ(table.of(2, left), 0);
}

// out = 2 a + Knob
Program twice_plus_knob() {
  return test::fake_program({{"a"}, {"Knob", ir::Rate::frame}}, {"out", "unwanted"},
                            [](auto in, auto out, auto count, RunStatus& status) {
                              for (std::int64_t i = 0; i < count; ++i) {
                                if (in[0][i] == 13) {
                                  status.failed_check = 0;
                                  status.failed_sample = static_cast<std::uint32_t>(i);
                                  return;
                                }
                                out[0][i] = 2 * in[0][i] + 100;
                              }
                            });
}

TEST(RunList, GathersAndScattersByPlaceAndLeavesTheRestAlone) {
  const Program segment = twice_plus_knob();
  const FrameState state{.uniforms = {0, 100}};
  const std::vector<float> a = {1, 2, 3, 4, 5, 6};
  const SampleList list = {{0, 0, 4}, {9, 9, 0}, {3, 3, 5}};
  for (const int batch : {1, 2, 1000})
    for (const int threads : {1, 2, 4}) {
      std::vector<float> out(6, -1);
      const float* inputs[] = {a.data(), nullptr};
      float* outputs[] = {out.data(), nullptr};
      RunStatus status;
      const ListResult result =
          run_list(segment, state, list, inputs, outputs, {threads, batch}, status);
      EXPECT_EQ(result.end, RunEnd::finished);
      EXPECT_EQ(out, (std::vector<float>{102, -1, -1, -1, 110, 112}));
    }
}

TEST(RunList, ReportsTheFirstFailedSampleOfTheList) {
  const Program segment = twice_plus_knob();
  const FrameState state{.uniforms = {0, 0}};
  std::vector<float> a(100, 1.0f), out(100);
  a[70] = a[31] = 13;
  const float* inputs[] = {a.data(), nullptr};
  float* outputs[] = {out.data(), nullptr};
  for (const int threads : {1, 4}) {
    RunStatus status;
    const ListResult result =
        run_list(segment, state, samples_of({0, 0, 10, 10}), inputs, outputs, {threads, 8}, status);
    EXPECT_EQ(result.end, RunEnd::failed);
    EXPECT_EQ(result.failed_check, 0);
    EXPECT_EQ(result.failed_sample, 31u);
  }
}

// |x| as the chapter recasts it: a condition, both sides over their own lists, the two joined in
// one plane.
TEST(RunList, TwoSidesOfAConditionalMeetInOnePlane) {
  const auto unary = [](float (*f)(float)) {
    return test::fake_program({{"x"}}, {"r"}, [f](auto in, auto out, auto count, auto&) {
      for (std::int64_t i = 0; i < count; ++i) out[0][i] = f(in[0][i]);
    });
  };
  const Program condition = unary([](float x) { return x < 0 ? 1.0f : 0.0f; });
  const Program negate = unary([](float x) { return -x; });
  const Program keep = unary([](float x) { return x; });

  std::vector<float> x = {-3, -2, -1, 0, 1, 2}, side(6), result(6);
  const SampleList all = samples_of({0, 0, 3, 2});
  const FrameState state;
  RunStatus status;
  const auto run = [&](const Program& segment, const SampleList& list, std::vector<float>& to) {
    const float* inputs[] = {x.data()};
    float* outputs[] = {to.data()};
    run_list(segment, state, list, inputs, outputs, {}, status);
  };
  run(condition, all, side);
  const SampleList negative = select_samples(all, side.data(), true),
                   rest = select_samples(all, side.data(), false);
  run(negate, negative, result);
  run(keep, rest, result);
  EXPECT_EQ(result, (std::vector<float>{3, 2, 1, 0, 1, 2}));

  // Of the top row (-3 -2 -1) none has a neighbour below within its side; the bottom row is (0 1
  // 2).
  ASSERT_EQ(negative.size(), 3u);
  const NeighbourTable table(negative);
  EXPECT_EQ(table.of(1, left), 0);
  EXPECT_EQ(table.of(1, down), -1);
}

}  // namespace
}  // namespace pse
