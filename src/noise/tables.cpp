// The tables of the noise family that are published numbers or written out by rule.
#include "noise/tables.h"

namespace pse::num {
namespace {

// The permutation of the 2002 reference implementation.
constexpr std::array<std::uint8_t, 256> permutation_entries = {
    151, 160, 137, 91,  90,  15,  131, 13,  201, 95,  96,  53,  194, 233, 7,   225, 140, 36,  103,
    30,  69,  142, 8,   99,  37,  240, 21,  10,  23,  190, 6,   148, 247, 120, 234, 75,  0,   26,
    197, 62,  94,  252, 219, 203, 117, 35,  11,  32,  57,  177, 33,  88,  237, 149, 56,  87,  174,
    20,  125, 136, 171, 168, 68,  175, 74,  165, 71,  134, 139, 48,  27,  166, 77,  146, 158, 231,
    83,  111, 229, 122, 60,  211, 133, 230, 220, 105, 92,  41,  55,  46,  245, 40,  244, 102, 143,
    54,  65,  25,  63,  161, 1,   216, 80,  73,  209, 76,  132, 187, 208, 89,  18,  169, 200, 196,
    135, 130, 116, 188, 159, 86,  164, 100, 109, 198, 173, 186, 3,   64,  52,  217, 226, 250, 124,
    123, 5,   202, 38,  147, 118, 126, 255, 82,  85,  212, 207, 206, 59,  227, 47,  16,  58,  17,
    182, 189, 28,  42,  223, 183, 170, 213, 119, 248, 152, 2,   44,  154, 163, 70,  221, 153, 101,
    155, 167, 43,  172, 9,   129, 22,  39,  253, 19,  98,  108, 110, 79,  113, 224, 232, 178, 185,
    112, 104, 218, 246, 97,  228, 251, 34,  242, 193, 238, 210, 144, 12,  191, 179, 162, 241, 81,
    51,  145, 235, 249, 14,  239, 107, 49,  192, 214, 31,  181, 199, 106, 157, 184, 84,  204, 176,
    115, 121, 50,  45,  127, 4,   150, 254, 138, 236, 205, 93,  222, 114, 67,  29,  24,  72,  243,
    141, 128, 195, 78,  66,  215, 61,  156, 180,
};

// One dimension: slopes of both signs, evenly spaced and never flat.
constexpr std::array<float, 16> slopes = {
    0.125f, -0.125f, 0.375f, -0.375f, 0.625f, -0.625f, 0.875f, -0.875f,
    1.125f, -1.125f, 1.375f, -1.375f, 1.625f, -1.625f, 1.875f, -1.875f,
};

// Two dimensions: sixteen directions of length sqrt(2), evenly spaced, away from the axes and the
// diagonals.
constexpr std::array<float, 16> x2 = {
    1.38703985f,  1.1758756f,   0.785694958f, 0.275899379f, -0.275899379f, -0.785694958f,
    -1.1758756f,  -1.38703985f, -1.38703985f, -1.1758756f,  -0.785694958f, -0.275899379f,
    0.275899379f, 0.785694958f, 1.1758756f,   1.38703985f,
};
constexpr std::array<float, 16> y2 = {
    0.275899379f, 0.785694958f, 1.1758756f,    1.38703985f,   1.38703985f, 1.1758756f,
    0.785694958f, 0.275899379f, -0.275899379f, -0.785694958f, -1.1758756f, -1.38703985f,
    -1.38703985f, -1.1758756f,  -0.785694958f, -0.275899379f,
};

// Three dimensions: the twelve edges of the cube as the reference numbers them; the last four are
// repeated.
constexpr std::array<float, 16> x3 = {1, -1, 1, -1, 1, -1, 1, -1, 0, 0, 0, 0, 1, 0, -1, 0};
constexpr std::array<float, 16> y3 = {1, 1, -1, -1, 0, 0, 0, 0, 1, -1, 1, -1, 1, -1, 1, -1};
constexpr std::array<float, 16> z3 = {0, 0, 0, 0, 1, 1, -1, -1, 1, 1, -1, -1, 0, 1, 0, -1};

// Four dimensions: the thirty-two edges of the hypercube.
constexpr std::array<float, 32> x4 = {
    0, 0,  0, 0,  0, 0,  0, 0,  1, -1, 1, -1, 1, -1, 1, -1,
    1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1,
};
constexpr std::array<float, 32> y4 = {
    1, -1, 1,  -1, 1, -1, 1,  -1, 0, 0, 0,  0,  0, 0, 0,  0,
    1, 1,  -1, -1, 1, 1,  -1, -1, 1, 1, -1, -1, 1, 1, -1, -1,
};
constexpr std::array<float, 32> z4 = {
    1, 1, -1, -1, 1, 1, -1, -1, 1, 1, -1, -1, 1,  1,  -1, -1,
    0, 0, 0,  0,  0, 0, 0,  0,  1, 1, 1,  1,  -1, -1, -1, -1,
};
constexpr std::array<float, 32> w4 = {
    1, 1, 1, 1, -1, -1, -1, -1, 1, 1, 1, 1, -1, -1, -1, -1,
    1, 1, 1, 1, -1, -1, -1, -1, 0, 0, 0, 0, 0,  0,  0,  0,
};

// 2/pi behind the point, and its windows of twenty-four bits.
constexpr std::array<std::uint32_t, 8> two_over_pi_bits = {
    0xa2f9836e, 0x4e441529, 0xfc2757d1, 0xf534ddc0, 0xdb629599, 0x3c439041, 0xfe5163ab, 0};
constexpr int bit_of_two_over_pi(int i) {
  if (i < 1 || i > 256) return 0;
  return static_cast<int>(
      (two_over_pi_bits[static_cast<std::size_t>((i - 1) / 32)] >> (31 - (i - 1) % 32)) & 1u);
}
constexpr std::array<std::int32_t, 256> two_over_pi_windows = [] {
  std::array<std::int32_t, 256> windows{};
  for (int start = 0; start < 256; ++start) {
    for (int i = 0; i < 24; ++i) {
      auto& window = windows[static_cast<std::size_t>(start)];
      window = 2 * window + bit_of_two_over_pi(start - two_over_pi_lead + i);
    }
  }
  return windows;
}();

constexpr std::array<float, 8> factors = {1.375f, 1.25f,    1.125f,  1.0625f,
                                          1.0f,   0.90625f, 0.8125f, 0.75f};
constexpr std::array<float, 8> factor_logs = {
    -0.4594268798828125f, -0.321929931640625f, -0.169921875f, -0.08746337890625f, 0.0f,
    0.1420135498046875f,  0.299560546875f,     0.4150390625f};
constexpr std::array<float, 8> factor_log_rests = {
    -4.73875434e-06f, 1.836753313e-06f, -3.12644238e-06f, 5.376559215e-07f, 0.0f,
    5.455067821e-06f, -2.65016098e-07f, -1.56322119e-06f};

constexpr std::array one = {FloatTable{"slope.1", slopes}};
constexpr std::array two = {FloatTable{"x.2", x2}, FloatTable{"y.2", y2}};
constexpr std::array three = {FloatTable{"x.3", x3}, FloatTable{"y.3", y3}, FloatTable{"z.3", z3}};
constexpr std::array four = {FloatTable{"x.4", x4}, FloatTable{"y.4", y4}, FloatTable{"z.4", z4},
                             FloatTable{"w.4", w4}};

}  // namespace

constinit const ByteTable permutation = {"permutation", permutation_entries};

constinit const IntTable two_over_pi = {"two_over_pi", two_over_pi_windows};

constinit const FloatTable octave_factor = {"octave.factor", factors};
constinit const FloatTable octave_log2 = {"octave.log2", factor_logs};
constinit const FloatTable octave_log2_rest = {"octave.log2.rest", factor_log_rests};

std::span<const FloatTable> gradient_tables(std::size_t dimensions) {
  constexpr std::array<std::span<const FloatTable>, 4> tables = {one, two, three, four};
  return tables[dimensions - 1];
}

}  // namespace pse::num
