// Expressions: precedence, vectors with and without commas, calls, elements, members.
#include "parsed.h"

namespace pse::test {

TEST(Expressions, BindInTheirOrder) {
  EXPECT_EQ(expression("a + b * c"), "(add a (multiply b c))");
  EXPECT_EQ(expression("a - b - c"), "(subtract (subtract a b) c)");
  EXPECT_EQ(expression("a / b % c * d"), "(multiply (modulo (divide a b) c) d)");
  EXPECT_EQ(expression("a < b + 1 and c == d or not e > f"),
            "(or (and (less a (add b 1)) (equal c d)) (not (greater e f)))");
  EXPECT_EQ(expression("a && b || !c"), "(or (and a b) (not c))");
  EXPECT_EQ(expression("not not a"), "(not (not a))");
  EXPECT_EQ(expression("a ? b : c ? d : e"), "(choose a b (choose c d e))");
  EXPECT_EQ(expression("a ? b ? 1 : 2 : 3"), "(choose a (choose b 1 2) 3)");
  EXPECT_EQ(expression("a or b ? c + 1 : d"), "(choose (or a b) (add c 1) d)");
}

TEST(Expressions, PowersGoRightToLeftAndBeforeTheMinusOnTheirLeft) {
  EXPECT_EQ(expression("2 ^ 3 ** 2"), "(power 2 (power 3 2))");
  EXPECT_EQ(expression("-a ^ b"), "(negate (power a b))");
  EXPECT_EQ(expression("a ^ -b ^ c"), "(power a (negate (power b c)))");
  EXPECT_EQ(expression("-a * b"), "(multiply (negate a) b)");
  EXPECT_EQ(expression("f(x).y ^ 2"), "(power (member (call f x) y) 2)");
}

TEST(Expressions, VectorsWithoutCommasSeparateByWhiteSpace) {
  EXPECT_EQ(expression("[1 -2 3]"), "(vector 1 (negate 2) 3)");
  EXPECT_EQ(expression("[1 - 2 3]"), "(vector (subtract 1 2) 3)");
  EXPECT_EQ(expression("[1-2 3]"), "(vector (subtract 1 2) 3)");
  EXPECT_EQ(expression("[a -b]"), "(vector a (negate b))");
  EXPECT_EQ(expression("[f (x)]"), "(vector f x)");
  EXPECT_EQ(expression("[f(x) g]"), "(vector (call f x) g)");
  EXPECT_EQ(expression("[a [1]]"), "(vector a (vector 1))");
  EXPECT_EQ(expression("[a[1] b]"), "(vector (index a 1) b)");
  EXPECT_EQ(expression("[a * -b c]"), "(vector (multiply a (negate b)) c)");
  EXPECT_EQ(expression("[a (b -c) d]"), "(vector a (subtract b c) d)");
  EXPECT_EQ(expression("[f(a -b) c]"), "(vector (call f (subtract a b)) c)");
  EXPECT_EQ(expression("[a ? b -c : d e]"), "(vector (choose a (subtract b c) d) e)");
  EXPECT_EQ(expression("[1\n -2\n 3]"), "(vector 1 (negate 2) 3)");
  EXPECT_EQ(expression("[[1 0] [0 1]]"), "(vector (vector 1 0) (vector 0 1))");
  EXPECT_EQ(expression("[.5 .25]"), "(vector 0.5 0.25)");
  EXPECT_EQ(expression("[p.x -p.y]"), "(vector (member p x) (negate (member p y)))");
}

TEST(Expressions, VectorsWithCommasDoNot) {
  EXPECT_EQ(expression("[a -b, c]"), "(vector (subtract a b) c)");
  EXPECT_EQ(expression("[f (x), y]"), "(vector (call f x) y)");
  EXPECT_EQ(expression("[1, 2, 3,]"), "(vector 1 2 3)");
  EXPECT_EQ(expression("[a -b,]"), "(vector (subtract a b))");
  EXPECT_EQ(expression("[]"), "(vector)");
  EXPECT_EQ(expression("[[1 -1], [2 -2]]"), "(vector (vector 1 (negate 1)) (vector 2 (negate 2)))");
}

TEST(Expressions, ParenthesesGroupAndMakeTuples) {
  EXPECT_EQ(expression("(a)"), "a");
  EXPECT_EQ(expression("(a, b)"), "(tuple a b)");
  EXPECT_EQ(expression("((a, b))"), "(tuple a b)");
  EXPECT_EQ(expression("(a + b)[1]"), "(index (add a b) 1)");
  EXPECT_EQ(expression("(a +\n b\n)"), "(add a b)");
}

TEST(Expressions, CallsElementsAndMembers) {
  EXPECT_EQ(expression("f()"), "(call f)");
  EXPECT_EQ(expression("f (a, k = b + 1,)"), "(call f a k=(add b 1))");
  EXPECT_EQ(expression("m.f(x)"), "(call (member m f) x)");
  EXPECT_EQ(expression("a[i, j]"), "(index a i j)");
  EXPECT_EQ(expression("a[1][2].xy"), "(member (index (index a 1) 2) xy)");
  EXPECT_EQ(expression("a[n -1]"), "(index a (subtract n 1))");
  EXPECT_EQ(expression("timeCurve((0,0),(1,1))"), "(call timeCurve (tuple 0 0) (tuple 1 1))");
  EXPECT_EQ(expression("texture(\"a.exr\", u, v, layer = \"N\")"),
            "(call texture \"a.exr\" u v layer=\"N\")");
}

TEST(Expressions, WordsThatMeanMoreInTheirPlaceAreNamesElsewhere) {
  EXPECT_EQ(expression("in + as * by"), "(add in (multiply as by))");
  EXPECT_EQ(tree_of("for in in in(a)\n  add = then\n"), "for in (call in a)\n  set add then\n");
}

TEST(Expressions, SpansCoverTheirText) {
  const Parsed parsed("abc = (1 + f(x)[2]) * 3\n");
  const auto& assign = std::get<lang::AssignStmt>(parsed.program.body[0]->node);
  const auto& product = std::get<lang::BinaryExpr>(assign.value->node);
  EXPECT_EQ(parsed.sources.text(parsed.program.body[0]->span), "abc = (1 + f(x)[2]) * 3");
  EXPECT_EQ(parsed.sources.text(assign.value->span), "(1 + f(x)[2]) * 3");
  EXPECT_EQ(parsed.sources.text(product.left->span), "(1 + f(x)[2])");
  EXPECT_EQ(parsed.sources.text(product.op_span), "*");
  const auto& sum = std::get<lang::BinaryExpr>(product.left->node);
  EXPECT_EQ(parsed.sources.text(sum.right->span), "f(x)[2]");
}

TEST(Expressions, AloneAsOnTheCommandLine) {
  SourceMap sources;
  Diagnostics diagnostics;
  const lang::ExprPtr value =
      lang::parse_expression(sources, sources.add("<arg>", "[1 -2] * 3"), diagnostics);
  ASSERT_TRUE(value);
  EXPECT_TRUE(std::holds_alternative<lang::BinaryExpr>(value->node));
  EXPECT_FALSE(lang::parse_expression(sources, sources.add("<arg>", "1 2"), diagnostics));
  EXPECT_FALSE(lang::parse_expression(sources, sources.add("<arg>", ""), diagnostics));
  EXPECT_FALSE(lang::parse_expression(sources, sources.add("<arg>", "(1"), diagnostics));
  EXPECT_FALSE(lang::parse_expression(sources, sources.add("<arg>", "1\nx = 2"), diagnostics));
  EXPECT_EQ(diagnostics.error_count(), 4u);
}

}  // namespace pse::test
