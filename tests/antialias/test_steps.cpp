// What is done for many pixels at once (src/antialias/steps.h) gives the same bits whichever
// instructions it is compiled for, and sums what a loop sums.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <random>

#include "antialias/steps.h"

namespace pse::antialias {
namespace {

// Those that this processor can run.
std::vector<const Steps*> runnable() {
  std::vector<const Steps*> all = {&steps_for_any()};
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx2") != 0) all.push_back(&steps_for_avx2());
#endif
  if (&steps() == &steps_for_avx512()) all.push_back(&steps_for_avx512());
  return all;
}

constexpr std::size_t beyond = CrossingLists::beyond;

std::vector<std::uint32_t> bits_of(const float* values, std::size_t count) {
  std::vector<std::uint32_t> bits(count);
  std::memcpy(bits.data(), values, count * sizeof(float));
  return bits;
}

std::vector<Pixel> found_by(const Steps& steps, const Tile& tile, int reach = 1) {
  const auto samples = static_cast<std::size_t>(tile.area.width() * tile.area.height());
  std::vector<std::uint16_t> changes(samples);
  std::vector<Pixel> found(samples + SearchRoom::beyond);
  const auto search = steps.search[static_cast<std::size_t>(reach) - 1];
  found.resize(search(tile, {changes.data(), found.data()}));
  return found;
}

// A row of 16 pixels with its apron, one output of one value, one way.
struct Row {
  static constexpr int width = 16;
  Tile tile{.rect = {0, 0, width, 1}, .area = {-1, -1, width + 1, 2}, .outputs = 1};
  std::vector<float> values, path;
  std::array<float*, 2> planes;

  explicit Row(float value) : values(3 * (width + 2) + 64, value), path(values.size()) {
    planes = {values.data(), path.data()};
    tile.planes = planes;
  }
};

class StepsOfAntialiasing : public testing::Test {
 protected:
  float number(float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(random_);
  }
  // Mostly ordinary numbers; now and then what a program may also give.
  float any_number() {
    constexpr float inf = std::numeric_limits<float>::infinity();
    const float strange[] = {0, -0.0f, inf, -inf, std::numeric_limits<float>::quiet_NaN(), 1e30f};
    const auto which = std::uniform_int_distribution<std::size_t>(0, 60)(random_);
    return which < std::size(strange) ? strange[which] : number(-2, 2);
  }
  std::mt19937 random_{7};
};

TEST_F(StepsOfAntialiasing, SearchForTheSamePixels) {
  for (const int width : {1, 7, 16, 33, 64})
    for (const int reach : {1, 2})
      for (const bool has_ends : {false, true}) {
        Tile tile;
        std::vector<float> bent;
        tile.rect = {0, 0, width, 9};
        tile.area = {-reach, -reach, width + reach, 9 + reach};
        tile.outputs = 2;
        const auto samples = static_cast<std::size_t>(tile.area.width()) *
                             static_cast<std::size_t>(tile.area.height());
        std::vector<std::vector<float>> planes(has_ends ? 4 : 3, std::vector<float>(samples + 64));
        std::vector<float> ids(samples + 64);
        for (std::size_t i = 0; i < samples; ++i) {
          planes[0][i] = any_number(), planes[1][i] = number(0, 1) < 0.6f ? 0.5f : any_number();
          planes[2][i] = number(0, 1) < 0.7f ? 3 : std::floor(number(0, 2000));
          if (has_ends) planes[3][i] = number(0, 1) < 0.7f ? 1 : number(0, 2);
          ids[i] = number(0, 1) < 0.8f ? 1 : 2;
        }
        std::vector<float*> pointers;
        for (auto& plane : planes) pointers.push_back(plane.data());
        tile.planes = pointers;
        if (has_ends) tile.ids = ids.data();
        if (width % 2 == 1) {
          for (std::size_t i = 0; i < samples + 64; ++i)
            bent.push_back(number(0, 1) < 0.9f ? 0 : 1);
          tile.bent = bent.data();
        }
        std::vector<std::vector<Pixel>> found;
        for (const Steps* steps : runnable()) found.push_back(found_by(*steps, tile, reach));
        EXPECT_GT(found[0].size(), 0u);
        for (const auto& pixels : found) {
          ASSERT_EQ(pixels.size(), found[0].size());
          for (std::size_t i = 0; i < pixels.size(); ++i) {
            const Pixel &a = pixels[i], &b = found[0][i];
            EXPECT_TRUE(a.x == b.x && a.y == b.y && a.silhouette == b.silhouette &&
                        a.narrow == b.narrow && a.hidden == b.hidden && a.untold == b.untold &&
                        a.unseen == b.unseen && a.enclosed == b.enclosed && a.jumps == b.jumps);
          }
        }
      }
}

// Whether hardly a neighbour goes the same way is asked for all pixels at once where any of them is
// an edge; of those that are none the answer would depend on what stands beside them.
TEST_F(StepsOfAntialiasing, WhatIsNoEdgeIsNotUntold) {
  Row row(0.5f);
  const Tile& tile = row.tile;
  auto &values = row.values, &path = row.path;
  // Ways of their own around (2, 0), all of the same value; an edge at 6 in the same eight.
  for (int y = -1; y < 2; ++y) {
    for (int x = 1; x < 4; ++x) path[tile.at(x, y)] = static_cast<float>(100 * x + 1000 * (y + 2));
    for (int x = 6; x < Row::width + 1; ++x) values[tile.at(x, y)] = 1, path[tile.at(x, y)] = 1;
  }
  for (const Steps* steps : runnable()) {
    const std::vector<Pixel> found = found_by(*steps, tile);
    int narrow = 0, edges = 0;
    for (const Pixel& pixel : found) {
      narrow += pixel.narrow ? 1 : 0, edges += pixel.narrow ? 0 : 1;
      EXPECT_FALSE(pixel.untold) << pixel.x;
    }
    EXPECT_EQ(narrow, 5);
    EXPECT_EQ(edges, 2);
  }
}

// Of large values steps below a hundredth of them are no edges, and neither is a bend of such
// steps, whatever is an edge beside it.
TEST_F(StepsOfAntialiasing, ABendOfSmallStepsIsNoEdge) {
  Row row(10);
  const Tile& tile = row.tile;
  auto &values = row.values, &path = row.path;
  // A roof at 2, of two steps of 0.1 where 0.11 is the least; a jump behind 9.
  for (int y = -1; y < 2; ++y) {
    values[tile.at(2, y)] = 10.1f;
    for (int x = 3; x < 10; ++x) path[tile.at(x, y)] = 1;
    for (int x = 10; x < Row::width + 1; ++x) values[tile.at(x, y)] = 20, path[tile.at(x, y)] = 2;
  }
  for (const Steps* steps : runnable()) {
    const std::vector<Pixel> found = found_by(*steps, tile);
    ASSERT_EQ(found.size(), 2u);
    EXPECT_EQ(found[0].x, 9);
    EXPECT_EQ(found[1].x, 10);
  }
}

TEST_F(StepsOfAntialiasing, FindTheSameFinePixels) {
  for (const int width : {1, 7, 16, 33, 64}) {
    Tile tile{.rect = {0, 0, width, 9}, .area = {-1, -1, width + 1, 10}, .outputs = 2};
    const auto samples = static_cast<std::size_t>(tile.area.width() * tile.area.height());
    std::vector<std::vector<float>> planes(4, std::vector<float>(samples + 64));
    for (std::size_t i = 0; i < samples; ++i) {
      planes[0][i] = any_number() / 20, planes[1][i] = number(0, 0.05f);
      planes[2][i] = number(0, 1) < 0.8f ? 3 : 4;
      planes[3][i] = number(0, 0.5f);
    }
    float* const pointers[] = {planes[0].data(), planes[1].data(), planes[2].data()};
    tile.planes = pointers;
    tile.fine = planes[3].data();
    std::vector<std::pair<int, int>> first;
    for (const Steps* steps : runnable()) {
      std::vector<Pixel> pixels(samples);
      pixels.resize(steps->find_fine(tile, pixels.data()));
      std::vector<std::pair<int, int>> found;
      for (const Pixel& pixel : pixels) found.emplace_back(pixel.x, pixel.y);
      if (steps == &steps_for_any()) first = found;
      EXPECT_EQ(found, first);
    }
    EXPECT_GT(first.size(), 0u);
    EXPECT_LT(first.size(), static_cast<std::size_t>(width) * 9);
  }
}

// Against the same written out for one pixel.
TEST_F(StepsOfAntialiasing, MeanHalvesToTheSameBits) {
  const HalfMeans by{{0.55f, 0.107f, 0.0125f, -0.008f}, {0.5875f, 0.106f, -0.0025f, 0}};
  constexpr std::ptrdiff_t row = 40, half_row = 36;
  constexpr std::size_t count = 34, first = row + 1;
  std::vector<float> path(3 * row + 64), middles(path.size()), beside(path.size()),
      below(path.size()), corner(path.size());
  for (std::size_t i = 0; i < path.size(); ++i) {
    path[i] = number(0, 1) < 0.9f ? 3 : 4;
    for (auto* list : {&middles, &beside, &below, &corner}) (*list)[i] = any_number();
  }
  const HalfRow at{path.data() + first,
                   middles.data() + first,
                   beside.data(),
                   below.data(),
                   corner.data(),
                   row,
                   half_row};
  std::vector<float> expected(count);
  for (std::size_t i = 0; i < count; ++i) {
    const float* m = at.middles + i;
    const float* way = at.path + i;
    const bool has_next =
        way[-1] == way[0] && way[1] == way[0] && way[-row] == way[0] && way[row] == way[0];
    const HalfWeights& w = has_next ? by.with_next : by.alone;
    const float sides = (beside[i] + beside[i + 1]) + (below[i] + below[i + half_row]);
    const float corners =
        (corner[i] + corner[i + 1]) + (corner[i + half_row] + corner[i + half_row + 1]);
    const float others = has_next ? (m[-1] + m[1]) + (m[-row] + m[row]) : 2 * m[0] + 2 * m[0];
    float mean = w.middle * m[0] + w.side * sides + w.corner * corners + w.next * others;
    std::vector<float> seen = {m[0],
                               beside[i],
                               beside[i + 1],
                               below[i],
                               corner[i],
                               corner[i + 1],
                               below[i + half_row],
                               corner[i + half_row],
                               corner[i + half_row + 1]};
    if (has_next) seen.insert(seen.end(), {m[-1], m[1], m[-row], m[row]});
    if (std::abs(mean) < 3e38f)
      mean = std::clamp(mean, *std::ranges::min_element(seen), *std::ranges::max_element(seen));
    expected[i] = mean;
  }
  for (const Steps* steps : runnable()) {
    std::vector<float> means(count + HalfGrid::beyond);
    steps->mean_of_halves(at, by, count, means.data());
    EXPECT_EQ(bits_of(means.data(), count), bits_of(expected.data(), count));
  }
}

// Against a loop over pixels and directions; planes that are not wanted stay as they are.
TEST_F(StepsOfAntialiasing, SmoothToTheSameBits) {
  const Smoothing by{0.0375f, -0.0078125f};
  for (const int width : {1, 7, 16, 33, 64})
    for (const int reach : {1, 2})
      for (const bool has_ends : {false, true}) {
        Tile tile{.rect = {3, 2, 3 + width, 11},
                  .area = {3 - reach, 2 - reach, 3 + width + reach, 11 + reach},
                  .outputs = 2};
        const auto row = static_cast<std::ptrdiff_t>(tile.area.width());
        const auto samples = static_cast<std::size_t>(row * tile.area.height());
        std::vector<std::vector<float>> planes(has_ends ? 4 : 3, std::vector<float>(samples + 64));
        for (std::size_t i = 0; i < samples; ++i) {
          planes[0][i] = any_number(), planes[1][i] = number(0, 1);
          planes[2][i] = number(0, 1) < 0.8f ? 3 : 4;
          if (has_ends) planes[3][i] = number(0, 1) < 0.8f ? 1 : number(0, 2);
        }
        std::vector<float> expected;
        for (int y = tile.rect.y0; y < tile.rect.y1; ++y)
          for (int x = tile.rect.x0; x < tile.rect.x1; ++x) {
            const auto at = static_cast<std::ptrdiff_t>(tile.at(x, y));
            const auto value = [&](std::size_t plane, std::ptrdiff_t step) {
              return planes[plane][static_cast<std::size_t>(at + step)];
            };
            const auto bend = [&](std::ptrdiff_t step) {
              for (const std::ptrdiff_t there : {step, -step})
                if (value(2, there) != value(2, 0) ||
                    (has_ends && !(std::abs(value(3, there) - value(3, 0)) <= 0.05f)))
                  return 0.0f;
              return value(0, step) + value(0, -step) - 2 * value(0, 0);
            };
            const float straight = by.axis * (bend(1) + bend(row)), most = std::abs(straight);
            float slanting = by.diagonal * (bend(row - 1) + bend(row + 1));
            if (std::abs(slanting) > most) slanting = std::copysign(most, slanting);
            const float more = straight + slanting;
            expected.push_back(std::abs(more) < 3e38f ? value(0, 0) + more : value(0, 0));
          }
        for (const Steps* steps : runnable()) {
          auto copies = planes;
          std::vector<float*> pointers;
          for (auto& plane : copies) pointers.push_back(plane.data());
          tile.planes = pointers;
          steps->smooth(tile, by, std::span(pointers).first(1));
          EXPECT_EQ(bits_of(copies[0].data(), expected.size()),
                    bits_of(expected.data(), expected.size()))
              << width << ' ' << reach << ' ' << has_ends;
          EXPECT_EQ(copies[1], planes[1]);
        }
      }
}

TEST_F(StepsOfAntialiasing, FollowEdgesToTheSameBits) {
  constexpr std::size_t count = 53;
  constexpr float reach = 0.5f;
  std::vector<std::vector<float>> lines(edge_outputs, std::vector<float>(count + beyond));
  std::vector<const float*> pointers;
  for (auto& list : lines) {
    for (float& value : list) value = any_number();
    pointers.push_back(list.data());
  }
  Crossings first;
  const CrossingLists start = first.lists(count);
  for (std::size_t i = 0; i < count; ++i) {
    const float angle = number(0, 6.3f);
    start.x[i] = static_cast<std::int32_t>(i), start.y[i] = 3;
    start.distance[i] = number(-0.6f, 0.6f);
    start.nx[i] = std::cos(angle), start.ny[i] = std::sin(angle);
    // Half of them see nearly the same edge again.
    if (i % 2 == 0)
      lines[0][i] = number(-0.1f, 0.1f), lines[1][i] = start.nx[i], lines[2][i] = start.ny[i];
    start.share[i] = number(0, 1), start.towards[i] = number(0, 1);
    start.turning[i] = number(0, 1);
    start.jumps[i] = i % 3 == 0 ? 1 << i % 8 : 0;
  }
  std::vector<std::vector<std::uint32_t>> bits;
  for (const Steps* steps : runnable()) {
    Crossings room;
    CrossingLists c = room.lists(count);
    c.count = count;
    for (std::size_t i = 0; i < count; ++i) {
      c.x[i] = start.x[i], c.y[i] = start.y[i], c.distance[i] = start.distance[i];
      c.nx[i] = start.nx[i], c.ny[i] = start.ny[i], c.share[i] = start.share[i];
      c.towards[i] = start.towards[i], c.turning[i] = start.turning[i];
      c.jumps[i] = start.jumps[i];
    }
    std::vector<Nearness> nearness(count + beyond);
    steps->see_nearness(c, pointers.data(), reach, 1.7f, nearness.data());
    std::vector<double> x(2 * count + beyond), y(x.size()), sides_x(x.size()), sides_y(x.size());
    steps->find_second_looks(c, reach, x.data(), y.data());
    steps->look_again(c, pointers.data(), reach);
    steps->bend_shares(c);
    steps->find_sides(c, sides_x.data(), sides_y.data());
    std::vector<std::uint32_t> all;
    for (const float* list : {c.distance, c.bend, c.share, c.towards, c.away, c.other}) {
      const auto some = bits_of(list, count);
      all.insert(all.end(), some.begin(), some.end());
    }
    for (std::size_t i = 0; i < count; ++i) {
      all.push_back(static_cast<std::uint32_t>(nearness[i]));
      all.push_back(static_cast<std::uint32_t>(c.is_one[i]));
      for (const double place : {x[i], y[i], sides_x[i], sides_y[count + i]})
        all.push_back(static_cast<std::uint32_t>(__builtin_bit_cast(std::uint64_t, place) >> 12));
    }
    bits.push_back(all);
    EXPECT_TRUE(std::ranges::count(nearness, Nearness::unclear) > 0);
    EXPECT_TRUE(std::ranges::any_of(std::span(c.is_one, count), [](auto one) { return one != 0; }));
  }
  for (const auto& some : bits) EXPECT_EQ(some, bits[0]);
}

// A line to the right at 1.2 explains a jump to the right, and one that leans; not one to the left,
// whatever the second line is, unless it lies there.
TEST_F(StepsOfAntialiasing, AJumpThatNoLinePartsIsUnclear) {
  struct Case {
    int dx, dy;
    float second;  // the distance of a line to the left
    Nearness expected;
  };
  constexpr float far = 1.5f;
  const std::vector<Case> cases = {
      {1, 0, no_edge, Nearness::out_of_reach},  {1, 1, no_edge, Nearness::out_of_reach},
      {1, -1, no_edge, Nearness::out_of_reach}, {0, 1, no_edge, Nearness::unclear},
      {-1, 0, no_edge, Nearness::unclear},      {-1, 0, 0.9f, Nearness::out_of_reach},
      {-1, 1, 0.9f, Nearness::out_of_reach},    {-1, 0, far, Nearness::unclear}};
  for (const Steps* steps : runnable())
    for (const auto& [dx, dy, second, expected] : cases)
      for (const float side : {-1.0f, 1.0f}) {
        std::vector<std::vector<float>> lines(edge_outputs, std::vector<float>(1 + beyond));
        const float values[edge_outputs] = {side * 1.2f, -side, 0, side * second, side, 0};
        std::vector<const float*> pointers;
        for (std::size_t k = 0; k < edge_outputs; ++k) {
          lines[k][0] = values[k];
          pointers.push_back(lines[k].data());
        }
        Crossings room;
        CrossingLists c = room.lists(1);
        c.count = 1;
        c.jumps[0] = 0;
        for (int k = 0; k < 8; ++k)
          if (Pixel::around[k][0] == dx && Pixel::around[k][1] == dy) c.jumps[0] = 1 << k;
        std::vector<Nearness> nearness(1 + beyond);
        steps->see_nearness(c, pointers.data(), 0.8f, 1.7f, nearness.data());
        EXPECT_EQ(nearness[0], expected) << dx << ' ' << dy << ' ' << second;
      }
}

// As one pixel after the other: by the rule that refine.cpp had for each.
TEST_F(StepsOfAntialiasing, FindFates) {
  constexpr std::size_t count = 203;
  constexpr float reach = 0.75f, farthest = 1.7f;
  std::vector<std::vector<float>> lines(edge_outputs, std::vector<float>(count + beyond));
  std::vector<const float*> pointers;
  for (auto& list : lines) {
    for (float& value : list) value = number(0, 1) < 0.1f ? any_number() : number(-2, 2);
    pointers.push_back(list.data());
  }
  for (std::size_t i = 0; i < count; i += 7) lines[1][i] = lines[2][i] = 0;
  Crossings room;
  CrossingLists c = room.lists(count);
  c.count = count;
  std::vector<Nearness> nearness(count + beyond);
  for (std::size_t i = 0; i < count; ++i) {
    const auto any = [&](float part) { return number(0, 1) < part ? 1 : 0; };
    c.hidden[i] = any(0.2f), c.unseen[i] = any(0.2f), c.enclosed[i] = any(0.5f);
    nearness[i] = static_cast<Nearness>(any(0.5f) + any(0.5f));
  }
  std::array<int, 9> seen{};
  for (const float bent : {0.0f, 1.2f})
    for (const Steps* steps : runnable()) {
      std::vector<std::int32_t> fates(count + beyond);
      steps->find_fates(c, pointers.data(), nearness.data(), {reach, farthest, bent}, fates.data());
      for (std::size_t i = 0; i < count; ++i) {
        const auto line = [&](std::size_t of) {
          const Line some{lines[of][i], lines[of + 1][i], lines[of + 2][i]};
          return some.nx == 0 && some.ny == 0 ? Line{no_edge, 1, 0} : some;
        };
        const Line a = line(0), b = line(3);
        const float nearest = std::abs(lines[0][i]), second = std::abs(lines[3][i]);
        std::int32_t expected = nearness[i] == Nearness::one_edge ? to_follow : 0;
        if (c.hidden[i] != 0) {
          expected = nearest < reach ? (second < farthest ? to_sample : to_follow) : 0;
        } else if (nearness[i] == Nearness::unclear) {
          expected = bent > 0 && !(second < reach) ? to_fit : to_sample;
        } else if (nearest >= reach && second < farthest && c.unseen[i] == 0 &&
                   a.distance * b.distance * (a.nx * b.nx + a.ny * b.ny) < 0) {
          expected = to_smooth;
        } else if (bent > 0 && nearness[i] == Nearness::out_of_reach) {
          expected = nearest < bent ? to_follow : c.enclosed[i] != 0 ? to_fit : 0;
        }
        EXPECT_EQ(fates[i], expected) << i;
        ++seen[static_cast<std::size_t>(expected)];
      }
    }
  for (const std::int32_t fate : {0, to_follow, to_sample, to_fit, to_smooth})
    EXPECT_GT(seen[static_cast<std::size_t>(fate)], 0) << fate;
}

TEST_F(StepsOfAntialiasing, JudgeSamplesAsDifferDoes) {
  constexpr std::size_t count = 85;
  constexpr float parts = 24;
  std::array<std::vector<float>, 6> lists;
  for (auto& list : lists)
    for (std::size_t i = 0; i < count + beyond; ++i)
      list.push_back(number(0, 1) < 0.2f ? any_number() : std::round(number(0, 8)) / 500);
  const auto& [low, high, from, to, least, most] = lists;
  std::vector<std::int32_t> asks(count + beyond);
  for (auto& ask : asks) ask = number(0, 1) < 0.7f ? -1 : 0;
  for (const Steps* steps : runnable()) {
    std::vector<std::int32_t> more(count + beyond), uneven(count + beyond);
    for (std::size_t i = 0; i < count; i += 5) more[i] = uneven[i] = -1;
    steps->judge({low.data(), high.data()}, {from.data(), to.data()}, asks.data(),
                 {least.data(), most.data()}, parts, count, {more.data(), uneven.data()});
    for (std::size_t i = 0; i < count; ++i) {
      const bool exceeds = (low[i] < from[i] && differ(low[i], from[i])) ||
                           (high[i] > to[i] && differ(high[i], to[i]));
      const bool is_uneven = differ(least[i], least[i] + (most[i] - least[i]) / parts);
      EXPECT_EQ(more[i] != 0, i % 5 == 0 || (exceeds && asks[i] != 0)) << low[i] << ' ' << from[i];
      EXPECT_EQ(uneven[i] != 0, i % 5 == 0 || is_uneven) << least[i] << ' ' << most[i];
    }
  }
}

TEST_F(StepsOfAntialiasing, PlaceSamples) {
  std::vector<float> dx(32), dy(32);
  for (float& offset : dx) offset = number(-1, 1);
  for (float& offset : dy) offset = number(-1, 1);
  for (const std::size_t each : {std::size_t{3}, std::size_t{8}, std::size_t{21}})
    for (const Steps* steps : runnable()) {
      std::vector<double> x(each + 1, -7), y(x);
      steps->place(1e5 + 0.5, 3.5, dx.data(), dy.data(), each, x.data(), y.data());
      for (std::size_t k = 0; k < each; ++k) {
        EXPECT_EQ(x[k], 1e5 + 0.5 + double(dx[k]));
        EXPECT_EQ(y[k], 3.5 + double(dy[k]));
      }
      EXPECT_EQ(x[each], -7);
      EXPECT_EQ(y[each], -7);
    }
}

TEST_F(StepsOfAntialiasing, SumUpSamples) {
  for (const std::size_t each : {std::size_t{1}, std::size_t{5}, std::size_t{8}, std::size_t{24}})
    for (const std::size_t count : {std::size_t{1}, std::size_t{8}, std::size_t{21}}) {
      std::vector<float> values(count * each);
      for (float& value : values) value = std::floor(number(-100, 100));
      std::vector<float> sums(count + beyond), lows(count + beyond), highs(count + beyond);
      for (const Steps* steps : runnable()) {
        steps->summarise(values.data(), count, each, {sums.data(), lows.data(), highs.data()});
        for (std::size_t k = 0; k < count; ++k) {
          const std::span<const float> of(&values[k * each], each);
          // Whole numbers: no order of adding rounds.
          float sum = 0;
          for (const float value : of) sum += value;
          EXPECT_EQ(sums[k], sum);
          EXPECT_EQ(lows[k], std::ranges::min(of));
          EXPECT_EQ(highs[k], std::ranges::max(of));
        }
      }
    }
}

}  // namespace
}  // namespace pse::antialias
