// Visible surfaces as a source of samples (1985, "Solid texture"): the names that a hit brings, and
// their values. Second step of the flow of a surface picture: places -> rays -> hits -> names.
#pragma once

#include <optional>

#include "lower/lower.h"
#include "stream/executor.h"
#include "stream/image_plane.h"
#include "stream/sample_source.h"
#include "surface/cover.h"
#include "surface/name_values.h"

namespace pse::surface {

// `lights`: how many the scene has; the first is `light_direction` and so on, the second
// `light2_direction`.
std::vector<StreamName> surface_names(std::size_t lights);

// Writes names of sightings into the sample-rate inputs of a module.
class NameWriter {
 public:
  NameWriter(const ir::Module& module, std::shared_ptr<const Scene> scene, const Lens& lens);

  // Whether an input is a slope of a name: "point.0$x" and its like.
  static bool is_slope(const std::string& input) {
    return input.find('$') != std::string::npos && find(input, 0).has_value();
  }

  // planes[i] receives module input i, for those that are names of surfaces; null: not wanted.
  // First `count` samples show nothing: their id is 0, other names are left alone.
  void begin(std::size_t count, std::span<float* const> planes) const;
  // Then what is shown. hits[k] is what sighting k met with rays[k]; those that met nothing are the
  // background.
  void write(std::span<const Sighting> sightings, std::span<const Ray> rays,
             std::span<const Hit> hits, std::span<float* const> planes) const;

 private:
  struct Wanted {
    std::size_t input;
    What what;
    int component;
    std::size_t light;
  };
  static std::optional<Wanted> find(const std::string& name, std::size_t lights);
  // Of samples that show one object, or the background.
  void write_run(std::span<const Sighting> sightings, std::span<const Ray> rays,
                 std::span<const Hit> hits, std::span<float* const> planes) const;
  double number(const Wanted& wanted, int object) const;
  bool follows_place(const Wanted& wanted) const;

  std::shared_ptr<const Scene> scene_;
  Vec3 right_, up_;
  std::vector<Wanted> wanted_;
  bool wants_shifts_ = false, wants_spots_ = false, wants_uv_ = false;
  NameFunction function_ = name_function();
};

// Sets the frame-rate inputs that a scene brings: eye, light_count.
void set_scene_uniforms(const ir::Module& module, std::span<const Light> lights, const Vec3& eye,
                        FrameState& state);

class SurfaceSource : public SampleSource {
 public:
  // `misses`: whether what shows nothing is shaded too.
  SurfaceSource(const ir::Module& module, std::shared_ptr<const Scene> scene, const Lens& lens,
                bool misses);
  void fill(std::span<const double> x, std::span<const double> y,
            std::span<float* const> planes) const override;
  bool anywhere() const override { return true; }
  bool brings_slope(const std::string& input) const override {
    return NameWriter::is_slope(input);
  }

 private:
  // Of samples that may show something, or of such as do not (`empty`).
  void fill_some(std::span<const double> x, std::span<const double> y,
                 std::span<const std::uint32_t> samples, bool empty,
                 std::span<float* const> planes) const;

  std::shared_ptr<const Scene> scene_;
  Lens lens_;
  Cover cover_;
  NameWriter names_;
  bool misses_;
};

// Calls a source for the pixel centres of each tile.
TileSource at_pixel_centres(std::shared_ptr<const SampleSource> source, double sample_x = 0.5,
                            double sample_y = 0.5);

}  // namespace pse::surface
