// Reading the head of a PLY file.
#include "image/ply_header.h"

#include <sstream>

namespace pse::image {
namespace {

constexpr std::size_t longest_header = 1 << 16;

std::unexpected<ImageError> bad_header(const ByteSource& bytes, const std::string& what) {
  return fail(ErrorKind::damaged, bytes.name() + ": " + what);
}

// Of 0 bytes where PLY has no such type.
PlyType type_of(const std::string& name) {
  if (name == "char" || name == "int8") return {1, false, true};
  if (name == "uchar" || name == "uint8") return {1, false, false};
  if (name == "short" || name == "int16") return {2, false, true};
  if (name == "ushort" || name == "uint16") return {2, false, false};
  if (name == "int" || name == "int32") return {4, false, true};
  if (name == "uint" || name == "uint32") return {4, false, false};
  if (name == "float" || name == "float32") return {4, true, true};
  if (name == "double" || name == "float64") return {8, true, true};
  return {};
}

// The rest of a line that begins with `property`; nothing where it is none of PLY's.
std::optional<PlyProperty> property_of(std::istringstream& words) {
  std::string kind, count;
  PlyProperty property;
  words >> kind;
  if (kind == "list") {
    words >> count >> kind;
    property.count = type_of(count);
    if (property.count->bytes == 0 || property.count->real) return {};
  }
  property.type = type_of(kind);
  words >> property.name;
  if (property.type.bytes == 0 || property.name.empty()) return {};
  return property;
}

}  // namespace

Result<PlyHeader> read_ply_header(const ByteSource& bytes) {
  std::string text(std::min<std::uint64_t>(bytes.size(), longest_header), '\0');
  const std::int64_t got = bytes.read_at(0, text.data(), text.size());
  text.resize(static_cast<std::size_t>(std::max<std::int64_t>(got, 0)));
  const std::size_t end = text.find("end_header");
  const std::size_t line_end = end == std::string::npos ? end : text.find('\n', end);
  if (line_end == std::string::npos)
    return bad_header(bytes, "the header of the PLY file has no end");
  PlyHeader header;
  header.end = line_end + 1;
  std::istringstream lines(text.substr(0, end));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "format") {
      std::string kind;
      words >> kind;
      if (kind != "ascii" && kind != "binary_little_endian" && kind != "binary_big_endian")
        return bad_header(bytes, "the format `" + kind + "` is not one of PLY's");
      header.order = kind == "ascii"                  ? PlyOrder::ascii
                     : kind == "binary_little_endian" ? PlyOrder::little
                                                      : PlyOrder::big;
    } else if (word == "element") {
      PlyElement element;
      if (!(words >> element.name >> element.rows) || element.rows < 0)
        return bad_header(bytes, "the element `" + element.name + "` has no count");
      header.elements.push_back(std::move(element));
    } else if (word == "property" && !header.elements.empty()) {
      auto property = property_of(words);
      if (!property) return bad_header(bytes, "`" + line + "` is no property of PLY");
      header.elements.back().properties.push_back(std::move(*property));
    }
  }
  return header;
}

}  // namespace pse::image
