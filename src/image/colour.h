// Colour arithmetic: working spaces and the matrices between them, the sRGB curve, tone curves for
// display, dithering. Programs work in scene-linear light; only what is shown or stored for showing
// (PNG, JPEG, MP4) goes through a display transform. Everything is computed with + - * / and square
// roots alone, so the same bytes come out on every machine.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "image/image.h"

namespace pse::image {

enum class ColourSpace { lin_rec709, acescg };

std::optional<ColourSpace> colour_space_from_name(std::string_view name);
std::string_view name_of(ColourSpace space);
const Chromaticities& chromaticities_of(ColourSpace space);

using Matrix3 = std::array<std::array<double, 3>, 3>;

// Linear RGB of these primaries to CIE XYZ, where RGB (1, 1, 1) is their white with Y = 1.
Matrix3 rgb_to_xyz(const Chromaticities& primaries);
// Linear RGB to linear RGB; white goes to white by the Bradford adaptation.
Matrix3 colour_matrix(const Chromaticities& from, const Chromaticities& to);
Matrix3 operator*(const Matrix3& a, const Matrix3& b);
Matrix3 inverse(const Matrix3& m);
// In place, over `count` colours.
void apply(const Matrix3& m, float* red, float* green, float* blue, std::int64_t count);

// The curve of IEC 61966-2-1. Odd about 0, and not clamped, so that it can be undone.
float srgb_encode(float linear);
float srgb_decode(float encoded);

// How scene light becomes display light, before the display's curve.
enum class Tone {
  clip,    // "srgb": as it is; what is brighter than the display is cut off
  filmic,  // as it is up to middle grey (0.18); from there a shoulder that approaches 1
  raw,     // no transform and no curve: the numbers themselves
  ocio     // a view of the OpenColorIO configuration
};
std::optional<Tone> tone_from_name(std::string_view name);  // "srgb", "filmic", "raw", "ocio"
float filmic(float linear);

// What dithering adds before a value is cut to whole steps: between 0 and 1, evenly spread, high in
// frequency.
float dither(int x, int y);

}  // namespace pse::image
