// A mesh's texture atlas as a source of samples: for each texel the point of the surface that its
// centre shows. From `pse bake PROGRAM MESH`; the same names as a visible surface brings
// (surface_source.h), but for those that need an eye.
#pragma once

#include <expected>
#include <string>
#include <vector>

#include "lower/lower.h"
#include "stream/executor.h"
#include "surface/mesh.h"

namespace pse::surface {

struct AtlasSize {
  int width = 2048, height = 2048;  // texels
  int samples = 1;                  // along each side of a texel
  // UDIM: 1001 + u + 10 v of the unit square to bake, alone. 0: all, in one square that repeats, so
  // that charts that leave it on one side come in on the other, as a texture does.
  int tile = 0;
};

// A sample of the atlas that shows a point of the mesh.
struct AtlasSample {
  std::uint32_t place = 0;  // column + row * width * samples, of the grid of samples
  std::uint32_t triangle = 0;
  float b = 0, c = 0;  // weights of the triangle's second and third corner
};

struct Atlas {
  AtlasSize size;
  std::vector<AtlasSample> samples;  // in reading order
  std::size_t overlaps = 0;          // samples whose place shows more than one point

  int columns() const { return size.width * size.samples; }
  int rows() const { return size.height * size.samples; }
};

// Which triangle each sample shows. A sample whose centre lies beside a triangle, whose
// nearest point lies in the sample's square, shows that point: charts are covered up to their
// edges. The error says what is wrong with the mesh's coordinates.
std::expected<Atlas, std::string> make_atlas(const Mesh& mesh, const AtlasSize& size);

// point place normal flat_normal view uv u v id hit backface px py pixelsize pixel_freq. The view
// is straight on; pixelsize is the side of a texel on the surface.
std::vector<StreamName> atlas_names();

// Fills them in for tiles of samples, taken as a picture `row` samples wide: sample i is pixel
// (i % row, i / row). Mesh and atlas must outlive the source.
TileSource atlas_source(const ir::Module& module, const Mesh& mesh, const Atlas& atlas, int row);

// A plane of samples as texels: the mean of each texel's samples, and beyond the edges of charts
// the mean of neighbours, `margin` texels far. `values` holds one number per sample of the atlas.
std::vector<float> resolve(const Atlas& atlas, const std::vector<float>& values, int margin);

}  // namespace pse::surface
