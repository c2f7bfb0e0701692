// Isolation by Bernstein coefficients, then Newton's method held in its bracket.
#include "surface/roots.h"

#include <algorithm>
#include <cmath>

namespace pse::surface {
namespace {

constexpr int deepest = 40;  // halvings; then a root counts as found
using Coefficients = std::array<double, most_roots + 1>;

constexpr double binomial(std::size_t n, std::size_t k) {
  double value = 1;
  for (std::size_t i = 1; i <= k; ++i) value = value * double(n - k + i) / double(i);
  return value;
}

struct Search {
  const double* power;
  std::size_t degree;
  bool first_only;
  bool from_end = false;
  Roots found{};

  bool full() const { return found.count == most_roots || (first_only && found.count > 0); }

  void value_and_slope(double x, double& value, double& slope) const {
    value = power[degree], slope = 0;
    for (std::size_t i = degree; i-- > 0;) slope = slope * x + value, value = value * x + power[i];
  }

  // The sign changes once within [a, b], where the values are at_a and at_b, of different sign or
  // 0. A value of 0 at an end is another root, at which this one must not stop.
  void refine(double a, double b, double at_a, double at_b, bool above) {
    double x = a + (b - a) * (at_a * at_b < 0 ? at_a / (at_a - at_b) : 0.5);
    for (int step = 0; step < 60; ++step) {
      double value, slope;
      value_and_slope(x, value, slope);
      if (value == 0) break;
      if ((value > 0) == above)
        a = x;
      else
        b = x;
      double next = slope != 0 ? x - value / slope : a;
      if (!(next > a && next < b)) next = 0.5 * (a + b);
      const bool done = std::abs(next - x) <= 1e-12 || next == a || next == b;
      x = next;
      if (done) break;
    }
    found.at[found.count++] = x;
  }

  void search(const Coefficients& c, double a, double b, int depth) {
    // Count changes of sign; coefficients of 0 have the sign before them.
    int changes = 0;
    double before = 0, first = 0;
    for (std::size_t i = 0; i <= degree; ++i) {
      if (c[i] == 0) continue;
      if (first == 0) first = c[i];
      if (before != 0 && (before > 0) != (c[i] > 0)) ++changes;
      before = c[i];
    }
    // A root at b belongs here, one at a to what lies before.
    const bool at_end = before != 0 && c[degree] == 0;
    if (at_end) ++changes;
    if (changes == 0 || full()) return;
    if (changes == 1 && at_end) {
      found.at[found.count++] = b;
      return;
    }
    if (changes == 1) return refine(a, b, c[0], c[degree], first > 0);
    if (depth == deepest) {
      found.at[found.count++] = 0.5 * (a + b);
      return;
    }
    // Halve, after de Casteljau.
    Coefficients left{}, right = c;
    left[0] = c[0];
    for (std::size_t level = 1; level <= degree; ++level) {
      for (std::size_t i = 0; i + level <= degree; ++i) right[i] = 0.5 * (right[i] + right[i + 1]);
      left[level] = right[0];
    }
    const double middle = 0.5 * (a + b);
    search(from_end ? right : left, from_end ? middle : a, from_end ? b : middle, depth + 1);
    if (!full())
      search(from_end ? left : right, from_end ? a : middle, from_end ? middle : b, depth + 1);
  }
};

// All roots in [0, 1] that are asked for; c: Bernstein coefficients.
Roots roots_of(const double* power, const Coefficients& c, std::size_t degree, Which which) {
  Search search{power, degree, which != Which::all, which == Which::last};
  const auto at_0 = [&] {
    if (c[0] == 0 && !search.full()) search.found.at[search.found.count++] = 0;
  };
  if (which != Which::last) at_0();
  search.search(c, 0, 1, 0);
  if (which == Which::last) at_0();
  return search.found;
}

}  // namespace

void to_bernstein(const double* coefficients, std::size_t degree, double* bernstein) {
  static const auto ratios = [] {
    std::array<std::array<std::array<double, most_roots + 1>, most_roots + 1>, most_roots + 1> r{};
    for (std::size_t n = 0; n <= most_roots; ++n)
      for (std::size_t i = 0; i <= n; ++i)
        for (std::size_t k = 0; k <= i; ++k) r[n][i][k] = binomial(i, k) / binomial(n, k);
    return r;
  }();
  for (std::size_t i = 0; i <= degree; ++i) {
    bernstein[i] = 0;
    for (std::size_t k = 0; k <= i; ++k) bernstein[i] += ratios[degree][i][k] * coefficients[k];
  }
}

Roots roots_in_unit(const double* coefficients, std::size_t degree, bool first_only) {
  Coefficients c{};
  to_bernstein(coefficients, degree, c.data());
  return roots_of(coefficients, c, degree, first_only ? Which::first : Which::all);
}

Roots roots_in_unit(const double* coefficients, const double* bernstein, std::size_t degree,
                    Which which) {
  Coefficients c{};
  std::copy_n(bernstein, degree + 1, c.begin());
  return roots_of(coefficients, c, degree, which);
}

}  // namespace pse::surface
