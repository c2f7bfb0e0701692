// Builtins as programs call them: names, binding of arguments, messages, and the same bits as the
// C++ templates.
#include "builtin_run.h"

#include <gtest/gtest.h>

#include <functional>
#include <random>
#include <set>

#include "noise/book_noise.h"
#include "noise/improved.h"
#include "noise/noise1985.h"
#include "noise/noise1989.h"
#include "noise/seed.h"

namespace pse::test {
namespace {

TEST(Builtins, NamesAreUniqueAndAliasesLead) {
  std::set<std::string_view> names;
  for (const Builtin& builtin : builtins()) {
    EXPECT_TRUE(names.insert(builtin.name).second) << builtin.name;
    if (builtin.same_as.empty())
      EXPECT_FALSE(builtin.doc.empty()) << builtin.name;
    else
      EXPECT_NE(find_builtin(builtin.same_as), nullptr) << builtin.name;
  }
  EXPECT_EQ(find_builtin("nothing_like_it"), nullptr);
}

TEST(Builtins, PositionMayBeAVectorOrNumbers) {
  const auto whole = run_builtin("Noise", {{0.25f, 0.5f, 0.75f}});
  EXPECT_EQ(whole, run_builtin("noise", {{0.25f}, {0.5f}, {0.75f}}));
  EXPECT_EQ(whole, run_builtin("snoise", {{0.25f, 0.5f}, {0.75f}}));
  EXPECT_EQ(run_builtin("pnoise", {{0.25f, 0.5f, 8.75f}, {4}}),
            run_builtin("Noise", {{0.25f, 0.5f, 0.75f}}, {{"period", {4, 4, 4}}}));
  EXPECT_NEAR(whole.at(0), -0.2697153091430664, 2e-7);
}

TEST(Builtins, ElementwiseRepeatsNumbers) {
  EXPECT_EQ(run_builtin("sqrt", {{1, 4, 9}}), (std::vector<float>{1, 2, 3}));
  EXPECT_EQ(run_builtin("max", {{1, 5, 9}, {4}}), (std::vector<float>{4, 5, 9}));
}

TEST(Builtins, SaysWhatIsWrong) {
  const auto error = [](const char* name, const Vectors& arguments,
                        const std::vector<std::pair<std::string, std::vector<float>>>& named = {}) {
    return BuiltinProgram(name, arguments, named).error;
  };
  EXPECT_EQ(error("sqrt", {}), "`sqrt(a)` needs a value for `a`");
  EXPECT_EQ(error("sqrt", {{1}, {2}}), "too many arguments for `sqrt(a)`");
  EXPECT_EQ(error("sqrt", {{1}}, {{"seed", {1}}}), "`sqrt(a)` has no parameter `seed`");
  EXPECT_EQ(error("max", {{1, 2}, {1, 2, 3}}),
            "`max` takes vectors of one length, and these have 2 and 3 components");
  EXPECT_EQ(error("Noise", {{1, 2, 3, 4, 5}}),
            "`Noise` takes a position of 1 to 4 coordinates, and this has 5");
  EXPECT_EQ(error("pnoise", {{1, 2, 3}}),
            "`pnoise(p..., period, seed = 0)` needs a value for `period`");
  EXPECT_EQ(error("pnoise", {{1, 2, 3}, {4, 4}}),
            "the period of `pnoise` is one number or one for each of the 3 coordinates");
  EXPECT_EQ(error("Noise", {{1, 2, 3}}, {{"seed", {1, 2}}}), "the seed of `Noise` is one number");
  EXPECT_EQ(error("book_noise", {{1, 2}}),
            "`book_noise` takes a position of 3 coordinates, and this has 2");
  EXPECT_EQ(error("book_noise", {{1, 2, 3}}, {{"seed", {1}}}),
            "`book_noise(p...)` has no parameter `seed`");
  EXPECT_EQ(error("dot", {{1, 2, 3}, {1, 2}}),
            "`dot` takes two vectors of one length, and these have 3 and 2 components");
}

TEST(Builtins, LargeBodiesAreWrittenOnce) {
  ir::Module module;
  module.functions.reserve(1 + BuiltinEmitter::room_for_builtins);
  ir::Builder builder(module, module.functions.emplace_back());
  BuiltinEmitter emitter(module);
  const Components point(3, builder.const_f32(0.5f));
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(emitter.emit(builder, {"Noise", {point}, {}}));
  EXPECT_EQ(module.functions.size(), 2u);
  EXPECT_EQ(module.byte_tables.size(), 1u);
  EXPECT_EQ(module.float_tables.size(), 3u);
}

// A builtin and the template that it is made of.
struct Pair {
  const char* name;
  std::function<std::vector<float>(const std::vector<float>&)> direct;
};

// The builtins of N coordinates, each with the C++ library's way to the same numbers.
template <std::size_t N>
std::vector<Pair> pairs(const num::NoiseOptions<float, N>& options) {
  using Point = std::array<float, N>;
  const auto point = [](const std::vector<float>& at) {
    Point p;
    std::copy_n(at.begin(), N, p.begin());
    return p;
  };
  const auto number = [point](auto function) {
    return [=](const std::vector<float>& at) { return std::vector{function(point(at))}; };
  };
  const auto several = [point](auto function) {
    return [=](const std::vector<float>& at) {
      const auto result = function(point(at));
      return std::vector<float>(result.begin(), result.end());
    };
  };
  std::vector<Pair> list = {
      {"Noise", number([=](Point p) { return num::improved_noise(p, options); })},
      {"Dnoise", several([=](Point p) {
         return num::gradient(num::improved_noise(num::variables(p), options));
       })},
      {"vnoise", several([=](Point p) { return num::improved_vector_noise(p, options); })},
      {"noise1985", number([=](Point p) { return num::noise_1985(p, options); })},
      {"Dnoise1985", several([=](Point p) {
         return num::gradient(num::noise_1985(num::variables(p), options));
       })},
      {"noise1989", number([=](Point p) { return num::noise_1989(p, options); })},
      {"Dnoise1989", several([=](Point p) {
         return num::gradient(num::noise_1989(num::variables(p), options));
       })},
  };
  if constexpr (N == 3) {
    if (!options.period && !options.key) {
      list.push_back({"book_noise", number([=](Point p) { return num::book_noise(p); })});
      list.push_back({"Dbook_noise", several([=](Point p) {
                        return num::gradient(num::book_noise(num::variables(p)));
                      })});
    }
  }
  return list;
}

// The IR that a template writes gives the template's own bits.
template <std::size_t N>
void noise_agrees(bool periodic, bool seeded) {
  num::NoiseOptions<float, N> options;
  std::vector<std::pair<std::string, std::vector<float>>> named;
  if (periodic) {
    options.period.emplace();
    for (std::size_t axis = 0; axis < N; ++axis)
      (*options.period)[axis] = static_cast<float>(3 + 4 * axis);
    named.emplace_back("period",
                       std::vector<float>(options.period->begin(), options.period->end()));
  }
  if (seeded) {
    options.key = num::key_of_seed(3.0f);
    named.emplace_back("seed", std::vector{3.0f});
  }
  for (const Pair& pair : pairs(options)) {
    const BuiltinProgram program(pair.name, {std::vector<float>(N)}, named);
    std::mt19937 random(N);
    std::uniform_real_distribution<float> coordinate(-300.0f, 300.0f);
    for (int i = 0; i < 120; ++i) {
      std::vector<float> inputs = program.inputs;
      for (std::size_t k = 0; k < N; ++k)
        inputs[k] = i < 80 ? coordinate(random) : std::ldexp(coordinate(random), i - 80);
      const auto expected = pair.direct(inputs), found = program.run(inputs);
      ASSERT_EQ(expected.size(), found.size());
      for (std::size_t k = 0; k < found.size(); ++k) {
        ASSERT_TRUE(same(expected[k], found[k]))
            << pair.name << " in " << N << "-D at " << inputs[0];
      }
    }
  }
}

TEST(Builtins, NoiseAgreesWithTheTemplates) {
  for (const bool periodic : {false, true}) {
    for (const bool seeded : {false, true}) {
      noise_agrees<1>(periodic, seeded);
      noise_agrees<2>(periodic, seeded);
      noise_agrees<3>(periodic, seeded);
      noise_agrees<4>(periodic, seeded);
    }
  }
}

}  // namespace
}  // namespace pse::test
