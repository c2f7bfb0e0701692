// Roots of polynomials by isolation: a polynomial in Bernstein form has at most as many roots in
// its interval as its coefficients change sign, so intervals are halved until there is one root or
// none. No root is lost however close two lie, which is what closed formulas for quartics cannot
// promise.
#pragma once

#include <array>
#include <cstddef>

namespace pse::surface {

inline constexpr std::size_t most_roots = 6;

struct Roots {
  std::array<double, most_roots> at{};
  std::size_t count = 0;
};

// The roots in [0, 1], ends included, of c[0] + c[1] x + ... + c[degree] x^degree, rising; degree
// up to 6. Double roots may be given once, twice or not at all. `first_only` stops at the least
// one.
Roots roots_in_unit(const double* coefficients, std::size_t degree, bool first_only);

// The same for a polynomial whose Bernstein coefficients are known as well; both of degree + 1. All
// roots, or only the least or the greatest.
enum class Which { all, first, last };
Roots roots_in_unit(const double* coefficients, const double* bernstein, std::size_t degree,
                    Which which);
void to_bernstein(const double* coefficients, std::size_t degree, double* bernstein);

}  // namespace pse::surface
