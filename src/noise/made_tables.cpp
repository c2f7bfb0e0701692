// The tables of the noise family that a small program makes: those of 1989 and those of the
// chapter's listing. Each is made on first use, from integers by correctly rounded operations, so
// it is the same on every machine.
#include <cmath>
#include <numeric>

#include "noise/tables.h"

namespace pse::num {
namespace {

// N components of 256 vectors, as tables.
template <std::size_t N>
struct VectorTables {
  std::array<std::array<float, 256>, N> entries{};
  std::array<FloatTable, N> tables;

  explicit VectorTables(const std::array<std::string_view, N>& names) {
    for (std::size_t axis = 0; axis < N; ++axis) tables[axis] = {names[axis], entries[axis]};
  }
  VectorTables(const VectorTables&) = delete;
  VectorTables& operator=(const VectorTables&) = delete;
};

// The multiplicative generator modulo 2^31 - 1 of Lehmer, with the multiplier of Park and Miller.
struct Lehmer {
  std::uint64_t state = 1989;
  // Even in [-1, 1].
  double next() {
    state = state * 48271 % 2147483647;
    return static_cast<double>(state) / 1073741823.5 - 1.0;
  }
};

template <std::size_t N>
struct SphereTables : VectorTables<N> {
  explicit SphereTables(const std::array<std::string_view, N>& names) : VectorTables<N>(names) {
    Lehmer random;
    for (std::size_t i = 0; i < 256; ++i) {
      // A point in the cube, until one falls into the sphere; then onto the sphere.
      std::array<double, N> v;
      double square = 0;
      do {
        for (double& component : v) component = random.next();
        square = std::inner_product(v.begin(), v.end(), v.begin(), 0.0);
      } while (square > 1.0 || square < 1e-4);
      const double length = N == 1 ? 1.0 : std::sqrt(square);
      for (std::size_t axis = 0; axis < N; ++axis)
        this->entries[axis][i] = static_cast<float>(v[axis] / length);
    }
  }
};

// glibc's random() after srandom(1): an additive feedback generator over 31 words.
class GlibcRandom {
 public:
  GlibcRandom() {
    state_[0] = 1;
    for (std::size_t i = 1; i < 31; ++i)
      state_[i] = static_cast<std::uint32_t>(16807ull * state_[i - 1] % 2147483647u);
    for (int i = 0; i < 310; ++i) step();
  }
  std::uint32_t next() { return step() >> 1; }

 private:
  std::uint32_t step() {
    // The oldest word, 31 draws back, takes the one 3 draws back onto itself.
    const std::size_t front = at_, back = (at_ + 28) % 31;
    at_ = (at_ + 1) % 31;
    return state_[front] += state_[back];
  }
  std::array<std::uint32_t, 31> state_{};
  std::size_t at_ = 3;  // the first three words count as drawn
};

struct BookTables : VectorTables<3> {
  std::array<std::uint8_t, 256> bytes{};
  ByteTable permutation{"book.permutation", bytes};

  BookTables() : VectorTables({"book.x", "book.y", "book.z"}) {
    GlibcRandom random;
    // Gradients in float, as there: a point in the cube until one is in the sphere, then onto the
    // sphere.
    for (std::size_t i = 0; i < 256; ++i) {
      std::array<float, 3> v;
      float square = 0;
      do {
        for (float& component : v)
          component = static_cast<float>(static_cast<int>(random.next() % 512) - 256) / 256.0f;
        square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
      } while (square > 1.0f);
      for (std::size_t axis = 0; axis < 3; ++axis) entries[axis][i] = v[axis] / std::sqrt(square);
    }
    // The shuffle as there: from one past the end, which holds 0, by steps of two.
    std::array<std::uint32_t, 257> shuffled{};
    std::iota(shuffled.begin(), shuffled.end() - 1, 0u);
    for (std::size_t i = 256; i > 0; i -= 2) std::swap(shuffled[i], shuffled[random.next() % 256]);
    for (std::size_t i = 0; i < 256; ++i) bytes[i] = static_cast<std::uint8_t>(shuffled[i]);
  }
};

const BookTables& book_tables() {
  static const BookTables tables;
  return tables;
}

}  // namespace

std::span<const FloatTable> sphere_tables(std::size_t dimensions) {
  static const SphereTables<1> one({"sphere.x.1"});
  static const SphereTables<2> two({"sphere.x.2", "sphere.y.2"});
  static const SphereTables<3> three({"sphere.x.3", "sphere.y.3", "sphere.z.3"});
  static const SphereTables<4> four({"sphere.x.4", "sphere.y.4", "sphere.z.4", "sphere.w.4"});
  switch (dimensions) {
    case 1:
      return one.tables;
    case 2:
      return two.tables;
    case 3:
      return three.tables;
    default:
      return four.tables;
  }
}

const ByteTable& book_permutation() { return book_tables().permutation; }
std::span<const FloatTable> book_gradients() { return book_tables().tables; }

}  // namespace pse::num
