// The shape formed by an isosurface of a space function (1985, "Now what?"). All rays of a batch
// are marched together, so that the function is asked for many points at once; where its sign
// changes, the place is narrowed down by false position.
#include <numbers>
#include <sstream>

#include "surface/shapes.h"

namespace pse::surface {
namespace {


// Points to be asked for; room up to a multiple of 16, as kernels want it.
class Points {
 public:
  void clear() { count_ = 0; }
  void add(const Vec3& p) {
    if (count_ % 16 == 0)
      for (std::vector<float>* axis : {&x_, &y_, &z_, &values_})
        if (axis->size() < count_ + 16) axis->resize(count_ + 16);
    x_[count_] = static_cast<float>(p.x), y_[count_] = static_cast<float>(p.y);
    z_[count_] = static_cast<float>(p.z);
    ++count_;
  }
  void ask(const Field& field) {
    if (count_ > 0)
      field(static_cast<std::int64_t>(count_), x_.data(), y_.data(), z_.data(), values_.data());
  }
  double operator[](std::size_t i) const { return values_[i]; }
  std::size_t size() const { return count_; }

 private:
  std::vector<float> x_, y_, z_, values_;
  std::size_t count_ = 0;
};

// A ray on its way: the surface lies between a and b once `found`.
struct March {
  std::size_t ray = 0;
  double a = 0, b = 0, end = 0, step = 0;
  double at_a = 0, at_b = 0;
  int same_side = 0;
};

class Isosurface : public Shape {
 public:
  Isosurface(Field field, double level, const Box& box, double step)
      : field_(std::move(field)), level_(level), box_(box), step_(step) {}
  Box bounds() const override { return box_; }

  // Asks at the corners of the box, then, where all of them are on one side, at a lattice in it.
  std::string why_unseen() const override {
    std::ostringstream text;
    if (is_all_at_lattice(1, true) && is_all_at_lattice(lattice, true))
      text << "its function is above `level` " << level_
           << " everywhere within `bounds`, so that no surface is there";
    else if (is_all_at_lattice(1, false) && is_all_at_lattice(lattice, false) &&
             is_all_at_lattice(fine_lattice, false))
      text << "its function is nowhere above `level` " << level_
           << " within `bounds`, as far as a lattice of " << fine_lattice
           << " cells a side tells, so that no surface is there";
    return text.str();
  }

  void find(std::span<const Ray> rays, std::span<Meeting> meetings) const override {
    std::vector<March> found = march(rays);
    narrow(rays, found);
    for (const March& m : found)
      if (m.a > rays[m.ray].begin && m.a < rays[m.ray].end) meetings[m.ray].t = m.a;
  }

  void describe(std::span<const Ray> rays, std::span<const Meeting> meetings, bool with_uv,
                std::span<ShapePoint> described) const override {
    Points points;
    const double h = 0.1 * step_;
    constexpr Vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Vec3 p = rays[i].origin + meetings[i].t * rays[i].direction;
      for (const Vec3& axis : axes) points.add(p + h * axis), points.add(p - h * axis);
    }
    points.ask(field_);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Ray& ray = rays[i];
      Vec3 normal{points[6 * i + 1] - points[6 * i], points[6 * i + 3] - points[6 * i + 2],
                  points[6 * i + 5] - points[6 * i + 4]};
      if (!(dot(normal, normal) > 0)) normal = -ray.direction;
      ShapePoint& point = described[i];
      point.normal = point.flat = normal;
      if (!with_uv) continue;
      const Vec3 p = ray.origin + meetings[i].t * ray.direction - box_.centre();
      point.u = std::atan2(-p.z, p.x) / (2 * std::numbers::pi);
      if (point.u < 0) point.u += 1;
      point.v = 0.5 + std::atan2(p.y, std::hypot(p.x, p.z)) / std::numbers::pi;
    }
  }

 private:
  // Cells along each side of the box. Small things are missed by the first.
  static constexpr int lattice = 32, fine_lattice = 128;

  // Whether all points are inside, or none is.
  bool is_all_at_lattice(int cells, bool inside) const {
    Points points;
    const Vec3 size = box_.upper - box_.lower;
    const auto part = [&](int i) { return double(i) / cells; };
    for (int k = 0; k <= cells; ++k) {
      points.clear();
      for (int j = 0; j <= cells; ++j)
        for (int i = 0; i <= cells; ++i)
          points.add(box_.lower + Vec3{part(i) * size.x, part(j) * size.y, part(k) * size.z});
      points.ask(field_);
      for (std::size_t i = 0; i < points.size(); ++i)
        if ((points[i] > level_) != inside) return false;
    }
    return true;
  }

  // Steps until the sign changes or the box ends. The rays that found something, with a and b.
  std::vector<March> march(std::span<const Ray> rays) const {
    std::vector<March> active, found;
    Points points;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Span1 span = clip(rays[i], box_);
      if (!(span.begin < span.end)) continue;
      March m;
      m.ray = i, m.a = span.begin, m.end = span.end;
      m.step = step_ / length(rays[i].direction);
      active.push_back(m);
      points.add(rays[i].origin + m.a * rays[i].direction);
    }
    points.ask(field_);
    for (std::size_t i = 0; i < active.size(); ++i) active[i].at_a = points[i] - level_;
    while (!active.empty()) {
      points.clear();
      for (March& m : active) {
        m.b = std::min(m.a + m.step, m.end);
        points.add(rays[m.ray].origin + m.b * rays[m.ray].direction);
      }
      points.ask(field_);
      std::size_t kept = 0;
      for (std::size_t i = 0; i < active.size(); ++i) {
        March m = active[i];
        m.at_b = points[i] - level_;
        if ((m.at_a > 0) != (m.at_b > 0)) {
          found.push_back(m);
        } else if (m.b < m.end) {
          m.a = m.b, m.at_a = m.at_b;
          active[kept++] = m;
        }
      }
      active.resize(kept);
    }
    return found;
  }

  // False position, halving the value that stays (the Illinois rule), and halving the interval now
  // and then, so that it ends for every function.
  void narrow(std::span<const Ray> rays, std::vector<March>& found) const {
    Points points;
    for (int turn = 0; turn < 24; ++turn) {
      points.clear();
      for (March& m : found) {
        const double weight = m.at_a / (m.at_a - m.at_b);
        const bool half = turn % 4 == 3 || !(weight > 0 && weight < 1);
        m.step = m.a + (half ? 0.5 : weight) * (m.b - m.a);
        points.add(rays[m.ray].origin + m.step * rays[m.ray].direction);
      }
      points.ask(field_);
      for (std::size_t i = 0; i < found.size(); ++i) {
        March& m = found[i];
        const double value = points[i] - level_;
        if ((value > 0) == (m.at_a > 0)) {
          m.a = m.step, m.at_a = value;
          if (m.same_side == 1) m.at_b *= 0.5;
          m.same_side = 1;
        } else {
          m.b = m.step, m.at_b = value;
          if (m.same_side == -1) m.at_a *= 0.5;
          m.same_side = -1;
        }
      }
    }
    for (March& m : found) m.a = 0.5 * (m.a + m.b);
  }

  Field field_;
  double level_;
  Box box_;
  double step_;
};

}  // namespace

std::shared_ptr<const Shape> make_isosurface(Field f, double level, const Box& box, double step) {
  return std::make_shared<Isosurface>(std::move(f), level, box, step);
}

}  // namespace pse::surface
