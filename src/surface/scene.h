// Objects, lights and a camera, and what rays meet there.
#pragma once

#include <cstdint>

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
  double t = std::numeric_limits<double>::infinity();
  int object = -1;
  bool back = false;   // the surface is seen from inside
  Vec3 place;          // in the world
  Vec3 point;          // in the object's own frame
  Vec3 normal, flat;   // in the world, of length 1, on the side that the ray comes from
  double u = 0, v = 0;
  bool found() const { return object >= 0; }
};

class Scene {
 public:
  // Transforms must have inverses.
  Scene(std::vector<Object> objects, std::vector<Light> lights);

  const std::vector<Light>& lights() const { return lights_; }
  std::size_t objects() const { return placed_.size(); }
  const Object& object(std::size_t index) const { return placed_[index].object; }
  const Affine& to_object(std::size_t index) const { return placed_[index].to_object; }
  // Around all objects of finite size.
  const Box& bounds() const { return bounds_; }
  // A distance that is nothing in this scene: where rays from a surface may begin.
  double tiny() const { return tiny_; }
  // The objects whose body the point lies in, by their bounding boxes and a ray.
  std::vector<std::string> around(const Vec3& point) const;

  // hits[i] becomes ray i's first hit. A hit depends on its ray alone. Rays may be anything: those
  // that are not finite or have no direction meet nothing.
  void trace(std::span<const Ray> rays, std::span<Hit> hits) const;

 private:
  struct Placed {
    Object object;
    Affine to_object;
    Box bounds;  // in the world
    bool identity = false;
  };
  void trace_each(std::span<const Ray> rays, std::span<Hit> hits, std::span<ShapeHit> best) const;
  void finish(const Ray& ray, const Placed& placed, const ShapeHit& found, Hit& hit) const;

  std::vector<Placed> placed_;
  std::vector<Light> lights_;
  Box bounds_;
  double tiny_ = 1e-4;
};

}  // namespace pse::surface
