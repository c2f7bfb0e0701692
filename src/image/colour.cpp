// Colour arithmetic; see colour.h.
#include "image/colour.h"

#include <bit>
#include <cmath>

namespace pse::image {
namespace {

// Recommendation ITU-R BT.709, and the AP1 primaries of S-2014-004 (ACEScg) with the ACES white.
constexpr Chromaticities rec709 = {{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}, {0.3127, 0.3290}};
constexpr Chromaticities ap1 = {{0.713, 0.293}, {0.165, 0.830}, {0.128, 0.044}, {0.32168, 0.33767}};

// The cone responses of the Bradford adaptation.
constexpr Matrix3 bradford = {
    {{0.8951, 0.2664, -0.1614}, {-0.7502, 1.7135, 0.0367}, {0.0389, -0.0685, 1.0296}}};

std::array<double, 3> operator*(const Matrix3& m, const std::array<double, 3>& v) {
  std::array<double, 3> out{};
  for (std::size_t i = 0; i < 3; ++i) out[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
  return out;
}

std::array<double, 3> xyz_of(const std::array<double, 2>& xy) {
  return {xy[0] / xy[1], 1.0, (1.0 - xy[0] - xy[1]) / xy[1]};
}

Matrix3 diagonal(const std::array<double, 3>& d) {
  return {{{d[0], 0, 0}, {0, d[1], 0}, {0, 0, d[2]}}};
}

// The n-th root of x in (0, huge) by Newton's method, from a guess that divides the exponent.
double root(double x, int n) {
  constexpr std::uint64_t one = 0x3ff0000000000000u;
  const auto bits = std::bit_cast<std::uint64_t>(x);
  double r = std::bit_cast<double>(
      one + static_cast<std::uint64_t>(static_cast<std::int64_t>(bits - one) / n));
  for (int i = 0; i < 5; ++i) {
    double power = r;
    for (int k = 2; k < n; ++k) power *= r;
    r += (x / power - r) / n;
  }
  return r;
}

}  // namespace

std::optional<ColourSpace> colour_space_from_name(std::string_view name) {
  if (name == "lin_rec709" || name == "rec709" || name == "linear") return ColourSpace::lin_rec709;
  if (name == "acescg") return ColourSpace::acescg;
  return std::nullopt;
}

std::string_view name_of(ColourSpace space) {
  return space == ColourSpace::acescg ? "acescg" : "lin_rec709";
}

const Chromaticities& chromaticities_of(ColourSpace space) {
  return space == ColourSpace::acescg ? ap1 : rec709;
}

Matrix3 operator*(const Matrix3& a, const Matrix3& b) {
  Matrix3 out{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      out[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
  return out;
}

Matrix3 inverse(const Matrix3& m) {
  const auto minor_of = [&](std::size_t r, std::size_t c) {
    const std::size_t r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
    return m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1];
  };
  const double det = m[0][0] * minor_of(0, 0) + m[0][1] * minor_of(0, 1) + m[0][2] * minor_of(0, 2);
  Matrix3 out{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) out[i][j] = minor_of(j, i) / det;
  return out;
}

Matrix3 rgb_to_xyz(const Chromaticities& p) {
  // The columns are the primaries, scaled so that they add up to white.
  const auto r = xyz_of(p.red), g = xyz_of(p.green), b = xyz_of(p.blue);
  Matrix3 columns{};
  for (std::size_t i = 0; i < 3; ++i) columns[i] = {r[i], g[i], b[i]};
  return columns * diagonal(inverse(columns) * xyz_of(p.white));
}

Matrix3 colour_matrix(const Chromaticities& from, const Chromaticities& to) {
  const auto cones_from = bradford * xyz_of(from.white), cones_to = bradford * xyz_of(to.white);
  const auto adapt = inverse(bradford) *
                     diagonal({cones_to[0] / cones_from[0], cones_to[1] / cones_from[1],
                               cones_to[2] / cones_from[2]}) *
                     bradford;
  return inverse(rgb_to_xyz(to)) * adapt * rgb_to_xyz(from);
}

void apply(const Matrix3& m, float* red, float* green, float* blue, std::int64_t count) {
  for (std::int64_t i = 0; i < count; ++i) {
    const double r = red[i], g = green[i], b = blue[i];
    red[i] = static_cast<float>(m[0][0] * r + m[0][1] * g + m[0][2] * b);
    green[i] = static_cast<float>(m[1][0] * r + m[1][1] * g + m[1][2] * b);
    blue[i] = static_cast<float>(m[2][0] * r + m[2][1] * g + m[2][2] * b);
  }
}

float srgb_encode(float linear) {
  const double x = std::fabs(double{linear});
  if (!(x <= 1e30)) return linear;
  double y = 12.92 * x;
  if (x > 0.0031308) {
    // x^(5/12): the cube root of the fourth root, to the fifth.
    const double r = root(std::sqrt(std::sqrt(x)), 3);
    y = 1.055 * (r * r * r * r * r) - 0.055;
  }
  return static_cast<float>(linear < 0 ? -y : y);
}

float srgb_decode(float encoded) {
  const double x = std::fabs(double{encoded});
  if (!(x <= 1e12)) return encoded;
  double y = x / 12.92;
  if (x > 0.04045) {
    // t^(12/5): the square, times the square of the fifth root.
    const double t = (x + 0.055) / 1.055, r = root(t, 5);
    y = t * t * (r * r);
  }
  return static_cast<float>(encoded < 0 ? -y : y);
}

std::optional<Tone> tone_from_name(std::string_view name) {
  if (name == "srgb" || name == "clip") return Tone::clip;
  if (name == "filmic") return Tone::filmic;
  if (name == "raw" || name == "none") return Tone::raw;
  if (name == "ocio") return Tone::ocio;
  return std::nullopt;
}

// Above middle grey m: m + (1 - m) t / sqrt(1 + t^2) with t = (x - m) / (1 - m). The joint at m is
// smooth to the second derivative; 1 becomes 0.76, four times middle grey 0.66, and the top is
// reached only by infinity.
float filmic(float linear) {
  constexpr double grey = 0.18;
  const double x = linear;
  if (!(x > grey)) return linear;
  const double t = (x - grey) / (1 - grey);
  if (t > 1e18) return 1;
  return static_cast<float>(grey + (1 - grey) * (t / std::sqrt(1 + t * t)));
}

// A lattice of rank one whose generator is the plastic number: neighbouring pixels get thresholds
// far apart.
float dither(int x, int y) {
  const std::uint32_t mixed =
      static_cast<std::uint32_t>(x) * 0xc13fa9a9u + static_cast<std::uint32_t>(y) * 0x91e10da5u;
  return (static_cast<float>(mixed >> 24) + 0.5f) / 256.0f;
}

}  // namespace pse::image
