// Kernels against closed forms, against the reference's numbers, and against themselves: what they
// say of an edge must be what their own samples say.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "antialias/filter.h"
#include "antialias/spread.h"

namespace pse::antialias {
namespace {

using enum FilterKind;
constexpr FilterKind kinds[] = {cubic, box, disc, cone, paraboloid, gauss};

TEST(Filter, TheChaptersCubicAtItsEndsItsMiddleAndAQuarter) {
  const Filter filter;
  EXPECT_EQ(filter.share(-0.5f, 1, 0), 0);
  EXPECT_EQ(filter.share(0.5f, 1, 0), 1);
  EXPECT_EQ(filter.share(0, 0.6f, 0.8f), 0.5f);
  EXPECT_NEAR(filter.share(0.25f, 1, 0), 3 * 0.75 * 0.75 - 2 * 0.75 * 0.75 * 0.75, 1e-6);
  EXPECT_NEAR(filter.share(-0.1f, 1, 0), 3 * 0.4 * 0.4 - 2 * 0.4 * 0.4 * 0.4, 1e-6);
  EXPECT_FLOAT_EQ(filter.moment(0, 1, 0), 1.5f / 16);
  EXPECT_EQ(filter.share(3, 1, 0), 1);
  EXPECT_EQ(filter.share(-3, 1, 0), 0);
}

TEST(Filter, ReferenceNumbers) {
  std::ifstream file(PSE_SOURCE_DIR "/../shared/reference/antialias.json");
  if (!file) GTEST_SKIP() << "the reference numbers are not here";
  const auto json = nlohmann::json::parse(file);
  for (const auto& row : json["half_plane_box"]["rows"]) {
    const double angle = row["theta_deg"].get<double>() * std::numbers::pi / 180;
    EXPECT_NEAR(Filter(box).share(row["d"].get<float>(), static_cast<float>(std::cos(angle)),
                                  static_cast<float>(std::sin(angle))),
                row["coverage"].get<double>(), 2e-6)
        << row;
  }
  for (const auto& row : json["half_plane_radial_kernels"]["rows"]) {
    const float d = row["d"].get<float>();
    EXPECT_NEAR(Filter(gauss).share(d, 1, 0), row["gauss_sigma0.5"].get<double>(), 1e-6);
    EXPECT_NEAR(Filter(disc).share(d, 1, 0), row["disc_R1"].get<double>(), 2e-6);
    EXPECT_NEAR(Filter(cone).share(d, 1, 0), row["cone_R1"].get<double>(), 2e-6);
    EXPECT_NEAR(Filter(paraboloid).share(d, 1, 0), row["paraboloid_R1"].get<double>(), 2e-6);
  }
}

TEST(Filter, WhatACircleHolds) {
  for (const FilterKind kind : kinds)
    for (const float scale : {1.0f, 1.5f}) {
      const Filter filter(kind, scale);
      constexpr std::uint32_t count = 1 << 14;
      const Spread spread(3, 5);
      for (const float radius : {0.1f, 0.4f, 0.7f, 1.3f, 4.0f})
        for (const float away : {-0.9f, -0.3f, 0.2f, 0.5f}) {
          const float x = 0.6f * (radius + away * filter.reach()), y = -x / 0.6f * 0.8f;
          double share = 0, at_x = 0, at_y = 0;
          for (std::uint32_t k = 0; k < count; ++k) {
            const auto [u, v] = spread(k);
            const auto [px, py] = filter.place(u, v);
            if ((px - x) * (px - x) + (py - y) * (py - y) >= radius * radius) continue;
            share += 1.0 / count, at_x += px / count, at_y += py / count;
          }
          const Filter::Within in = filter.within(x, y, radius);
          EXPECT_NEAR(in.share, share, 1.5e-3)
              << static_cast<int>(kind) << ' ' << radius << ' ' << away;
          EXPECT_NEAR(in.x, at_x, 1.5e-3 * filter.reach())
              << static_cast<int>(kind) << ' ' << radius;
          EXPECT_NEAR(in.y, at_y, 1.5e-3 * filter.reach())
              << static_cast<int>(kind) << ' ' << radius;
        }
      // A large one is straight.
      EXPECT_NEAR(filter.within(60.1f, 0, 60).share, filter.share(-0.1f, 1, 0), 5e-3);
      EXPECT_EQ(filter.within(4, 0, 0.5f).share, 0);
      EXPECT_EQ(filter.within(0.1f, 0.1f, 5).share, 1);
    }
  EXPECT_NEAR(Filter().within(0, 0, 0.3f).share, 1 - std::pow(1 - 4 * 0.09, 1.5), 1e-5);
  EXPECT_NEAR(Filter(box).within(0, 0, 0.6f).share, 0.9509111307851082, 1e-5);
  EXPECT_NEAR(Filter(disc).within(0, 0, 0.5f).share, 0.25, 1e-5);
}

TEST(Filter, SharesAndMomentsAreThoseOfItsSamples) {
  constexpr std::uint32_t count = 1 << 14;
  for (const FilterKind kind : kinds)
    for (const float scale : {1.0f, 1.5f}) {
      const Filter filter(kind, scale);
      const Spread spread(3, 5);
      for (const float degrees : {0.0f, 17.0f, 45.0f, 80.0f}) {
        const float nx = std::cos(degrees * 0.0174533f), ny = std::sin(degrees * 0.0174533f);
        for (const float d : {-0.4f, -0.1f, 0.0f, 0.2f, 0.45f}) {
          double inside = 0, moment = 0;
          for (std::uint32_t i = 0; i < count; ++i) {
            const auto [u, v] = spread(i);
            const auto [x, y] = filter.place(u, v);
            const float along = x * nx + y * ny;
            if (along > -d) inside += 1, moment += along;
            ASSERT_LE(std::hypot(x, y), filter.reach() * 1.0001f);
          }
          EXPECT_NEAR(filter.share(d, nx, ny), inside / count, 2e-3)
              << int(kind) << " " << degrees << " " << d;
          EXPECT_NEAR(filter.moment(d, nx, ny), moment / count, 2e-3)
              << int(kind) << " " << degrees << " " << d;
        }
      }
    }
}

TEST(Filter, VarianceIsThatOfItsSamples) {
  for (const FilterKind kind : kinds)
    for (const float scale : {1.0f, 1.5f}) {
      const Filter filter(kind, scale);
      constexpr std::uint32_t count = 1 << 12;
      double sum = 0;
      for (std::uint32_t i = 0; i < count; ++i) {
        const auto [x, y] = filter.place(Spread(3, 5)(i)[0], Spread(3, 5)(i)[1]);
        sum += (x * x + y * y) / 2;
      }
      EXPECT_NEAR(filter.variance(), sum / count, 3e-3 * scale * scale) << int(kind);
    }
}

TEST(Spread, EveryBoxOfADyadicGridHasOnePoint) {
  const Spread spread(12, -7);
  for (const int columns : {1, 2, 4, 8, 16, 32, 64}) {
    const int rows = 64 / columns;
    std::vector<int> hits(64);
    for (std::uint32_t i = 64; i < 128; ++i) {
      const auto [u, v] = spread(i);
      ++hits[static_cast<std::size_t>(static_cast<int>(u * static_cast<float>(columns)) * rows +
                                      static_cast<int>(v * static_cast<float>(rows)))];
    }
    EXPECT_EQ(hits, std::vector<int>(64, 1)) << columns;
  }
  EXPECT_NE(Spread(1, 2)(0), Spread(2, 1)(0));
}

}  // namespace
}  // namespace pse::antialias
