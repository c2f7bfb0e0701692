// Densities that are none, and what else a program expects in vain: the warning says where, at how
// many pixels, and the same however the picture is computed.
#include "run_pse.h"

namespace pse::test {
namespace {

// Parallel rays through 8x8 pixels; x of their columns is -0.875, -0.625 ... 0.875, and y of their
// rows 0.875 ... -0.875.
std::string marched(const std::string& density) {
  return "function density(p)\n    return " + density +
         "\nfunction glow(p)\n    return [1 0.5 0.2]\n"
         "c = raymarch(density, glow, [x y 2], [0 0 -1], 1, 3, 0.25, 10)\n"
         "color = [c.r c.g c.b]\n";
}

class Expectations : public CommandLine {
 protected:
  // What a render of the program says.
  std::string said(const std::string& program, const std::vector<std::string>& more = {},
                   const std::string& to = "a.exr") {
    file("a.pse", program);
    std::vector<std::string> words = {"render", "a.pse", "-o", to, "--res", "8x8"};
    words.insert(words.end(), more.begin(), more.end());
    const Ended ended = pse(words);
    EXPECT_EQ(ended.status, 0) << ended.err;
    return ended.err;
  }
};

TEST_F(Expectations, PointAtTheDensity) {
  for (const char* what : {"0 / 0", "sqrt(-1 - p.x)", "1e30", "-1e30", "1 / 0", "-1 / 0", "NAN"}) {
    SCOPED_TRACE(what);
    const std::string err = said(marched("p.x > 0.2 ? " + std::string(what) + " : 0.1"));
    EXPECT_TRUE(contains(err, "a.pse:1:10: warning: `density` "));
    EXPECT_TRUE(contains(err, "at 24 pixels, first at (5, 0) of frame 0 [expect]"));
    EXPECT_TRUE(contains(err, "help: NaN is taken for empty, "));
  }
  EXPECT_TRUE(contains(said(marched("p.x > 0.8 and p.y < -0.8 ? NAN : 0")),
                       "at 1 pixel, first at (7, 7) of frame 0"));
}

TEST_F(Expectations, AreSilentWhereDensitiesAre) {
  // What is cut to [0, 1] by rule.
  for (const char* what : {"7", "-3", "1000000", "p.x > 0"})
    EXPECT_FALSE(said(marched(what)).contains("warning")) << what;
  // Behind opaque matter, where no ray comes.
  EXPECT_FALSE(said(marched("p.z < -0.5 ? NAN : 1000")).contains("warning"));
  EXPECT_TRUE(contains(said(marched("p.z > 0.5 ? NAN : 1000")), "at 64 pixels, first at (0, 0)"));
}

// As many pixels, whatever computes them and in what order.
TEST_F(Expectations, CountPixelsOnce) {
  file("a.pse",
       "function density(p)\n"
       "    if p.x + p.y > 0.3 return 0 / 0\n"
       "    return 4 * (0.9 - norm(p))\n"
       "color = hypertexture(density, samples = 2, step = 0.1, shadow_step = 0.3)\n");
  const auto counted = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"render", "a.pse", "-o", "a.exr", "--res", "24x20"};
    words.insert(words.end(), more.begin(), more.end());
    const Ended ended = pse(words);
    EXPECT_EQ(ended.status, 0) << ended.err;
    const std::size_t begin = ended.err.find(" at "), end = ended.err.find(" [expect]");
    EXPECT_NE(end, std::string::npos) << ended.err;
    EXPECT_EQ(ended.err.find("[expect]", end + 3), std::string::npos) << ended.err;
    return ended.err.substr(begin, end - begin);
  };
  const std::string once = counted({});
  const std::vector<std::vector<std::string>> ways = {{"--tile", "5", "--threads", "2"},
                                                      {"--tile", "64", "--threads", "1"},
                                                      {"--antialias", "none"},
                                                      {"--samples", "3", "--tile", "7"},
                                                      {"--interpret"},
                                                      {"--tier", "first"},
                                                      {"--tier", "optimised"},
                                                      {"--width", "1"},
                                                      {"--width", "16"},
                                                      {"--quiet"},
                                                      {"--nan", "black"}};
  for (const std::vector<std::string>& more : ways) EXPECT_EQ(counted(more), once) << more[0];
  // Beside the window nothing counts.
  file("a.pse", marched("p.x > 0.2 ? NAN : 0"));
  EXPECT_TRUE(contains(said(marched("p.x > 0.2 ? NAN : 0"), {"--clip", "4,2,7,5"}),
                       "at 6 pixels, first at (5, 2)"));
  EXPECT_FALSE(
      said(marched("p.x > 0.2 ? NAN : 0"), {"--clip", "0,0,5,8"}).contains("warning"));
}

// Of the first frame in which it is so.
TEST_F(Expectations, AreToldOfTheFirstFrame) {
  const std::string err =
      said(marched("frame > 1 and p.x > 0.2 ? NAN : 0"), {"-f", "0-3"}, "a.%d.exr");
  EXPECT_TRUE(contains(err, "at 24 pixels, first at (5, 0) of frame 2 [expect]"));
  EXPECT_EQ(err.find("[expect]"), err.rfind("[expect]"));
}

TEST_F(Expectations, OfSurfacesCountTheirPixels) {
  const std::string err = said(
      "function density(p)\n    return NAN\n"
      "function glow(p)\n    return white\n"
      "c = raymarch(density, glow, point, normal, 0, 1, 0.5)\ncolor = [c.r c.g c.b]\n",
      {"--on", "plane"});
  EXPECT_TRUE(contains(err, "a.pse:1:10: warning: `density` "));
  EXPECT_TRUE(contains(err, " pixels, first at ("));
}

// A slice and a bake show such numbers themselves.
TEST_F(Expectations, LeaveSlicesAndBakesToTheirOwnWarnings) {
  EXPECT_TRUE(contains(said("function density(p)\n    return p.x > 0.2 ? NAN : 0\n",
                            {"--slice", "z=0"}),
                       "[not-finite]"));
  file("b.pse", "function density(p)\n    return p.x > 0.2 ? NAN : 1 - norm(p)\n"
                "function glow(p)\n    return white\n"
                "light = raymarch(density, glow, point, [0 0 1])\n");
  const Ended ended = pse({"bake", "b.pse", "-o", "b.vdb", "--res", "8"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_TRUE(contains(ended.err, "[not-finite]"));
}

// Where the prepass finds no matter nothing is looked at.
TEST_F(Expectations, FollowThePrepass) {
  const std::string program =
      "function density(p)\n    return p.x > 0.2 ? 1e30 : 0\n"
      "function glow(p)\n    return [1 0.5 0.2]\n"
      "color = raymarch(density, glow, [x y 2], [0 0 -1], 1, 3, 0.25, 10)\n";
  EXPECT_TRUE(contains(said(program, {"--prepass", "2"}), "at 24 pixels, first at (5, 0)"));
}

TEST_F(Expectations, AreForAnyProgram) {
  const std::string program =
      "v = expect(x, x < 0.2, \"x is large\", \"make it smaller\")\ncolor = [v v v]\n";
  const std::string err = said(program);
  EXPECT_TRUE(contains(err, "a.pse:1:5: warning: x is large at 24 pixels, first at (5, 0)"));
  EXPECT_TRUE(contains(err, "help: make it smaller"));
  const Ended whole = pse({"render", "a.pse", "-o", "b.exr", "--res", "8x8", "--interpret"});
  EXPECT_EQ(whole.err.substr(whole.err.find("a.pse")), err.substr(err.find("a.pse")));
  // The value is what it was.
  file("plain.pse", "v = x\ncolor = [v v v]\n");
  ASSERT_EQ(pse({"render", "plain.pse", "-o", "plain.exr", "--res", "8x8"}).status, 0);
  EXPECT_EQ(pse({"diff", "a.exr", "plain.exr"}).status, 0);
  // Of what nobody wants nothing is computed, and nothing said.
  EXPECT_FALSE(said("function f(p)\n    v = expect(p, p < 0.2, \"large\")\n    return 1\n"
                    "color = white * f(x)\n")
                   .contains("warning"));
}

TEST_F(Expectations, AreChecked) {
  file("a.pse", "color = white * expect(x, x < 1)\n");
  EXPECT_TRUE(contains(pse({"check", "a.pse"}).err, "`expect` takes 3 to 5 arguments"));
  file("a.pse", "color = white * expect(x, x < 1, 7)\n");
  EXPECT_TRUE(contains(pse({"check", "a.pse"}).err, "a text"));
  file("a.pse", "color = white * expect(x, [1 2], \"a\")\n");
  EXPECT_TRUE(contains(pse({"check", "a.pse"}).err, "a condition"));
}

}  // namespace
}  // namespace pse::test
