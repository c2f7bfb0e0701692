// Objects, lights and a camera, and what rays meet there.
#pragma once

#include <cstdint>
#include <string>

#include "surface/box_tree.h"
#include "surface/camera.h"

namespace pse::surface {

struct Object {
  std::string name;
  std::shared_ptr<const Shape> shape;
  Affine to_world;
  int program = 0;  // which of the job's programs shades it
};

struct Light {
  Vec3 position;            // of a lamp, or the direction towards a light far away
  bool is_lamp = false;
  Vec3 color{1, 1, 1};      // of a lamp: at 1 metre
  double radius = 0;        // of the lamp; of a far light: half the angle it is seen at, radians
};

// What a light is at a place: the direction towards it, what arrives, where it is, how large.
enum class LightPart { direction, color, position, radius };
Vec3 light_value(const Light& light, LightPart part, const Vec3& place);

// The first meeting of a ray with the scene.
struct Hit {
  Meeting meeting;
  int object = -1;
  bool found() const { return object >= 0; }
  double t() const { return meeting.t; }
};

// What is to be seen there.
struct Spot {
  Vec3 place;          // in the world
  Vec3 point;          // in the object's own frame
  Vec3 normal, flat;   // in the world, of length 1, on the side that the ray comes from
  double u = 0, v = 0;
  bool back = false;   // the surface is seen from inside
};

class Scene {
 public:
  // Transforms must have inverses.
  Scene(std::vector<Object> objects, std::vector<Light> lights);

  const std::vector<Light>& lights() const { return lights_; }
  std::size_t objects() const { return placed_.size(); }
  const Object& object(std::size_t index) const { return placed_[index].object; }
  const Frame& frame(std::size_t index) const { return placed_[index].frame; }
  // Around all objects of finite size.
  const Box& bounds() const { return bounds_; }
  // A distance that is nothing in this scene: where rays from a surface may begin.
  double tiny() const { return tiny_; }
  // The objects whose body the point lies in, by their bounding boxes and a ray.
  std::vector<std::string> around(const Vec3& point) const;

  // hits[i] becomes ray i's first hit; of two at the same place, that of the object named first. A
  // hit depends on its ray alone. Rays may be anything: those that are not finite or have no
  // direction meet nothing.
  void trace(std::span<const Ray> rays, std::span<Hit> hits) const;
  // What is to be seen at hits that were found with these rays; u and v only where wanted.
  void describe(std::span<const Ray> rays, std::span<const Hit> hits, bool with_uv,
                std::span<Spot> spots) const;
  // What the surface of one object, in its own frame, is like at hits of that object.
  void describe_own(std::span<const Ray> rays, std::span<const Hit> hits, bool with_uv,
                    std::span<ShapePoint> points) const;

 private:
  struct Placed {
    Object object;
    Frame frame;
    Box bounds;  // in the world
  };
  static Ray local(const Placed& placed, const Ray& ray);
  void trace_many(std::span<const Ray> rays, std::span<Hit> hits) const;
  static void place(const Frame& frame, const Ray& ray, double t, const ShapePoint& shown,
                    Spot& spot);

  std::vector<Placed> placed_;
  std::vector<std::uint32_t> endless_, bounded_;  // indices of objects
  BoxTree tree_{{}};                              // over the bounded ones
  std::vector<Light> lights_;
  Box bounds_;
  double tiny_ = 1e-4;
};

}  // namespace pse::surface
