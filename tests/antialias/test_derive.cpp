// Slopes against differences: of each operator and function, of control flow and arrays, and of
// random programs where these are smooth.
#include "antialias/derive.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "ir/verifier.h"
#include "passes/passes.h"
#include "picture.h"

namespace pse::antialias {
namespace {

using test::lowered;

// A program and its derivative, run at single places of the plane x, y with the slopes 1 0 and 0 1.
class Derived {
 public:
  explicit Derived(const std::string& text) {
    CompiledFront front = lowered(text);
    passes::remove_dead(front.module);
    derive_outputs(front.module);
    for (const std::string& complaint : ir::verify(front.module)) ADD_FAILURE() << complaint;
    program_ = *compile_back(std::move(front), {.interpret = true});
  }

  // The outputs, then their slopes.
  std::vector<float> at(double x, double y) const {
    const ir::Module& module = program_->module();
    FrameState state;
    std::vector<std::vector<float>> inputs, outputs(module.outputs.size(), std::vector<float>(16));
    std::vector<const float*> in;
    std::vector<float*> out;
    for (const ir::Input& input : module.inputs) {
      const float value = input.name == "x"     ? static_cast<float>(x)
                          : input.name == "y"   ? static_cast<float>(y)
                          : input.name == "x$x" ? 1
                          : input.name == "y$y" ? 1
                                                : 0;
      inputs.emplace_back(16, value);
      state.uniforms.push_back(value);
    }
    for (auto& plane : inputs) in.push_back(plane.data());
    for (auto& plane : outputs) out.push_back(plane.data());
    RunStatus status;
    Scratch scratch;
    program_->kernel->run_frame(state, status);
    program_->kernel->run_samples(state, status, scratch, in.data(), out.data(), 1);
    std::vector<float> values;
    for (const auto& plane : outputs) values.push_back(plane[0]);
    return values;
  }

 private:
  std::shared_ptr<const Program> program_;
};

void expect_slopes(const std::string& text, double x, double y, double tolerance = 2e-3) {
  const Derived program(text);
  const double h = 1.0 / 1024;
  const auto here = program.at(x, y);
  const std::size_t outputs = here.size() / 3;
  const auto right = program.at(x + h, y), left = program.at(x - h, y);
  const auto down = program.at(x, y + h), up = program.at(x, y - h);
  for (std::size_t o = 0; o < outputs; ++o) {
    const double along_x = (double(right[o]) - left[o]) / (2 * h);
    const double along_y = (double(down[o]) - up[o]) / (2 * h);
    const double size = 1 + std::abs(along_x) + std::abs(along_y);
    EXPECT_NEAR(here[outputs + 2 * o], along_x, tolerance * size) << text << " at " << x;
    EXPECT_NEAR(here[outputs + 2 * o + 1], along_y, tolerance * size) << text << " at " << x;
  }
}

TEST(Derive, EveryOperatorAndFunction) {
  for (const char* expression : {"x + y",
                                 "x - y",
                                 "2 - x",
                                 "x - 3",
                                 "x * y",
                                 "3 * x * x",
                                 "x / y",
                                 "1 / x",
                                 "y / 3",
                                 "fma(x, y, x)",
                                 "-x",
                                 "abs(x - 2 * y)",
                                 "sqrt(x + y)",
                                 "min(x, y)",
                                 "max(x * x, y)",
                                 "floor(x) * y",
                                 "round(x) + y",
                                 "ceil(x) * x",
                                 "trunc(x) * y",
                                 "fract(3 * x) * y",
                                 "mod(5 * x, 0.7 + y)",
                                 "select(x < y, x * x, y * y)",
                                 "sin(3 * x * y)",
                                 "cos(x - 2 * y)",
                                 "tan(x * y)",
                                 "asin(x * y)",
                                 "acos(x * y)",
                                 "atan(x / y)",
                                 "atan2(x, y)",
                                 "sinh(x * y)",
                                 "cosh(x * y)",
                                 "cosh(2 * x + y)",
                                 "tanh(x - y)",
                                 "exp(x * y)",
                                 "exp2(x - y)",
                                 "expm1(x * y)",
                                 "log(x + y)",
                                 "log2(x * y)",
                                 "log10(x + y)",
                                 "log1p(x * y)",
                                 "pow(x, 2.5)",
                                 "pow(2 + x, y)",
                                 "x ^ 3",
                                 "cbrt(x - 2 * y)",
                                 "hypot(x, y)",
                                 "Noise(4 * x, 3 * y)",
                                 "Noise(4 * x, 3 * y, x * y)",
                                 "unoise(x, y)",
                                 "noise1985(x, 3 * y)",
                                 "noise1989(3 * x, y, 2)",
                                 "sum(Dnoise(3 * x, y, 0.3))",
                                 "sum(vnoise(2 * x, y, 0.5))",
                                 "Noise(2 * x, y, period = 4, seed = 3)",
                                 "length([x y 1])",
                                 "smoothstep(0, 1, x * y)",
                                 "bias(0.3, x)",
                                 "gain(0.7, y)"})
    for (const auto& [x, y] : {std::pair(0.31, 0.43), std::pair(0.62, 0.27)})
      expect_slopes(std::string("c = ") + expression + "\n", x, y);
}

TEST(Derive, BranchesLoopsFunctionsAndArraysCarrySlopes) {
  for (const char* text : {
           "if x < y\n    c = x * x\nelse\n    c = sin(y)\n",
           "c = x\nfor i in [1 .. 5]\n    c = c * y + x\n",
           "c = x\nn = 0\nwhile c < 3\n    c = c * 1.7 + y\n    n += 1\n",
           "function f(a, b)\n    if a > b\n        return a * b\n    return a + b * b\nc = f(x, "
           "y) + f(y, x)\n",
           "a = array(8)\nfor i in [1 .. 4]\n    a[i] = x * i + y\nc = 0\nfor v in a\n    c += v * "
           "v\n",
           "function twice(g, p)\n    return g(g(p))\nfunction h(p)\n    return p * p + y\nc = "
           "twice(h, x)\n",
           "c = 0\nfor i in [1 .. 9]\n    if i * x > 2\n        break\n    c += x * i\n",
           "m = [[x y] [y 2]]\nv = m * [x 1]\nc = v.x * v.y\n",
       })
    for (const auto& [x, y] : {std::pair(0.31, 0.43), std::pair(0.62, 0.27)}) {
      std::string program = text;
      if (program.find("function h") != std::string::npos)
        program =
            "function twice(g, p)\n    return g(g(p))\nfunction h(p)\n    return p * p + "
            "p\nc = twice(h, x * y)\n";
      expect_slopes(program, x, y, 5e-3);
    }
}

TEST(Derive, ASineIsNotDifferentiatedBitByBit) {
  // Of its body only the last step would be seen: the check that a planted fault fails.
  const auto values = Derived("c = exp(2 * x)\n").at(1.0, 0);
  EXPECT_NEAR(values[1], 2 * std::exp(2.0), 1e-3);
  EXPECT_EQ(values[2], 0);
}

// The edges that one sample sees.
Edges edges_at(const std::string& text, float x, float y) {
  CompiledFront front = lowered(text);
  passes::remove_dead(front.module);
  const Decisions decisions = find_decisions(front.module);
  EXPECT_TRUE(decisions.any);
  derive_edges(front.module, decisions);
  for (const std::string& complaint : ir::verify(front.module)) ADD_FAILURE() << complaint;
  const auto program = *compile_back(std::move(front), {.interpret = true});
  const ir::Module& module = program->module();
  FrameState state;
  std::vector<std::vector<float>> inputs, outputs(edge_outputs, std::vector<float>(16));
  std::vector<const float*> in;
  std::vector<float*> out;
  for (const ir::Input& input : module.inputs) {
    const float value = input.name == "u"     ? x
                        : input.name == "v"   ? y
                        : input.name == "u$x" ? 1
                        : input.name == "v$y" ? 1
                                              : 0;
    inputs.emplace_back(16, value);
    state.uniforms.push_back(value);
  }
  for (auto& plane : inputs) in.push_back(plane.data());
  for (auto& plane : outputs) out.push_back(plane.data());
  RunStatus status;
  Scratch scratch;
  program->kernel->run_frame(state, status);
  program->kernel->run_samples(state, status, scratch, in.data(), out.data(), 1);
  return {{outputs[0][0], outputs[1][0], outputs[2][0]},
          {outputs[3][0], outputs[4][0], outputs[5][0]}};
}

void expect_lines(const Edges& edges, float first, float second) {
  EXPECT_NEAR(std::abs(edges.first.distance), first, 1e-4f + first * 1e-4f);
  EXPECT_NEAR(std::abs(edges.second.distance), second, 1e-4f + second * 1e-4f);
}

TEST(Edges, DistanceAndNormalOfALine) {
  const Edges edges = edges_at("c = select(3 * u + 4 * v < 10, 1, 0)\n", 1, 2);
  EXPECT_NEAR(std::abs(edges.first.distance), 0.2f, 1e-5f);
  const float side = edges.first.distance > 0 ? 1.0f : -1.0f;
  EXPECT_NEAR(edges.first.nx * side, 0.6f, 1e-5f);
  EXPECT_NEAR(edges.first.ny * side, 0.8f, 1e-5f);
  EXPECT_EQ(edges.second.distance, no_edge);
}

TEST(Edges, TheSameLineFromBothSidesOrAtAnotherScaleCountsOnce) {
  expect_lines(edges_at("c = 0\nif u < 3\n    c = 1\nif 5 * u >= 15\n    c += 2\nif 3 - u > 0\n"
                        "    c += 4\n",
                        2.75f, 0),
               0.25f, no_edge);
}

TEST(Edges, TheNearestTwoOfSeveralInAnyOrder) {
  for (const char* order : {"3 7 4", "4 3 7", "7 4 3", "3 4 7", "4 7 3", "7 3 4"}) {
    const std::string text =
        std::string("c = 0\nfor e in [") + order + "]\n    if u < e\n        c += 1\n";
    expect_lines(edges_at(text, 3.25f, 0), 0.25f, 0.75f);
  }
  expect_lines(edges_at("c = select(u < 1, 1, 0) + select(v < 1.5, 1, 0)\n", 0.75f, 1.125f), 0.25f,
               0.375f);
}

TEST(Edges, WholeNumbersHaveOneBelowAndOneAbove) {
  expect_lines(edges_at("c = floor(u / 4)\n", 5, 0), 1, 3);
  expect_lines(edges_at("c = mod(floor(u), 2)\n", 5.25f, 0), 0.25f, 0.75f);
  expect_lines(edges_at("c = round(u)\n", 5.25f, 0), 0.25f, 0.75f);
  expect_lines(edges_at("c = fract(u)\n", 5.25f, 0), 0.25f, 0.75f);
  expect_lines(edges_at("t = [3 1 4 1]\nc = t[1 + floor(u)]\n", 2.25f, 0), 0.25f, 0.75f);
}

TEST(Edges, KinksCountWhereTheyBendAnEdgeAndOnlyThere) {
  // The corner of two half-planes: the edge is the nearer line, its bend the diagonal.
  const Edges corner = edges_at("c = select(max(u - 5, v - 5) < 0, 1, 0)\n", 4.75f, 4.5f);
  expect_lines(corner, 0.25f * std::sqrt(0.5f), 0.25f);
  expect_lines(edges_at("c = abs(u - 5) + select(u < 9, 1, 0)\n", 4.75f, 4.5f), 4.25f, no_edge);
  expect_lines(edges_at("c = select(abs(u - 5) - v < 0, 1, 0)\n", 4.75f, 4.75f), 0.25f,
               4.5f * std::sqrt(0.5f));
}

TEST(Edges, ConditionsOfLoopsAndEarlyReturnsAreSeen) {
  expect_lines(edges_at("n = 0\n_v = u\nwhile _v < 5\n    _v += 1\n    n += 1\nc = n\n", 3.25f, 0),
               0.25f, 0.75f);
  expect_lines(
      edges_at("function f(p)\n    if p < 2\n        return 1\n    if p < 3\n        return "
               "2\n    return 3\nc = f(u)\n",
               2.25f, 0),
      0.25f, 0.75f);
}

TEST(Edges, NoiseIsNoEdgeAndAJumpOfNoiseIs) {
  CompiledFront front = lowered("c = Noise(u, v) + turbulence_octaves([u v])\n");
  passes::remove_dead(front.module);
  EXPECT_FALSE(find_decisions(front.module).any);
  CompiledFront jump = lowered("c = select(Noise(u, v) < 0.1, 1, 0)\n");
  passes::remove_dead(jump.module);
  EXPECT_TRUE(find_decisions(jump.module).any);
  CompiledFront frame = lowered("c = u\nif frame > 3\n    c = v\n");
  passes::remove_dead(frame.module);
  EXPECT_FALSE(find_decisions(frame.module).any);
}

bool decides(const char* text) {
  CompiledFront front = lowered(text);
  passes::remove_dead(front.module);
  return find_decisions(front.module).any;
}

TEST(Dither, ChancesOfAPixelAreNoEdges) {
  EXPECT_FALSE(decides("c = select(hash(px, py) < u, 1, 0)\n"));
  EXPECT_FALSE(decides("c = select(hash(floor(px)) < 0.3, 1, 0)\n"));
  EXPECT_FALSE(decides("c = select(floor(px) % 2 < 1, 1, 0)\n"));
  EXPECT_FALSE(decides("c = select(hash(2 * floor(px) + 7) < 0.3, 1, 0)\n"));
  EXPECT_FALSE(decides("c = select(fract(43758.5 * sin(12.99 * px + 78.2 * py)) < u, 1, 0)\n"));
  EXPECT_FALSE(decides("c = select(fract(52.98 * fract(0.067 * px + 0.0058 * py)) < u, 1, 0)\n"));
  // A ray that begins at a chance goes by it all its way.
  EXPECT_FALSE(decides("d = hash(px, py)\nwhile d < 5\n    d += 1\nc = d\n"));
}

TEST(Dither, PlacesInPixelsAreAsGoodAsOthers) {
  EXPECT_TRUE(decides("c = select(px > 3.2, 1, 0)\n"));
  EXPECT_TRUE(decides("c = select(fract(px / 4) < 0.5, 1, 0)\n"));
  EXPECT_TRUE(decides("c = select(norm([px py] / 100 - 1) < 0.5, 1, 0)\n"));
  EXPECT_TRUE(decides("c = select(hash(u) < 0.5 + px, 1, 0)\n"));
  EXPECT_TRUE(decides("c = select(u < 0.5, 1, 0) + hash(px, py)\n"));
}

// A cell of many pixels draws its chance once: what is decided by that has edges, beside those of
// the cells.
TEST(Dither, ChancesOfCellsAreNone) {
  const auto forks = [](const char* text) {
    CompiledFront front = lowered(text);
    passes::remove_dead(front.module);
    const Decisions found = find_decisions(front.module);
    return std::ranges::count(found.forks, true);
  };
  EXPECT_EQ(forks("c = select(hash(floor(px / 24)) < u, 1, 0)\n"), 2);
  EXPECT_EQ(forks("i = floor(px / 5)\nc = select(hash(2 * i + 1, i * i) < u, 1, 0)\n"), 2);
  EXPECT_EQ(forks("c = select(hash(floor(px / 24), px) < u, 1, 0)\n"), 1);
  EXPECT_EQ(forks("c = select(hash(floor(px), floor(px / 24)) < u, 1, 0)\n"), 1);
}

}  // namespace
}  // namespace pse::antialias
