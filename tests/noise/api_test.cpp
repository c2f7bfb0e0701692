// The public noise functions give what the language's functions of the same names give.
#include <gtest/gtest.h>

#include "builtin_run.h"
#include "pse/noise.h"

namespace pse::test {
namespace {

TEST(NoiseApi, GivesTheLanguagesNumbers) {
  const std::array p = {3.3f, -8.25f, 101.5f};
  const Vectors at = {{p.begin(), p.end()}};
  const std::vector<std::pair<std::string, std::vector<float>>> seed = {{"seed", {7}}};
  EXPECT_EQ(noise(p), run_builtin("Noise", at)[0]);
  EXPECT_EQ(noise(p, 7), run_builtin("Noise", at, seed)[0]);
  EXPECT_EQ(noise({3.3f, -8.25f, 101.5f}), noise(p));
  EXPECT_EQ(pnoise({3.3f, -8.25f, 101.5f}, {5, 6, 7}), pnoise(p, {5, 6, 7}));
  EXPECT_EQ(dnoise({3.3f, -8.25f, 101.5f}), dnoise(p));
  EXPECT_EQ(noise(3.3f), run_builtin("Noise", {{3.3f}})[0]);
  EXPECT_EQ(pnoise(p, {5, 6, 7}, 7), run_builtin("pnoise", {at[0], {5, 6, 7}}, seed)[0]);
  EXPECT_EQ(dnoise(p)[1], run_builtin("Dnoise", at)[1]);
  EXPECT_EQ(vnoise(p, 7)[2], run_builtin("vnoise", at, seed)[2]);
  EXPECT_EQ(noise1985(p, 7), run_builtin("noise1985", at, seed)[0]);
  EXPECT_EQ(noise1989(p), run_builtin("noise1989", at)[0]);
  EXPECT_EQ(book_noise(p), run_builtin("book_noise", at)[0]);
}

}  // namespace
}  // namespace pse::test
