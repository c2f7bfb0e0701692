// A picture of surfaces: channels that say where each pixel's surface is, which way it faces and
// whose it is, traced here or by another renderer. A program is run on it without tracing again
// (1985: "input images", point and normal among their names).
#pragma once

#include <array>
#include <map>
#include <optional>

#include "image/layers.h"
#include "surface/surface_source.h"

namespace pse::surface {

// Which layer of a picture brings which name: "normal" -> "ViewLayer_Normal".
using SurfaceLayers = std::map<std::string, std::string>;

// By the usual names of layers; the part after the last `_` or `.` counts, in any letters: P, Pref,
// Position, N, Normal, uv, id, IndexOB, Z, Depth. Empty unless there are a position and a normal.
SurfaceLayers surface_layers(std::span<const image::Layer> layers);

// What does not change from pixel to pixel.
struct GBufferFrame {
  std::optional<Vec3> eye;
  std::vector<Light> lights;
};
// As attributes of a file, and back. Attributes that are not there leave the fields alone.
std::map<std::string, std::string> gbuffer_attributes(const GBufferFrame& frame);
void read_gbuffer_attributes(const std::map<std::string, std::string>& attributes,
                             GBufferFrame& frame);

// The names that a G-buffer brings: those of its layers, and what follows from them.
std::vector<StreamName> gbuffer_names(const SurfaceLayers& layers,
                                      std::span<const image::Layer> all,
                                      const GBufferFrame& frame);

// The layers that the values of a module's inputs come from.
std::vector<std::string> layers_wanted(const ir::Module& module, const SurfaceLayers& layers);

// Makes background of the pixels whose position or normal has a number that is not finite, in all
// of these layers that the picture holds; what it says: one sentence for each channel that had such
// at pixels that show something.
std::vector<std::string> clear_broken_pixels(image::Image& picture, const SurfaceLayers& layers,
                                             std::span<const image::Layer> all,
                                             const image::ImageSpec& spec);

// A source of samples at pixel centres.
class GBuffer : public SampleSource {
 public:
  // `picture` holds the channels of the layers (others may be missing); `all` are the layers of its
  // file, whose channels are looked up by their names in `spec`.
  GBuffer(const ir::Module& module, const SurfaceLayers& layers,
          std::span<const image::Layer> all, const image::ImageSpec& spec,
          std::shared_ptr<const image::Image> picture, const GBufferFrame& frame);
  void fill(std::span<const double> x, std::span<const double> y,
            std::span<float* const> planes) const override;
  bool anywhere() const override { return false; }

 private:
  enum class What {
    layer,
    negated,
    slope_x,
    slope_y,
    id,
    hit,
    depth,
    direction,
    view,
    pixelsize,
    pixel_freq,
    nothing,
    light_direction,
    light_color,
    light_position,
    light_radius
  };
  struct Wanted {
    std::size_t input;
    What what;
    std::size_t component;
    std::size_t light;
    const float* plane;
  };
  // The planes of one name, null where they are not there.
  using Planes3 = std::array<const float*, 3>;
  const float* plane_of(const std::string& name, std::size_t component) const;
  static Vec3 vector_at(const Planes3& planes, std::size_t pixel);
  Vec3 direction_at(std::size_t pixel) const;
  bool seen_at(std::size_t pixel) const;
  double pixelsize_at(std::size_t pixel) const;
  float slope_at(const float* plane, bool along_x, std::size_t pixel) const;
  bool is_same_everywhere(const Wanted& wanted) const;
  float value(const Wanted& wanted, std::size_t pixel) const;
  // Samples whose pixels lie side by side in the stored planes, from `pixel` on, or all outside.
  struct Row {
    std::int64_t sample, count, pixel;
  };
  static constexpr std::int64_t outside = -1;
  void fill_row(const Wanted& wanted, std::int64_t first, std::int64_t count, float* out) const;

  std::shared_ptr<const image::Image> picture_;
  std::map<std::string, std::vector<const float*>> planes_;
  Planes3 point_{}, place_{}, normal_{};
  const float *hit_ = nullptr, *id_ = nullptr, *depth_ = nullptr, *pixelsize_ = nullptr;
  GBufferFrame frame_;
  std::vector<Wanted> wanted_;
  image::Window display_, data_;
};

}  // namespace pse::surface
