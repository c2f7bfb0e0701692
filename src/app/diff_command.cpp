// `pse diff`: two images, pixel by pixel.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/session.h"
#include "app/values.h"
#include "image/compare.h"
#include "image/writer.h"

namespace pse::app {
namespace {

[[noreturn]] void fail(const image::ImageError& error) {
  throw Failure(error.is_output() ? Exit::output : Exit::input, error.message);
}

std::unique_ptr<image::ImageReader> open(const std::string& file) {
  auto reader = image::open_reader(file);
  if (!reader) fail(reader.error());
  return std::move(*reader);
}

// |a - b| of the channels that both have, over the first image's data window.
void write_difference(image::ImageReader& a, image::ImageReader& b, const std::string& file) {
  const auto first = image::read_image(a, {}), second = image::read_image(b, {});
  if (!first) fail(first.error());
  if (!second) fail(second.error());
  image::ImageSpec spec;
  spec.display = first->spec.display;
  spec.data = first->spec.data;
  for (const image::Channel& channel : first->spec.channels)
    if (second->spec.find(channel.name) >= 0)
      spec.channels.push_back({channel.name, image::PixelType::float32});
  image::Image difference(spec);
  for (std::size_t c = 0; c < spec.channels.size(); ++c) {
    const int in_first = first->spec.find(spec.channels[c].name),
              in_second = second->spec.find(spec.channels[c].name);
    std::size_t at = 0;
    for (int y = spec.data.y0; y < spec.data.y1; ++y)
      for (int x = spec.data.x0; x < spec.data.x1; ++x)
        difference.planes[c][at++] =
            std::abs(first->at(in_first, x, y) - second->at(in_second, x, y));
  }
  if (const auto done = image::write_image(file, difference); !done) fail(done.error());
}

}  // namespace

Exit diff_command(Session& session) {
  const auto& names = session.arguments.positionals;
  if (names.size() != 2) throw usage_error("diff needs two images", "pse diff A B");
  if (names[0] == "-" && names[1] == "-") throw usage_error("standard input can be read only once");
  const auto limit = session.arguments.value("tolerance");
  const double tolerance = limit ? parse_number(*limit, 0, 1e30) : 0;

  const auto a = open(session.find_file(names[0])), b = open(session.find_file(names[1]));
  const auto comparison = image::compare(*a, *b, tolerance);
  if (!comparison) fail(comparison.error());

  if (session.arguments.has("json")) {
    nlohmann::ordered_json json = {{"same", comparison->same()},
                                   {"shape", comparison->shape},
                                   {"channels", nlohmann::ordered_json::array()}};
    for (const image::ChannelDifference& c : comparison->channels)
      json["channels"].push_back({{"name", c.name},
                                  {"largest", c.largest},
                                  {"rms", c.rms},
                                  {"x", c.x},
                                  {"y", c.y},
                                  {"above", c.above}});
    session.console.print(json.dump(2) + "\n");
  } else {
    for (const std::string& line : comparison->shape) session.console.print(line + "\n");
    for (const image::ChannelDifference& c : comparison->channels)
      if (c.largest > 0)
        session.console.print(fmt::format(
            "{}: largest difference {:.9g} at ({}, {}), rms {:.9g}, {} pixels above {:g}\n", c.name,
            c.largest, c.x, c.y, c.rms, c.above, tolerance));
    session.console.note(comparison->same() ? "no difference" : "the images differ");
  }
  if (const auto file = session.arguments.value("output")) {
    const auto again_a = open(session.find_file(names[0])),
               again_b = open(session.find_file(names[1]));
    write_difference(*again_a, *again_b, file->text);
  }
  return comparison->same() ? Exit::ok : Exit::strict;
}

}  // namespace pse::app
