// Reading the points of a PLY file; see table.h.
#include <charconv>
#include <new>

#include "image/ply_header.h"
#include "image/table.h"

namespace pse::image {
namespace {

std::unexpected<ImageError> damaged(const ByteSource& bytes, const std::string& what) {
  return fail(ErrorKind::damaged, bytes.name() + ": " + what);
}

std::string column_name(const std::string& property) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 8> known = {
      {{"nx", "normal.x"},
       {"ny", "normal.y"},
       {"nz", "normal.z"},
       {"red", "color.r"},
       {"green", "color.g"},
       {"blue", "color.b"},
       {"diffuse_red", "color.r"},
       {"diffuse_green", "color.g"}}};
  for (const auto& [from, to] : known)
    if (property == from) return std::string(to);
  return property == "diffuse_blue" ? "color.b" : property;
}

// The points, which must come first and be plain numbers.
Result<PlyElement> points_of(const PlyHeader& header, const ByteSource& bytes) {
  bool comes_first = true;
  for (const PlyElement& element : header.elements) {
    if (element.name == "vertex" && element.rows > 0 && !element.properties.empty()) {
      if (!comes_first)
        return fail(ErrorKind::unsupported,
                    bytes.name() + ": the points do not come first in the file");
      for (const PlyProperty& property : element.properties)
        if (property.count)
          return fail(ErrorKind::unsupported,
                      bytes.name() + ": the points of the PLY file have lists");
      return element;
    }
    if (element.rows > 0) comes_first = false;
  }
  return damaged(bytes, "the PLY file has no points");
}

// What a stored number means: bytes of a colour are sRGB.
float meaning(double value, const PlyProperty& property, const std::string& column) {
  if (!column.starts_with("color.") || property.type.bytes != 1) return static_cast<float>(value);
  const double s = value / 255;
  return static_cast<float>(s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4));
}

// All numbers of the points, in the order of the file, given one by one.
template <typename Next>
Result<void> take_rows(const ByteSource& bytes, const PlyElement& points, Columns& table,
                       const Next& next) {
  for (std::int64_t row = 0; row < points.rows; ++row) {
    for (std::size_t c = 0; c < points.properties.size(); ++c) {
      double value = 0;
      if (!next(points.properties[c], value))
        return fail(ErrorKind::truncated, bytes.name() + ": point " + std::to_string(row + 1) +
                                              " of " + std::to_string(points.rows) +
                                              " is missing or is no number");
      const float number = meaning(value, points.properties[c], table.names[c]);
      if (!std::isfinite(number))
        return fail(ErrorKind::not_finite, bytes.name() + ": point " + std::to_string(row + 1) +
                                               " has a `" + points.properties[c].name +
                                               "` that is NaN or infinite");
      table.values[c].push_back(number);
    }
  }
  return {};
}

}  // namespace

bool is_ply(const ByteSource& bytes) {
  std::array<char, 4> start{};
  return bytes.read_at(0, start.data(), 4) == 4 && start[0] == 'p' && start[1] == 'l' &&
         start[2] == 'y' && (start[3] == '\n' || start[3] == '\r');
}

Result<Columns> read_ply(const ByteSource& bytes, const ReadLimits& limits) try {
  const auto header = read_ply_header(bytes);
  if (!header) return std::unexpected(header.error());
  const auto points = points_of(*header, bytes);
  if (!points) return std::unexpected(points.error());
  std::uint64_t size = 0;
  for (const PlyProperty& property : points->properties)
    size += static_cast<std::uint64_t>(header->order == PlyOrder::ascii ? 2 : property.type.bytes);
  const auto rows = static_cast<std::uint64_t>(points->rows);
  const std::uint64_t data = bytes.size() - std::min(bytes.size(), header->end);
  if (points->properties.size() > static_cast<std::size_t>(limits.max_channels) ||
      rows >= 1u << 29 ||
      double(rows) * 4 * double(points->properties.size()) > double(limits.max_bytes))
    return fail(ErrorKind::too_large, bytes.name() + " has too many points");
  if (rows > data / size + 1)
    return fail(ErrorKind::truncated,
                bytes.name() + " ends before its " + std::to_string(rows) + " points");

  Columns table;
  for (const PlyProperty& property : points->properties) {
    table.names.push_back(column_name(property.name));
    if (table.find(table.names.back()) != static_cast<int>(table.names.size()) - 1)
      return damaged(bytes, "two properties are called `" + property.name + "`");
  }
  table.values.resize(table.names.size());
  std::vector<unsigned char> content(data);
  if (bytes.read_at(header->end, content.data(), data) != static_cast<std::int64_t>(data))
    return fail(ErrorKind::cannot_read, "cannot read " + bytes.name());

  std::size_t at = 0;
  Result<void> done;
  if (header->order == PlyOrder::ascii) {
    const char* text = reinterpret_cast<const char*>(content.data());
    done = take_rows(bytes, *points, table, [&](const PlyProperty&, double& value) {
      while (at < data &&
             (text[at] == ' ' || text[at] == '\n' || text[at] == '\r' || text[at] == '\t'))
        ++at;
      const auto [end, error] = std::from_chars(text + at, text + data, value);
      at = static_cast<std::size_t>(end - text);
      return error == std::errc();
    });
  } else {
    const bool swap = header->swapped();
    done = take_rows(bytes, *points, table, [&](const PlyProperty& property, double& value) {
      const auto step = static_cast<std::size_t>(property.type.bytes);
      if (at + step > data) return false;
      value = ply_number(content.data() + at, property.type, swap);
      at += step;
      return true;
    });
  }
  if (!done) return std::unexpected(done.error());
  return table;
} catch (const std::bad_alloc&) {
  return fail(ErrorKind::too_large, "not enough memory for " + bytes.name());
}

}  // namespace pse::image
