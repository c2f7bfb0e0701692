// Roots of polynomials of degree 6, four at once: roots.h in lanes, for revolution_packet.h, which
// says why nothing here may be kept out of line. First the ends of an interval with one root are
// found, by halving in Bernstein form after de Casteljau, then the root in it.
#pragma once

#include "surface/lanes.h"

namespace pse::surface::revolution {

namespace {

// Of the Bernstein coefficients: how often the sign changes, where those of 0 have the sign before
// them, and the first sign, 1 or -1. A root at the end counts as a change, one at the beginning
// does not: it belongs to what lies before.
struct Signs {
  Lanes changes{}, first{};
};

[[gnu::always_inline]] inline Signs signs(const Lanes (&bernstein)[7]) {
  Signs signs;
  Lanes before{};
  for (const Lanes& c : bernstein) {
    signs.changes += choose(before * c < 0, Lanes{} + 1, Lanes{});
    const Lanes sign = choose(c > 0, Lanes{} + 1, choose(c < 0, Lanes{} - 1, before));
    signs.first = choose(signs.first == 0, sign, signs.first);
    before = sign;
  }
  signs.changes += choose((bernstein[6] == 0) & (before != 0), Lanes{} + 1, Lanes{});
  return signs;
}

// An interval in which a polynomial has one root, or the root itself where that is at its end: the
// values at the ends, of different sign or 0; `above`: whether it falls.
struct Bracket {
  Lanes a, b, at_a, at_b;
  Answers above;
};

// Polynomials of several roots in [0, 1], of which the first is looked for, or the last: the answer
// says which have been found in a few halvings. `sure` loses those that may have a root and have
// not been found; `open` are the ones that are asked for.
[[gnu::always_inline]] inline Answers isolate(Answers open, const Lanes (&bernstein)[7],
                                              Answers last, Bracket& bracket, Answers& sure) {
  constexpr int most_halvings = 12;
  // The last root is the first from the other end.
  Lanes c[7];
  for (int i = 0; i < 7; ++i) c[i] = choose(last, bernstein[6 - i], bernstein[i]);
  Lanes begin{}, size = begin + 1, first{};
  Answers found{}, left_behind{};
  // From there a root at the end would be one at the beginning.
  sure &= ~(open & last & (c[0] == 0));
  open &= sure;
  for (int round = 0; round < most_halvings && any(open); ++round) {
    Lanes left[7], right[7];
    for (int i = 0; i < 7; ++i) right[i] = c[i];
    left[0] = c[0];
    for (int level = 1; level < 7; ++level) {
      for (int i = 0; i + level < 7; ++i) right[i] = 0.5 * (right[i] + right[i + 1]);
      left[level] = right[0];
    }
    // Into the first half that may have a root.
    const Signs of_left = signs(left), of_right = signs(right);
    const Answers into_left = of_left.changes > 0;
    const Lanes changes = choose(into_left, of_left.changes, of_right.changes);
    for (int i = 0; i < 7; ++i) c[i] = choose(open, choose(into_left, left[i], right[i]), c[i]);
    size = choose(open, 0.5 * size, size);
    begin = choose(open & ~into_left, begin + size, begin);
    first = choose(open, choose(into_left, of_left.first, of_right.first), first);
    left_behind |= open & into_left & (of_right.changes > 0);
    sure &= ~(open & (changes == 0) & left_behind);
    found |= open & (changes == 1);
    open &= changes > 1;
  }
  sure &= ~open;
  const Lanes end = begin + size;
  begin = choose(c[6] == 0, end, begin);
  bracket.a = choose(found, choose(last, 1 - end, begin), bracket.a);
  bracket.b = choose(found, choose(last, 1 - begin, end), bracket.b);
  bracket.at_a = choose(found, choose(last, c[6], c[0]), bracket.at_a);
  bracket.at_b = choose(found, choose(last, c[0], c[6]), bracket.at_b);
  bracket.above = (found & ((first > 0) ^ last)) | (~found & bracket.above);
  return found;
}

// The only root in the bracket of polynomials (rising powers): Halley's method, held in it. After a
// short step s less than s^2 f'' / 2 f' is left, so that no step is taken to see that the
// one before was the last.
[[gnu::always_inline]] inline Lanes refine(Answers open, const Lanes (&power)[7],
                                           const Bracket& bracket) {
  constexpr double near = 1e-13, is_short = 1e-5;
  Lanes a = bracket.a, b = bracket.b;
  const Lanes share = bracket.at_a / (bracket.at_a - bracket.at_b);
  Lanes x = a + (b - a) * choose(bracket.at_a * bracket.at_b < 0, share, Lanes{} + 0.5);
  open &= a < b;
  for (int step = 0; step < 60 && any(open); ++step) {
    Lanes value = power[6], slope{}, bend{};  // bend: half the second derivative
    for (int i = 6; i-- > 0;) {
      bend = bend * x + slope;
      slope = slope * x + value;
      value = value * x + power[i];
    }
    const Answers before = (value > 0) == bracket.above;
    a = choose(before, x, a), b = choose(before, b, x);
    const Lanes back = value * slope / (slope * slope - value * bend), jump = x - back;
    const Answers inside = (jump > a) & (jump < b), found = value == 0;
    const Lanes next = choose(inside, jump, 0.5 * (a + b));
    const Answers arrived = inside & (size(back) <= is_short) &
                            (back * back * size(bend) <= near * size(slope));
    const Answers done = found | arrived | (next == a) | (next == b);
    x = choose(open & ~found, next, x);
    open &= ~done;
  }
  return x;
}

}  // namespace

}  // namespace pse::surface::revolution
