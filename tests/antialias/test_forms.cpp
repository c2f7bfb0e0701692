// How values change with the place: the rules of sums, products, quotients and choices against
// functions whose form is known.
#include "antialias/forms.h"

#include <gtest/gtest.h>

#include "passes/passes.h"
#include "picture.h"

namespace pse::antialias::test {
namespace {

Kind kind_of(const std::string& expression, Folds folds = Folds::seen) {
  CompiledFront front = lowered("A = 3\nc = " + expression + "\n");
  passes::remove_dead(front.module);
  const Decisions decisions = find_decisions(front.module);
  return find_forms(front.module, decisions, folds)[front.module.main().body.yields[0]].kind;
}

TEST(Forms, AreThoseOfTheCalculus) {
  using enum Kind;
  for (const auto& [expression, kind] :
       {std::pair("A * A", constant), std::pair("floor(x * y)", constant),
        std::pair("x * y < 1 ? A : 2", constant), std::pair("x", linear),
        std::pair("2 * x - A * y + 1", linear), std::pair("x / A", linear),
        std::pair("x < y ? x : y", linear), std::pair("min(x, -y)", linear),
        std::pair("1 / (x + y)", reciprocal), std::pair("A / x", reciprocal),
        std::pair("x / y", ratio), std::pair("x < 0 ? 1 / x : 1 / y", ratio),
        std::pair("x * y", bent), std::pair("x / (y * y)", bent), std::pair("1 / x + 1 / y", bent),
        std::pair("sqrt(x)", bent), std::pair("sin(x)", bent), std::pair("noise(x, y)", bent),
        std::pair("x < 0 ? x : x * x", bent)})
    EXPECT_EQ(kind_of(expression), kind) << expression;
}

// Both quotients are over the same value.
TEST(Forms, RatiosOverOneValueAddUp) {
  CompiledFront front = lowered("d = x + y\nc = y * (1 / d) + 2 / d\n");
  passes::remove_dead(front.module);
  const Decisions decisions = find_decisions(front.module);
  const Form form =
      find_forms(front.module, decisions, Folds::seen)[front.module.main().body.yields.back()];
  EXPECT_EQ(form.kind, Kind::ratio);
  EXPECT_NE(form.by, ir::no_value);
}

TEST(Forms, FoldsBendWhatNobodyWatches) {
  EXPECT_EQ(kind_of("abs(x)", Folds::seen), Kind::linear);
  EXPECT_EQ(kind_of("abs(x)", Folds::unseen), Kind::bent);
  EXPECT_EQ(kind_of("abs(A)", Folds::unseen), Kind::constant);
  EXPECT_EQ(kind_of("abs(1 / x)", Folds::seen), Kind::reciprocal);
}

// What one turn hands on to the next, however many turns it takes to show.
TEST(Forms, LoopsAreFollowedUntilNothingChanges) {
  const auto kind = [](const std::string& turn) {
    CompiledFront front = lowered("a = x\nb = 1\nc = 1\nfor i in [1 .. 9]\n" + turn);
    passes::remove_dead(front.module);
    const Decisions decisions = find_decisions(front.module);
    return find_forms(front.module, decisions,
                      Folds::unseen)[front.module.main().body.yields.back()]
        .kind;
  };
  EXPECT_EQ(kind("    c = c + 2\n"), Kind::constant);
  EXPECT_EQ(kind("    c = c + a\n"), Kind::linear);
  EXPECT_EQ(kind("    c = b\n    b = a\n"), Kind::linear);
  EXPECT_EQ(kind("    c = b\n    b = a\n    a = a * x\n"), Kind::bent);
}

// A march's end is no sum of its steps, though each is linear.
TEST(Forms, OfSearchesNothingIsKnown) {
  CompiledFront front = lowered("c = 0\nwhile c < x\n    c += 0.1 * (2 + y)\n");
  passes::remove_dead(front.module);
  const Decisions decisions = find_decisions(front.module);
  const auto forms = find_forms(front.module, decisions, Folds::unseen);
  EXPECT_EQ(forms[front.module.main().body.yields[0]].kind, Kind::bent);
}

}  // namespace
}  // namespace pse::antialias::test
