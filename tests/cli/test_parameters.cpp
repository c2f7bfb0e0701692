// What hypertexture() and glass() are given and cannot mean is told of: boxes without room, steps
// that are too many or one, no rays, indices of refraction out of range, colours that miss parts.
#include "run_pse.h"

namespace pse::test {
namespace {

class Parameters : public CommandLine {
 protected:
  // How a render of `color = call` ends; density is a ball, `tint` glass of this index.
  Ended rendered(const std::string& call, const std::string& index = "1 + 0.5 * d") {
    file("a.pse",
         "function density(p)\n    return soft_sphere(p, 0.8, 0.1)\n"
         "function tint(d)\n    return [0.1 0.1 0.1 0 " +
             index +
             "]\n"
             "function four(d)\n    return [0.1 0.1 0.1 d]\n"
             "function six(d)\n    return [0.1 0.1 0.1 d 1.5 2]\n"
             "function single(d)\n    return 0.5\n"
             "function three(p)\n    return p\n"
             "color = " +
             call + "\n");
    return pse({"render", "a.pse", "-o", "a.exr", "--res", "8x8"});
  }
  std::string said(const std::string& call, const std::string& index = "1 + 0.5 * d") {
    const Ended ended = rendered(call, index);
    EXPECT_EQ(ended.status, 0) << call << "\n" << ended.err;
    return ended.err;
  }
  static std::size_t warnings(const std::string& text) {
    std::size_t count = 0;
    for (std::size_t at = text.find("[expect]"); at != std::string::npos;
         at = text.find("[expect]", at + 1))
      ++count;
    return count;
  }
};

TEST_F(Parameters, ThatCannotBeMeantAreToldOfOnce) {
  const std::string box = "`density` lies in a box without room, which rays pass without a look";
  const std::string rays = "`density` is not seen by as many rays as `samples` says";
  const std::string many = "`density` would take more than 4096 steps of a ray";
  const std::string once = "`density` is looked at once by a ray at most";
  const std::string hard = "`density` stops no light, or all of it";
  const std::string flat = "`density` has no normal";
  const std::string ball = "`density` is not cut off by a ball";
  const std::string mirror = "`density` has a surface whose `mirror` is no index of refraction";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"bound = 0", box},
      {"bound = -1", box},
      {"bound = NAN", box},
      {"bound = [1 0 1]", box},
      {"bound = [1 1 NAN]", box},
      {"samples = 0", rays},
      {"samples = -3", rays},
      {"samples = NAN", rays},
      {"samples = 1025, step = 1, shadows = 0, crevices = 0", rays},
      {"step = 0.000000001, samples = 1", many},
      {"step = 1000000000", once},
      {"hardness = 0", hard},
      {"hardness = -1", hard},
      {"hardness = NAN", hard},
      {"hardness = INF", hard},
      {"epsilon = 0", flat},
      {"epsilon = -0.1", flat},
      {"epsilon = NAN", flat},
      {"ball = NAN", ball},
      {"ball = -1", ball},
      {"mirror = 0", mirror},
      {"mirror = -1", mirror},
      {"mirror = 0.5", mirror},
      {"mirror = NAN", mirror},
      {"mirror = INF", mirror},
  };
  for (const auto& [given, text] : cases) {
    SCOPED_TRACE(given);
    for (const char* call : {"hypertexture(density, ", "glass(density, tint, "}) {
      const bool is_glass = call[0] == 'g';
      if (is_glass ? given.starts_with("ball") || given.find("shadows") != std::string::npos
                   : given.starts_with("mirror"))
        continue;
      const std::string err = said(call + given + ")");
      EXPECT_TRUE(contains(err, "a.pse:1:10: warning: " + text + " at 64 pixels, first at (0, 0)"));
      EXPECT_TRUE(contains(err, "help: "));
      EXPECT_EQ(warnings(err), 1u) << err;
    }
  }
}

// Steps towards the light are counted where there is something to be lit.
TEST_F(Parameters, OfShadowsAreToldOfWhereTheyAreUsed) {
  const std::string err =
      said("hypertexture(density, shadow_step = 0.00001, step = 0.1, samples = 1)");
  EXPECT_TRUE(contains(err, "a.pse:1:10: warning: `density` would take more than 4096 steps"));
  EXPECT_FALSE(contains(err, "at 64 pixels"));
  EXPECT_EQ(
      said("hypertexture(density, shadow_step = 0.00001, step = 0.1, samples = 1, shadows = 0)")
          .find("warning"),
      std::string::npos);
}

TEST_F(Parameters, AtTheLimitsAreSilent) {
  for (const char* given :
       {"samples = 1", "samples = 4.5", "samples = 1024, step = 2, shadows = 0, crevices = 0",
        "bound = 0.001, step = 0.002", "bound = [1 2 0.5]", "step = 3, bound = 1", "ball = 0",
        "ball = 0.5", "step = 0.00125, samples = 1, shadows = 0, crevices = 0"})
    EXPECT_FALSE(said(std::string("hypertexture(density, ") + given + ")").contains("warning"))
        << given;
  for (const char* given : {"", ", mirror = 1", ", mirror = 10", ", mirror = 100"})
    EXPECT_FALSE(said(std::string("glass(density, tint") + given + ")").contains("warning"))
        << given;
}

TEST_F(Parameters, IndicesOutOfRangeAreToldOf) {
  for (const char* index :
       {"0.05", "0.5", "1 - 0.01 * d", "1 / 1.5", "11", "1 + 9.5 * d", "1 + 1000000 * d"}) {
    SCOPED_TRACE(index);
    const std::string err = said("glass(density, tint, samples = 1)", index);
    EXPECT_TRUE(
        contains(err, "a.pse:3:10: warning: `tint` gives an index of refraction outside [1, "));
    EXPECT_TRUE(contains(err, "a bubble in water has 1.33 at density 0"));
    EXPECT_EQ(warnings(err), 1u) << err;
  }
  // A bubble in water is no mistake, whatever rounding leaves of its index.
  for (const char* index : {"1", "10", "1 + 9 * d", "1.33 - 0.33 * d", "lerp(d, 1.33, 1)"})
    EXPECT_FALSE(said("glass(density, tint, samples = 1)", index).contains("warning")) << index;
  for (const char* none : {"0", "-1.5", "0 / 0"})
    EXPECT_NE(rendered("glass(density, tint)", none).status, 0) << none;
}

TEST_F(Parameters, ColoursThatMissPartsAreErrorsThatSaySo) {
  for (const char* call : {"glass(density, four)", "glass(density, single)", "glass(density, six)",
                           "hypertexture(density, single)"}) {
    SCOPED_TRACE(call);
    const Ended ended = rendered(call);
    EXPECT_NE(ended.status, 0);
    EXPECT_TRUE(contains(ended.err, "a.pse:13:9: error: "));
    EXPECT_TRUE(contains(ended.err, "compute_color has to give "));
    EXPECT_FALSE(ended.err.contains("outside 1..")) << ended.err;
    EXPECT_EQ(ended.err.find("error:"), ended.err.rfind("error:")) << ended.err;
  }
}

// The function that gave NaN is the one that is told of, the colour's before the light's.
TEST_F(Parameters, ColoursThatAreNoneAreToldOf) {
  const std::string programs =
      "function density(p)\n    return soft_sphere(p, 0.8, 0.1)\n"
      "function dark(d, p)\n    return [sqrt(p.x) 0.5 0.2]\n"
      "function shade(c, p)\n    return c * sqrt(p.x)\n"
      "function shine(p, d)\n    return [sqrt(p.x) 0.5 0.2]\n";
  const std::vector<std::pair<std::string, int>> cases = {
      {"hypertexture(density, dark)", 3},
      {"hypertexture(density, dark, shade)", 3},
      {"hypertexture(density, dark, luminous, shaded = false)", 3},
      {"hypertexture(density, clay, shade)", 5},
      {"raymarch(density, shine, [x y 2], [0 0 -1], 0, 4).rgb", 7},
  };
  for (const auto& [call, line] : cases) {
    SCOPED_TRACE(call);
    file("a.pse", programs + "color = " + call + "\n");
    const std::string err = pse({"render", "a.pse", "-o", "a.exr", "--res", "16x16"}).err;
    EXPECT_TRUE(contains(err, "a.pse:" + std::to_string(line) + ":10: warning: `"));
    EXPECT_TRUE(contains(err, "gives rays NaN for a colour at "));
    EXPECT_EQ(warnings(err), 1u) << err;
  }
  file("a.pse", programs + "color = hypertexture(density, clay)\n");
  EXPECT_EQ(pse({"render", "a.pse", "-o", "a.exr", "--res", "16x16"}).err.find("warning"),
            std::string::npos);
}

// What follows from one error is no other.
TEST_F(Parameters, ADensityThatIsAVectorIsOneError) {
  const Ended ended = rendered("hypertexture(three)");
  EXPECT_NE(ended.status, 0);
  EXPECT_TRUE(contains(ended.err, "`three` is used as a density and has to return one number"));
  EXPECT_EQ(ended.err.find("error:"), ended.err.rfind("error:")) << ended.err;
}

}  // namespace
}  // namespace pse::test
