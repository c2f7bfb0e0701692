// Pixels with one edge under their kernels, as lists side by side.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "antialias/derive.h"
#include "antialias/tile.h"

namespace pse::antialias {

// Numbers i of all lists belong together; what lies behind `count` has no meaning.
struct CrossingLists {
  static constexpr std::size_t beyond = 16;  // room behind the ends of the lists

  std::size_t count = 0;
  std::int32_t *x, *y;  // the pixel
  // Of its centre from the edge, positive on the side the normal points to.
  float* distance;
  float *nx, *ny;
  // How much the normal turns towards the tangent (-ny, nx) per pixel along it.
  float* bend;
  float* share;           // of the kernel on the normal's side
  float *towards, *away;  // to the middles of the sides, along the normal
  float* turning;         // the moment of the edge under the kernel
  float* other;           // the distance of another edge
  std::int32_t* is_one;   // not 0: there is but one edge
  std::int32_t* hidden;   // not 0: the pixel is (tile.h)
  std::int32_t* jumps;    // the pixel's
  std::int32_t* unseen;   // likewise
  std::int32_t* enclosed;

  Line line(std::size_t i) const { return {distance[i], nx[i], ny[i]}; }
  Pixel pixel(std::size_t i) const {
    const bool is_hidden = hidden[i] != 0, is_unseen = unseen[i] != 0;
    return {.x = x[i],
            .y = y[i],
            .narrow = is_hidden || is_unseen,
            .hidden = is_hidden,
            .unseen = is_unseen,
            .enclosed = enclosed[i] != 0};
  }
  // What blending reads beside the pixel.
  struct Edge {
    float distance, nx, ny, share, towards, away;
  };
  Edge edge(std::size_t i) const {
    return {distance[i], nx[i], ny[i], share[i], towards[i], away[i]};
  }
  void set(std::size_t i, const Edge& edge) const {
    distance[i] = edge.distance, nx[i] = edge.nx, ny[i] = edge.ny;
    share[i] = edge.share, towards[i] = edge.towards, away[i] = edge.away;
  }
  // Whether a share is not so near to 0 or 1 that it leaves the pixel as it is.
  static bool parts(float share) {
    constexpr float least_share = 0.001f;
    return share > least_share && share < 1 - least_share;
  }
  // Number `from` of the lists that blending reads becomes number `to`.
  void move(std::size_t from, std::size_t to) const {
    x[to] = x[from], y[to] = y[from];
    set(to, edge(from));
  }
};

// Their memory, used again from tile to tile.
class Crossings {
 public:
  // Lists with room for so many pixels; what was in them is lost.
  CrossingLists lists(std::size_t pixels) {
    const std::size_t size = pixels + CrossingLists::beyond;
    if (size > size_) {
      size_ = 2 * size;
      numbers_.resize(9 * size_), whole_.resize(7 * size_);
    }
    const auto number = [&](std::size_t list) { return numbers_.data() + list * size_; };
    const auto whole = [&](std::size_t list) { return whole_.data() + list * size_; };
    return {0,         whole(0),  whole(1),  number(0), number(1), number(2),
            number(3), number(4), number(5), number(6), number(7), number(8),
            whole(2),  whole(3),  whole(4),  whole(5),  whole(6)};
  }

 private:
  std::size_t size_ = 0;
  std::vector<float> numbers_;
  std::vector<std::int32_t> whole_;
};

}  // namespace pse::antialias
