// Statements and blocks: assignment, knobs, indentation and braces, branches, loops, functions,
// actions.
#include "parsed.h"

namespace pse::test {

TEST(Statements, Assign) {
  EXPECT_EQ(tree_of("a = 1\nb += 2; c -= 3\nd *= 4\ne /= 5\nf ^= 6\ng **= 7"),
            "set a 1\nset_add b 2\nset_subtract c 3\nset_multiply d 4\nset_divide e 5\nset_power f "
            "6\nset_power g 7\n");
  EXPECT_EQ(tree_of("a[i] = 1\np.xy = q\nm[1, 2] += 3\nblink.Time = Time"),
            "set (index a i) 1\nset (member p xy) q\nset_add (index m 1 2) 3\nset (member blink "
            "Time) Time\n");
}

TEST(Statements, KnobsHaveMetadata) {
  EXPECT_EQ(tree_of("Radius = 0.4 [[ min = 0, max = 1, label = \"r\" ]]"),
            "set Radius 0.4 [min 0] [max 1] [label \"r\"]\n");
  EXPECT_EQ(tree_of("Tint = [1 0 0] [[widget = \"color\",]]"),
            "set Tint (vector 1 0 0) [widget \"color\"]\n");
  EXPECT_EQ(tree_of("Plain = 1 [[ ]]"), "set Plain 1\n");
  EXPECT_EQ(Parsed("radius = 0.4 [[ min = 0 ]]").summary(), "1:1 metadata-place");
  EXPECT_EQ(Parsed("Radius += 0.4 [[ min = 0 ]]").summary(), "1:15 metadata-place");
  EXPECT_EQ(Parsed("if a\n  Radius = 1 [[ min = 0 ]]").summary(), "2:14 metadata-place");
}

TEST(Statements, BlocksAreIndentedOrInBraces) {
  const std::string tree = "if a\n  set b 1\n  set c 2\nset d 3\n";
  for (const char* text : {
           "if a\n    b = 1\n    c = 2\nd = 3\n",
           "if a {\n b = 1\n c = 2\n}\nd = 3\n",
           "if a\n{\n b = 1\n c = 2\n}\nd = 3\n",
           "if a { b = 1; c = 2 } d = 3",
           "if a {\n        b = 1\n  c = 2 }\nd = 3\n",
           "if a:\n  b = 1;\n  c = 2;\nd = 3;\n",
           "if a then\n  b = 1; c = 2\nd = 3\n",
           "if (a) { b = 1\n c = 2 };\nd = 3\n",
           "\n\n  if a\n\n      b = 1 # x\n # y\n      c = 2\n\n  d = 3\n",
       })
    EXPECT_EQ(tree_of(text), tree) << text;
}

TEST(Statements, OneStatementMayFollowItsHead) {
  EXPECT_EQ(tree_of("if (x < 1) return 0\nelse return 1"),
            "if (less x 1)\n  return 0\nelse\n  return 1\n");
  EXPECT_EQ(tree_of("if a: b = 1; else c = 2"), "if a\n  set b 1\nelse\n  set c 2\n");
  EXPECT_EQ(
      tree_of("for i in [1 .. 3] if i > 1 s += i\nelse s -= i"),
      "for i (range 1 3)\n  if (greater i 1)\n    set_add s i\n  else\n    set_subtract s i\n");
  // Only one: what comes behind `;` is outside, and that is worth a warning.
  const Parsed two("if a b = 1; c = 2");
  EXPECT_EQ(two.tree(), "if a\n  set b 1\nset c 2\n");
  EXPECT_EQ(two.summary(), "1:13 one-statement-body");
}

TEST(Statements, BranchesFindTheirIf) {
  EXPECT_EQ(tree_of("if a\n  x = 1\nelse if b\n  x = 2\nelif c\n  x = 3\nelse\n  x = 4\n"),
            "if a\n  set x 1\nelse_if b\n  set x 2\nelse_if c\n  set x 3\nelse\n  set x 4\n");
  EXPECT_EQ(tree_of("if a\n  if b\n    x = 1\nelse\n  x = 2\n"),
            "if a\n  if b\n    set x 1\nelse\n  set x 2\n");
  EXPECT_EQ(tree_of("if a\n  if b\n    x = 1\n  else\n    x = 2\n"),
            "if a\n  if b\n    set x 1\n  else\n    set x 2\n");
  EXPECT_EQ(tree_of("if a { x = 1 }\nelse { x = 2 }\n"), "if a\n  set x 1\nelse\n  set x 2\n");
  EXPECT_EQ(tree_of("if a {\n  x = 1\n} else\n  x = 2\ny = 3"),
            "if a\n  set x 1\nelse\n  set x 2\nset y 3\n");
  EXPECT_EQ(tree_of("while a { if b\n      x = 1\n    else\n      x = 2\n}"),
            "while a\n  if b\n    set x 1\n  else\n    set x 2\n");
  EXPECT_EQ(tree_of("if a\n  x = 1\nelse\n  if b\n    x = 2\n"),
            "if a\n  set x 1\nelse\n  if b\n    set x 2\n");
}

TEST(Statements, LoopsAndFunctions) {
  EXPECT_EQ(tree_of("while (a > b) a -= 1"), "while (greater a b)\n  set_subtract a 1\n");
  EXPECT_EQ(tree_of("for c in center\n  n += c\n  break\n  continue\n"),
            "for c center\n  set_add n c\n  break\n  continue\n");
  EXPECT_EQ(tree_of("for t in [0 .. 1 by 0.5] s += t"), "for t (range 0 1 0.5)\n  set_add s t\n");
  EXPECT_EQ(tree_of("function f(a, b = 2,)\n  return a * b\nfunction g() { return }"),
            "function f a b=2\n  return (multiply a b)\nfunction g\n  return\n");
  EXPECT_EQ(tree_of("import marble\nimport fire as f"), "import marble\nimport fire as f\n");
}

TEST(Statements, MovementsOnlyInActions) {
  EXPECT_EQ(tree_of("action a { (X, 1), add (Y, 2); jitter 0.3, jitter -0.5, wink (W) }"),
            "action a\n  movement X 1\n  add_movement Y 2\n  mix_action jitter 0.3\n  mix_action "
            "jitter (negate 0.5)\n"
            "  mix_action wink W\n");
  EXPECT_EQ(tree_of("(X, 1)\nadd (X, 2)"), "evaluate (tuple X 1)\nevaluate (call add X 2)\n");
  EXPECT_EQ(tree_of("action a\n  if (c) (X, 1)\n  else jitter T / 2\n"),
            "action a\n  if c\n    movement X 1\n  else\n    mix_action jitter (divide T 2)\n");
}

}  // namespace pse::test
