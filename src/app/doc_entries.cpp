// What `pse doc` tells of what no table and no library file describes: the variables that streams
// bring (stream/image_plane.h, surface/surface_source.h), constants, and the functions whose
// meaning depends on the shapes of their arguments (lower/intrinsics.cpp).
#include "app/doc_entries.h"

#include <vector>

namespace pse::app {

std::span<const DocEntry> told_entries() {
  static const std::vector<DocEntry> all = {
      {"x", "x",
       "to the right in the picture's plane: -aspect at its left edge, 0 in the middle, aspect at "
       "the right",
       "variable"},
      {"y", "y", "upward in the picture's plane: -1 at its bottom, 0 in the middle, 1 at the top",
       "variable"},
      {"u", "u", "across the picture: 0 at its left edge, 1 at the right", "variable"},
      {"v", "v", "up the picture: 0 at its bottom, 1 at the top", "variable"},
      {"point", "point", "the sample's place in space: [x y 0], moved by --xform", "variable"},
      {"px", "px", "column of the pixel, from 0 at the left; pixel centres are at .5", "variable"},
      {"py", "py", "row of the pixel, from 0 at the top; pixel centres are at .5", "variable"},
      {"frame", "frame", "number of the frame", "variable"},
      {"time", "time", "seconds: frame / fps", "variable"},
      {"fps", "fps", "frames per second", "variable"},
      {"width", "width", "pixels of a row of the picture", "variable"},
      {"height", "height", "pixels of a column of the picture", "variable"},
      {"aspect", "aspect", "width / height", "variable"},
      {"pixelsize", "pixelsize", "side of a pixel in the picture's plane: 2 / height", "variable"},
      {"pixel_freq", "pixel_freq",
       "the highest frequency that pixels can show, in cycles per unit: 0.5 / pixelsize",
       "variable"},
      {"seed", "seed", "the number given with --seed", "variable"},
      {"prepass", "prepass.near, prepass.far, prepass.step",
       "where a prepass found matter on the pixel's ray, and what step it looks with; for the "
       "marchers",
       "variable"},
      {"xform", "xform", "the 16 numbers of --xform, row by row", "variable"},
      {"begin_frame", "if begin_frame ...",
       "true where a frame begins: the block is computed once per frame", "variable"},
      {"place", "place",
       "the surface's place in the world (docs/surfaces.md); `point` is the same "
       "in the object's own frame",
       "variable of surfaces"},
      {"normal", "normal", "the surface's direction, of length 1, on the side of the eye",
       "variable of surfaces"},
      {"uv", "uv", "the surface's coordinates, v upward", "variable of surfaces"},
      {"id", "id", "number of the object, from 1", "variable of surfaces"},
      {"depth", "depth", "metres in front of the eye's plane", "variable of surfaces"},
      {"view", "view", "direction to the eye, of length 1", "variable of surfaces"},
      {"light_direction", "light_direction",
       "towards the light, of length 1; light2_direction is the second's", "variable of surfaces"},
      {"light_color", "light_color", "what arrives from the light", "variable of surfaces"},
      {"color", "color",
       "the picture's colour: 1, 3 or 4 numbers, multiplied by alpha; read, it is "
       "the colour of the image without a name",
       "variable of images"},
      {"alpha", "alpha", "the picture's coverage, 0 to 1", "variable of images"},
      {"Z", "Z", "depth, where the image has it", "variable of images"},
      {"PI", "PI", "3.14159..., half a turn; TAU is a whole turn", "constant"},
      {"TAU", "TAU", "6.28318..., a whole turn in radians", "constant"},
      {"E", "E", "2.71828..., the base of exp and log", "constant"},
      {"INF", "INF", "infinity", "constant"},
      {"NAN", "NAN", "not a number", "constant"},
      {"white", "white",
       "[1 1 1]; black red green blue cyan magenta yellow are colours as well, "
       "linear Rec. 709",
       "constant"},
      {"grey", "grey", "[0.18 0.18 0.18], also spelt gray", "constant"},
      {"min", "min(a, b, ...)",
       "the least, component by component; of one vector, its least "
       "component",
       "builtin, by shape"},
      {"max", "max(a, b, ...)",
       "the greatest, component by component; of one vector, its greatest "
       "component",
       "builtin, by shape"},
      {"any", "any(a, ...)", "true where a component is not 0", "builtin, by shape"},
      {"all", "all(a, ...)", "true where no component is 0", "builtin, by shape"},
      {"select", "select(c, a, b)", "a where c is true, else b; both are evaluated",
       "builtin, by shape"},
      {"count", "count(a)", "elements of an array or vector, rows of a matrix",
       "builtin, by shape"},
      {"array", "array(n)", "an empty array with room for n elements", "builtin, by shape"},
      {"transpose", "transpose(m)", "rows and columns of a matrix exchanged", "builtin, by shape"},
      {"identity", "identity(n)", "the matrix of n by n with 1 on its diagonal",
       "builtin, by shape"},
      {"isnan", "isnan(a)", "true where a component is NaN", "builtin, by shape"},
      {"isfinite", "isfinite(a)", "true where no component is NaN or infinite",
       "builtin, by shape"},
      {"require", "require(c, text)",
       "a statement: where c is false, the run ends with the text as its error",
       "builtin, by shape"},
      {"expect", "expect(value, c, text, hint, function)",
       "value; where c is false for a pixel of the picture, the render warns of the text and the "
       "hint, at the function that is named (the last two may be left out)",
       "builtin, by shape"},
      {"texture",
       "texture(file, u, v, layer = \"color\", filter = \"linear\", wrap = \"repeat\", "
       "width = 0)",
       "an image at any place: 0 to 1 is the whole image, v upward. filter: nearest, "
       "linear, cubic, mipmap (over `width`); wrap: repeat, clamp, mirror, black",
       "builtin, files"},
      {"texture_size", "texture_size(file)", "[width height] of an image, in pixels",
       "builtin, files"},
      {"volume", "volume(file, p, grid = \"density\")",
       "a stored volume (VDB, or a stack of "
       "pictures) at the point p, in metres",
       "builtin, files"},
      {"trace", "trace(origin, direction)",
       "what a ray meets first: its parts are .distance .place .point .normal .uv .id .backface",
       "rays, on surfaces"},
      {"radiance", "radiance(origin, direction)",
       "colour and alpha of what a ray meets, shaded by its own program", "rays, on surfaces"},
      {"visible", "visible(place, other_place)",
       "1 where nothing stands between two places, else 0", "rays, on surfaces"}};
  return all;
}

}  // namespace pse::app
