// The check of an EXR header before the library sees it; see exr_header.h. Follows the file layout
// that the OpenEXR project publishes ("OpenEXR File Layout"): magic, version, attributes (name,
// type, size, value), chunk table.
#include "image/exr_header.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace pse::image {
namespace {

constexpr std::uint32_t flag_tiled = 0x200, flag_deep = 0x800, flag_multi_part = 0x1000;
constexpr std::uint32_t known_flags = 0x1e00;
constexpr int max_parts = 1024, max_attributes = 65536;

// Rows per chunk of each compression, by its number in the file.
constexpr std::array<int, 10> chunk_rows = {1, 1, 1, 16, 32, 16, 32, 32, 32, 256};

// How many times smaller than its content a chunk can be, generously: deflate reaches 1032, and the
// lossy methods drop up to 63 of 64 numbers before it.
constexpr std::array<double, 10> densest = {1, 64, 1100, 1100, 1100, 2200, 3, 16, 100000, 100000};

// What the check needs to know of one part.
struct PartFacts {
  bool has_channels = false, has_window = false, has_tiles = false, deep = false, tiled = false;
  int channels = 0;
  double pixel_bytes = 0;
  std::int64_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // inclusive, as in the file
  std::uint32_t tile_x = 0, tile_y = 0;
  unsigned compression = 0;
};

// A cursor over the file. Once anything was out of reach `ended` stays set and every value is 0.
struct Cursor {
  const ByteSource& bytes;
  std::uint64_t at = 0;
  bool ended = false;

  std::uint64_t left() const { return bytes.size() > at ? bytes.size() - at : 0; }

  bool take(void* to, std::size_t count) {
    if (ended || bytes.read_at(at, to, count) != static_cast<std::int64_t>(count)) {
      ended = true;
      std::memset(to, 0, count);
      return false;
    }
    at += count;
    return true;
  }

  std::uint32_t u32() {
    std::array<unsigned char, 4> raw{};
    take(raw.data(), raw.size());
    return raw[0] | (raw[1] << 8) | (raw[2] << 16) | (std::uint32_t{raw[3]} << 24);
  }
  std::int32_t i32() { return static_cast<std::int32_t>(u32()); }

  // A text that ends with a NUL; at most 255 bytes.
  std::string text() {
    std::array<char, 256> raw{};
    if (ended) return {};
    const std::int64_t got = bytes.read_at(at, raw.data(), raw.size());
    const char* end =
        got > 0
            ? static_cast<const char*>(std::memchr(raw.data(), 0, static_cast<std::size_t>(got)))
            : nullptr;
    if (end == nullptr) {
      ended = true;
      return {};
    }
    at += static_cast<std::uint64_t>(end - raw.data()) + 1;
    return std::string(raw.data(), static_cast<std::size_t>(end - raw.data()));
  }
};

// The channel list: name, pixel type, flags and sampling of each.
Result<void> look_at_channels(Cursor at, std::uint64_t size, const ReadLimits& limits,
                              PartFacts& part, const std::string& file) {
  const std::uint64_t end = at.at + size;
  part.has_channels = true;
  while (at.at < end && !at.ended) {
    if (at.text().empty()) {
      if (at.at == end) return {};
      break;
    }
    const std::uint32_t type = at.u32();
    at.u32();
    const std::int32_t x_step = at.i32(), y_step = at.i32();
    if (type > 2 || x_step < 1 || y_step < 1)
      return fail(ErrorKind::damaged, file + " is damaged: a channel of an unknown type");
    part.pixel_bytes += (type == 1 ? 2.0 : 4.0) / (double(x_step) * y_step);
    if (++part.channels > limits.max_channels)
      return fail(ErrorKind::too_large,
                  file + " has more than " + std::to_string(limits.max_channels) + " channels");
  }
  return fail(ErrorKind::damaged, file + " is damaged: its list of channels has a wrong length");
}

// Types whose values have a size of their own. The library reads that many bytes whatever the file
// says, and would take what follows for the next attribute.
struct FixedSize {
  const char* type;
  std::uint64_t bytes;
};
constexpr std::array<FixedSize, 24> fixed_sizes = {
    {{"box2f", 16},      {"box2i", 16},   {"chromaticities", 32},
     {"compression", 1}, {"double", 8},   {"envmap", 1},
     {"float", 4},       {"int", 4},      {"keycode", 28},
     {"lineOrder", 1},   {"m33f", 36},    {"m33d", 72},
     {"m44f", 64},       {"m44d", 128},   {"rational", 8},
     {"tiledesc", 9},    {"timecode", 8}, {"v2i", 8},
     {"v2f", 8},         {"v2d", 16},     {"v3i", 12},
     {"v3f", 12},        {"v3d", 24},     {"deepImageState", 1}}};

// Lengths inside an attribute must add up to its size.
bool inner_lengths_fit(Cursor at, const std::string& type, std::uint64_t size) {
  const std::uint64_t end = at.at + size;
  for (const auto& fixed : fixed_sizes)
    if (type == fixed.type && size != fixed.bytes) return false;
  if (type == "floatvector") return size % 4 == 0;
  if (type == "chlist") {
    // Name, and four numbers of four bytes, up to an empty name.
    while (at.at < end) {
      if (at.text().empty()) return !at.ended && at.at == end;
      at.at += 16;
    }
    return false;
  }
  if (type == "stringvector") {
    while (at.at + 4 <= end) {
      const std::uint64_t length = at.u32();
      if (length > end - at.at) return false;
      at.at += length;
    }
    return at.at == end;
  }
  if (type == "preview") {
    const std::uint64_t width = at.u32(), height = at.u32();
    return size >= 8 && width < 65536 && height < 65536 && 8 + 4 * width * height == size;
  }
  return true;
}

// Reads the attributes of one part. False: there was none (the end of a list of parts).
Result<bool> look_at_part(Cursor& at, const ReadLimits& limits, PartFacts& part) {
  const std::string& file = at.bytes.name();
  for (int count = 0;; ++count) {
    const std::string name = at.text();
    if (at.ended) return fail(ErrorKind::truncated, file + " ends inside its header");
    if (name.empty()) return count > 0;
    const std::string type = at.text();
    const std::int64_t size = at.i32();
    if (at.ended) return fail(ErrorKind::truncated, file + " ends inside its header");
    if (size < 0 || count > max_attributes)
      return fail(ErrorKind::damaged, file + " is damaged: its header makes no sense");
    if (static_cast<std::uint64_t>(size) > at.left())
      return fail(ErrorKind::truncated, file + " ends inside its header");
    if (!inner_lengths_fit(at, type, static_cast<std::uint64_t>(size)))
      return fail(ErrorKind::damaged, file + " is damaged: attribute " + name + " makes no sense");

    Cursor value = at;
    if (name == "channels" && type == "chlist") {
      if (auto seen = look_at_channels(at, static_cast<std::uint64_t>(size), limits, part, file);
          !seen)
        return std::unexpected(seen.error());
    } else if (name == "dataWindow" && type == "box2i" && size == 16) {
      part.x0 = value.i32(), part.y0 = value.i32(), part.x1 = value.i32(), part.y1 = value.i32();
      part.has_window = true;
    } else if (name == "tiles" && type == "tiledesc" && size == 9) {
      part.tile_x = value.u32(), part.tile_y = value.u32();
      part.has_tiles = true;
    } else if (name == "compression" && size == 1) {
      unsigned char raw = 0;
      value.take(&raw, 1);
      part.compression = raw;
    } else if (name == "type" && type == "string") {
      std::string kind(static_cast<std::size_t>(std::min<std::int64_t>(size, 64)), '\0');
      value.take(kind.data(), kind.size());
      part.deep = kind.starts_with("deep");
      part.tiled = kind.starts_with("tiled");
    }
    at.at += static_cast<std::uint64_t>(size);
  }
}

// Whether the part's claims are possible in a file of this size and within the limits.
Result<void> judge(const PartFacts& part, const ByteSource& bytes, const ReadLimits& limits,
                   double& claimed, std::uint64_t& needed) {
  const std::string& file = bytes.name();
  if (!part.has_channels || !part.has_window)
    return fail(ErrorKind::damaged, file + " is damaged: its header lacks channels or a window");
  if (part.compression >= chunk_rows.size())
    return fail(ErrorKind::unsupported, file + " is compressed in a way that is not known here");
  if (part.channels == 0) return fail(ErrorKind::damaged, file + " has no channels");

  const std::int64_t width = part.x1 - part.x0 + 1, height = part.y1 - part.y0 + 1;
  constexpr std::int64_t far = 1 << 30;
  if (width < 1 || height < 1)
    return fail(ErrorKind::damaged, file + " is damaged: its data window is empty");
  const std::string size = std::to_string(width) + " x " + std::to_string(height);
  if (part.x0 < -far || part.y0 < -far || part.x1 > far || part.y1 > far ||
      double(width) * double(height) > double(limits.max_pixels))
    return fail(ErrorKind::too_large, file + " claims to have " + size +
                                          " pixels, more than the limit of " +
                                          std::to_string(limits.max_pixels));

  // What the library decodes at once: a chunk of rows, or a row of tiles.
  double rows = chunk_rows[part.compression];
  std::uint64_t chunks = static_cast<std::uint64_t>(height + chunk_rows[part.compression] - 1) /
                         static_cast<std::uint64_t>(chunk_rows[part.compression]);
  double columns = double(width);
  if (part.tiled) {
    if (!part.has_tiles || part.tile_x < 1 || part.tile_y < 1 || part.tile_x > far ||
        part.tile_y > far)
      return fail(ErrorKind::damaged, file + " is damaged: its tiles have no size");
    const std::uint64_t wide = static_cast<std::uint64_t>(width - 1) / part.tile_x + 1;
    const std::uint64_t high = static_cast<std::uint64_t>(height - 1) / part.tile_y + 1;
    chunks = wide * high;
    rows = part.tile_y;
    columns = std::max(columns, double(part.tile_x));
  }
  if (columns * rows * part.pixel_bytes > double(limits.max_band_bytes))
    return fail(ErrorKind::too_large, file + " (" + size +
                                          " pixels) must be decoded in pieces larger than the "
                                          "limit of " +
                                          std::to_string(limits.max_band_bytes) + " bytes");

  // Every chunk takes at least an entry of the table and a header.
  needed += chunks * 16;
  claimed += double(width) * double(height) * part.pixel_bytes / densest[part.compression];
  if (needed > bytes.size() || claimed > double(bytes.size()) + 65536.0)
    return fail(ErrorKind::truncated, file + " claims to have " + size +
                                          " pixels and is far too short for that (" +
                                          std::to_string(bytes.size()) + " bytes)");
  return {};
}

}  // namespace

bool is_exr(const ByteSource& bytes) {
  std::array<unsigned char, 4> magic{};
  return bytes.read_at(0, magic.data(), 4) == 4 && magic[0] == 0x76 && magic[1] == 0x2f &&
         magic[2] == 0x31 && magic[3] == 0x01;
}

Result<void> check_exr_header(const ByteSource& bytes, const ReadLimits& limits) {
  const std::string& file = bytes.name();
  Cursor at{bytes};
  at.u32();
  const std::uint32_t version = at.u32();
  if (at.ended) return fail(ErrorKind::truncated, file + " ends inside its header");
  if ((version & 0xff) != 2 || (version & ~0xffu & ~known_flags) != 0)
    return fail(ErrorKind::unsupported, file + " is an EXR file of an unknown version");

  double claimed = 0;
  std::uint64_t needed = 0;
  const bool many = (version & flag_multi_part) != 0;
  for (int count = 0;; ++count) {
    if (count > max_parts) return fail(ErrorKind::too_large, file + " has too many parts");
    PartFacts part;
    part.deep = (version & flag_deep) != 0 && !many;
    const auto there = look_at_part(at, limits, part);
    if (!there) return std::unexpected(there.error());
    if (!*there) {
      if (count == 0) return fail(ErrorKind::damaged, file + " is damaged: its header is empty");
      return {};
    }
    if (!many && (version & flag_tiled) != 0) part.tiled = true;
    if (part.deep)
      return fail(ErrorKind::unsupported,
                  file + " holds deep data, which is not read; flatten it first");
    if (auto good = judge(part, bytes, limits, claimed, needed); !good) return good;
    if (!many) return {};
  }
}

}  // namespace pse::image
