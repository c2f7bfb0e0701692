// Reading the points of a PLY file; see table.h.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <new>
#include <sstream>

#include "image/table.h"

namespace pse::image {
namespace {

enum class Order { ascii, little, big };

struct Property {
  std::string name;
  int bytes = 4;
  bool real = true, with_sign = true;
};

struct Header {
  Order order = Order::ascii;
  std::int64_t rows = 0;
  std::vector<Property> properties;
  std::uint64_t end = 0;  // where the data begin
};

constexpr std::size_t longest_header = 1 << 16;

std::unexpected<ImageError> damaged(const ByteSource& bytes, const std::string& what) {
  return fail(ErrorKind::damaged, bytes.name() + ": " + what);
}

// Bytes, kind of a property's type; 0 bytes for a type that PLY does not have.
Property type_of(const std::string& name) {
  if (name == "char" || name == "int8") return {"", 1, false, true};
  if (name == "uchar" || name == "uint8") return {"", 1, false, false};
  if (name == "short" || name == "int16") return {"", 2, false, true};
  if (name == "ushort" || name == "uint16") return {"", 2, false, false};
  if (name == "int" || name == "int32") return {"", 4, false, true};
  if (name == "uint" || name == "uint32") return {"", 4, false, false};
  if (name == "float" || name == "float32") return {"", 4, true, true};
  if (name == "double" || name == "float64") return {"", 8, true, true};
  return {"", 0, false, false};
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

Result<Header> read_header(const ByteSource& bytes) {
  std::string text(std::min<std::uint64_t>(bytes.size(), longest_header), '\0');
  const std::int64_t got = bytes.read_at(0, text.data(), text.size());
  text.resize(static_cast<std::size_t>(std::max<std::int64_t>(got, 0)));
  const std::size_t end = text.find("end_header");
  const std::size_t line_end = end == std::string::npos ? end : text.find('\n', end);
  if (line_end == std::string::npos) return damaged(bytes, "the header of the PLY file has no end");
  Header header;
  header.end = line_end + 1;
  std::istringstream lines(text.substr(0, end));
  bool in_points = false, before = true;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string word, kind, name;
    words >> word;
    if (word == "format") {
      words >> kind;
      if (kind != "ascii" && kind != "binary_little_endian" && kind != "binary_big_endian")
        return damaged(bytes, "the format `" + kind + "` is not one of PLY's");
      header.order = kind == "ascii"                  ? Order::ascii
                     : kind == "binary_little_endian" ? Order::little
                                                      : Order::big;
    } else if (word == "element") {
      std::int64_t count = -1;
      words >> name >> count;
      if (count < 0) return damaged(bytes, "the element `" + name + "` has no count");
      in_points = name == "vertex";
      if (in_points) header.rows = count;
      if (!in_points && header.properties.empty() && count > 0) before = false;
    } else if (word == "property" && in_points) {
      words >> kind >> name;
      if (kind == "list")
        return fail(ErrorKind::unsupported,
                    bytes.name() + ": the points of the PLY file have lists");
      Property property = type_of(kind);
      if (property.bytes == 0 || name.empty())
        return damaged(bytes, "`" + line + "` is no property of PLY");
      property.name = name;
      header.properties.push_back(property);
    }
  }
  if (header.properties.empty() || header.rows == 0)
    return damaged(bytes, "the PLY file has no points");
  if (!before)
    return fail(ErrorKind::unsupported,
                bytes.name() + ": the points do not come first in the file");
  return header;
}

double decode(const unsigned char* at, const Property& property, bool swap) {
  std::array<unsigned char, 8> raw{};
  std::copy_n(at, property.bytes, raw.begin());
  if (swap) std::reverse(raw.begin(), raw.begin() + property.bytes);
  if (property.real) {
    if (property.bytes == 4) {
      float value = 0;
      std::memcpy(&value, raw.data(), 4);
      return value;
    }
    double value = 0;
    std::memcpy(&value, raw.data(), 8);
    return value;
  }
  std::uint64_t value = 0;
  for (int i = 0; i < property.bytes; ++i)
    value |= std::uint64_t{raw[static_cast<std::size_t>(i)]} << (8 * i);
  const int bits = 8 * property.bytes;
  const bool negative = property.with_sign && (value >> (bits - 1) & 1) != 0;
  return static_cast<double>(value) - (negative ? std::ldexp(1.0, bits) : 0.0);
}

// What a stored number means: bytes of a colour are sRGB.
float meaning(double value, const Property& property, const std::string& column) {
  if (!column.starts_with("color.") || property.bytes != 1) return static_cast<float>(value);
  const double s = value / 255;
  return static_cast<float>(s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4));
}

// All numbers of the points, in the order of the file, given one by one.
template <typename Next>
Result<void> take_rows(const ByteSource& bytes, const Header& header, Columns& table,
                       const Next& next) {
  for (std::int64_t row = 0; row < header.rows; ++row) {
    for (std::size_t c = 0; c < header.properties.size(); ++c) {
      double value = 0;
      if (!next(header.properties[c], value))
        return fail(ErrorKind::truncated, bytes.name() + ": point " + std::to_string(row + 1) +
                                              " of " + std::to_string(header.rows) +
                                              " is missing or is no number");
      const float number = meaning(value, header.properties[c], table.names[c]);
      if (!std::isfinite(number))
        return fail(ErrorKind::not_finite, bytes.name() + ": point " + std::to_string(row + 1) +
                                               " has a `" + header.properties[c].name +
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
  const auto header = read_header(bytes);
  if (!header) return std::unexpected(header.error());
  std::uint64_t size = 0;
  for (const Property& property : header->properties)
    size += static_cast<std::uint64_t>(header->order == Order::ascii ? 2 : property.bytes);
  const auto rows = static_cast<std::uint64_t>(header->rows);
  const std::uint64_t data = bytes.size() - std::min(bytes.size(), header->end);
  if (header->properties.size() > static_cast<std::size_t>(limits.max_channels) ||
      rows >= 1u << 29 ||
      double(rows) * 4 * double(header->properties.size()) > double(limits.max_bytes))
    return fail(ErrorKind::too_large, bytes.name() + " has too many points");
  if (rows > data / size + 1)
    return fail(ErrorKind::truncated,
                bytes.name() + " ends before its " + std::to_string(rows) + " points");

  Columns table;
  for (const Property& property : header->properties) {
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
  if (header->order == Order::ascii) {
    const char* text = reinterpret_cast<const char*>(content.data());
    done = take_rows(bytes, *header, table, [&](const Property&, double& value) {
      while (at < data &&
             (text[at] == ' ' || text[at] == '\n' || text[at] == '\r' || text[at] == '\t'))
        ++at;
      const auto [end, error] = std::from_chars(text + at, text + data, value);
      at = static_cast<std::size_t>(end - text);
      return error == std::errc();
    });
  } else {
    const bool swap = (header->order == Order::big) == (std::endian::native == std::endian::little);
    done = take_rows(bytes, *header, table, [&](const Property& property, double& value) {
      const auto step = static_cast<std::size_t>(property.bytes);
      if (at + step > data) return false;
      value = decode(content.data() + at, property, swap);
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
