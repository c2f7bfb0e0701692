// Header attributes of EXR files; see exr_attributes.h.
#include "image/exr_attributes.h"

#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfCompressionAttribute.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfEnvmapAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfRationalAttribute.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfStringVectorAttribute.h>
#include <OpenEXR/ImfTileDescription.h>
#include <OpenEXR/ImfVecAttribute.h>

#include <array>
#include <charconv>
#include <cmath>
#include <set>

namespace pse::image::exr {
namespace {

// Attributes that the spec holds in a field of its own, or that only say how the file is laid out.
const std::set<std::string> structural = {"channels",
                                          "compression",
                                          "dataWindow",
                                          "displayWindow",
                                          "lineOrder",
                                          "tiles",
                                          "chunkCount",
                                          "pixelAspectRatio",
                                          "chromaticities",
                                          "type",
                                          "preview",
                                          "name",
                                          "screenWindowCenter",
                                          "screenWindowWidth",
                                          "framesPerSecond",
                                          "maxSamplesPerPixel",
                                          "version"};

std::string number(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value);
  return std::string(text.data(), end.ptr);
}
std::string number(float value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value);
  return std::string(text.data(), end.ptr);
}
std::string number(int value) { return std::to_string(value); }

template <class... Numbers>
std::string numbers(Numbers... values) {
  std::string text;
  ((text += (text.empty() ? "" : " ") + number(values)), ...);
  return text;
}

template <class Matrix>
std::string matrix(const Matrix& m, int size) {
  std::string text;
  for (int row = 0; row < size; ++row)
    for (int column = 0; column < size; ++column)
      text += (text.empty() ? "" : " ") + number(m[row][column]);
  return text;
}

// The attribute's value as text; nothing for kinds that have none.
std::optional<std::string> as_text(const Imf::Attribute& any) {
  if (auto a = dynamic_cast<const Imf::StringAttribute*>(&any)) return a->value();
  if (auto a = dynamic_cast<const Imf::FloatAttribute*>(&any)) return number(a->value());
  if (auto a = dynamic_cast<const Imf::DoubleAttribute*>(&any)) return number(a->value());
  if (auto a = dynamic_cast<const Imf::IntAttribute*>(&any)) return number(a->value());
  if (auto a = dynamic_cast<const Imf::V2fAttribute*>(&any))
    return numbers(a->value().x, a->value().y);
  if (auto a = dynamic_cast<const Imf::V2iAttribute*>(&any))
    return numbers(a->value().x, a->value().y);
  if (auto a = dynamic_cast<const Imf::V3fAttribute*>(&any))
    return numbers(a->value().x, a->value().y, a->value().z);
  if (auto a = dynamic_cast<const Imf::V3iAttribute*>(&any))
    return numbers(a->value().x, a->value().y, a->value().z);
  if (auto a = dynamic_cast<const Imf::M33fAttribute*>(&any)) return matrix(a->value(), 3);
  if (auto a = dynamic_cast<const Imf::M44fAttribute*>(&any)) return matrix(a->value(), 4);
  if (auto a = dynamic_cast<const Imf::RationalAttribute*>(&any))
    return std::to_string(a->value().n) + "/" + std::to_string(a->value().d);
  if (auto a = dynamic_cast<const Imf::EnvmapAttribute*>(&any))
    return a->value() == Imf::ENVMAP_LATLONG ? "latlong" : "cube";
  if (auto a = dynamic_cast<const Imf::StringVectorAttribute*>(&any)) {
    std::string text;
    for (const auto& item : a->value()) text += (text.empty() ? "" : ", ") + item;
    return text;
  }
  return std::nullopt;
}

constexpr std::array<const char*, 10> compression_names = {
    "no compression", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"};

}  // namespace

Window window_of(const Imath::Box2i& box) {
  return {box.min.x, box.min.y, box.max.x + 1, box.max.y + 1};
}

Imath::Box2i box_of(const Window& window) {
  return {{window.x0, window.y0}, {window.x1 - 1, window.y1 - 1}};
}

void read_attributes(const Imf::Header& header, ImageSpec& spec) {
  spec.pixel_aspect = header.pixelAspectRatio();
  if (!(spec.pixel_aspect > 1e-6f && spec.pixel_aspect < 1e6f)) spec.pixel_aspect = 1;
  if (Imf::hasChromaticities(header)) {
    const auto& c = Imf::chromaticities(header);
    spec.chromaticities = Chromaticities{
        {c.red.x, c.red.y}, {c.green.x, c.green.y}, {c.blue.x, c.blue.y}, {c.white.x, c.white.y}};
  }
  if (Imf::hasFramesPerSecond(header)) {
    const auto& rate = Imf::framesPerSecond(header);
    if (rate.d != 0) spec.frames_per_second = double(rate.n) / double(rate.d);
  }
  for (auto a = header.begin(); a != header.end(); ++a) {
    if (structural.contains(a.name())) continue;
    if (auto text = as_text(a.attribute())) spec.attributes[a.name()] = *text;
  }
}

void write_attributes(const ImageSpec& spec, Imf::Header& header) {
  header.pixelAspectRatio() = spec.pixel_aspect;
  if (spec.chromaticities) {
    const auto point = [](const std::array<double, 2>& p) {
      return Imath::V2f(static_cast<float>(p[0]), static_cast<float>(p[1]));
    };
    const auto& c = *spec.chromaticities;
    Imf::addChromaticities(
        header, Imf::Chromaticities(point(c.red), point(c.green), point(c.blue), point(c.white)));
  }
  if (spec.frames_per_second > 0) {
    // Whole rates and the NTSC ones, n * 1000/1001, exactly; others in thousandths.
    const double rate = spec.frames_per_second;
    const double ntsc = std::round(rate * 1.001);
    Imf::Rational stored(static_cast<int>(std::lround(rate * 1000)), 1000);
    if (std::abs(rate - std::round(rate)) < 1e-9) {
      stored = Imf::Rational(static_cast<int>(std::lround(rate)), 1);
    } else if (std::abs(rate - ntsc / 1.001) < 1e-3) {
      stored = Imf::Rational(static_cast<int>(ntsc) * 1000, 1001);
    }
    Imf::addFramesPerSecond(header, stored);
  }
  for (const auto& [name, text] : spec.attributes) {
    if (name.empty() || name.size() > 255 || structural.contains(name)) continue;
    // The standard names have types of their own; those that are no text here are left out.
    const auto standard = header.find(name.c_str());
    if (standard != header.end()) continue;
    if (name == "multiView" || name == "envmap" || name == "view") {
      if (name == "envmap")
        Imf::addEnvmap(header, text == "cube" ? Imf::ENVMAP_CUBE : Imf::ENVMAP_LATLONG);
      continue;
    }
    header.insert(name, Imf::StringAttribute(text));
  }
}

std::string describe_storage(const Imf::Header& header, int parts) {
  const auto method = static_cast<std::size_t>(header.compression());
  std::string text = method < compression_names.size() ? compression_names[method] : "?";
  if (header.hasTileDescription()) {
    const auto& tile = header.tileDescription();
    text += ", tiles of " + std::to_string(tile.xSize) + " x " + std::to_string(tile.ySize);
    if (tile.mode == Imf::MIPMAP_LEVELS) text += ", mip-map";
    if (tile.mode == Imf::RIPMAP_LEVELS) text += ", rip-map";
  } else {
    text += ", scan lines";
  }
  if (parts > 1) text += ", " + std::to_string(parts) + " parts";
  return text;
}

ImageError explain(const std::string& file, const std::exception& problem) {
  const std::string what = problem.what();
  const auto says = [&](const char* words) { return what.find(words) != std::string::npos; };
  if (says("ends too early") || says("missing") || says("end of file") || says("incomplete"))
    return {ErrorKind::truncated, file + " is incomplete: it was cut short (" + what + ")"};
  if (says("deep")) return {ErrorKind::unsupported, file + " holds deep data, which is not read"};
  if (says("cannot be read")) return {ErrorKind::cannot_read, file + " cannot be read"};
  if (says("no view")) return {ErrorKind::bad_request, file + ": " + what};
  return {ErrorKind::damaged, file + " is damaged (" + what + ")"};
}

}  // namespace pse::image::exr
