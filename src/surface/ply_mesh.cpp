// Binary PLY in one pass: a megabyte of the file at a time, record by record.
#include "surface/ply_mesh.h"

#include <array>

#include "image/ply_header.h"
#include "image/table.h"
#include "surface/mesh_file.h"

namespace pse::surface {
namespace {

using image::PlyElement, image::PlyHeader, image::PlyProperty, image::PlyType;

// The file's bytes in turn.
class Bytes {
 public:
  Bytes(const image::ByteSource& source, std::uint64_t at)
      : source_(source), next_(at), block_(std::min<std::uint64_t>(most, source.size())) {}
  std::uint64_t left() const {
    return source_.size() - std::min(source_.size(), next_) + (filled_ - used_);
  }
  // The next `count` bytes, not more than `most`; null where the file ends before them.
  const unsigned char* take(std::size_t count) {
    if (filled_ - used_ < count && !fill(count)) return nullptr;
    used_ += count;
    return block_.data() + used_ - count;
  }
  static constexpr std::size_t most = 1 << 20;

 private:
  bool fill(std::size_t count) {
    std::copy(block_.begin() + static_cast<std::ptrdiff_t>(used_),
              block_.begin() + static_cast<std::ptrdiff_t>(filled_), block_.begin());
    filled_ -= used_, used_ = 0;
    const std::int64_t got =
        source_.read_at(next_, block_.data() + filled_, block_.size() - filled_);
    if (got > 0) next_ += static_cast<std::uint64_t>(got), filled_ += static_cast<std::size_t>(got);
    return filled_ >= count;
  }

  const image::ByteSource& source_;
  std::uint64_t next_;
  std::vector<unsigned char> block_;
  std::size_t used_ = 0, filled_ = 0;
};

// A number of each vertex that a mesh has a place for.
struct Column {
  std::vector<float>* to;
  std::size_t offset;  // in the record
  PlyType type;
};

// The columns of positions, then of normals and coordinates where they are whole; empty where x, y
// and z are not.
std::vector<Column> columns_of(const PlyElement& element, Mesh& mesh) {
  struct Group {
    std::vector<float>* to;
    std::vector<const char*> names;
  };
  const Group groups[] = {{&mesh.positions, {"x", "y", "z"}},
                          {&mesh.normals, {"nx", "ny", "nz"}},
                          {&mesh.uvs, {"u", "v"}},
                          {&mesh.uvs, {"s", "t"}},
                          {&mesh.uvs, {"tx", "ty"}},
                          {&mesh.uvs, {"texture_u", "texture_v"}}};
  std::vector<Column> all;
  bool has_uv = false;
  for (const Group& group : groups) {
    std::vector<Column> found;
    for (const char* name : group.names) {
      std::size_t offset = 0;
      for (const PlyProperty& property : element.properties) {
        if (property.name == name) {
          found.push_back({group.to, offset, property.type});
          break;
        }
        offset += static_cast<std::size_t>(property.type.bytes);
      }
    }
    const bool is_uv = group.to == &mesh.uvs, whole = found.size() == group.names.size();
    if (group.to == &mesh.positions && !whole) return {};
    if (!whole || (is_uv && has_uv)) continue;
    has_uv |= is_uv;
    all.insert(all.end(), found.begin(), found.end());
  }
  return all;
}

// The bytes that a record has at least.
std::size_t least_bytes(const PlyElement& element) {
  std::size_t bytes = 0;
  for (const PlyProperty& property : element.properties)
    bytes += static_cast<std::size_t>((property.count ? *property.count : property.type).bytes);
  return bytes;
}

bool has_lists(const PlyElement& element) {
  return std::any_of(element.properties.begin(), element.properties.end(),
                     [](const PlyProperty& property) { return property.count.has_value(); });
}

bool is_corner_list(const PlyProperty& property) {
  return property.count && !property.type.real &&
         (property.name == "vertex_indices" || property.name == "vertex_index");
}

// Where a quadrilateral is cut: from its inward corner, if it has one.
std::size_t cut_of(const Mesh& mesh, const std::array<std::uint32_t, 4>& corner) {
  for (const std::uint32_t c : corner)
    if (c >= mesh.vertex_count()) return 0;
  std::array<Vec3, 4> turn;
  Vec3 up;
  for (std::size_t k = 0; k < 4; ++k) {
    const Vec3 at = mesh.position(corner[k]);
    turn[k] =
        cross(at - mesh.position(corner[(k + 3) % 4]), mesh.position(corner[(k + 1) % 4]) - at);
    up = up + turn[k];
  }
  for (std::size_t k = 0; k < 4; ++k)
    if (dot(turn[k], up) < 0) return k;
  return 0;
}

std::string ends_early(const PlyElement& element, std::int64_t row) {
  return "the file ends at " + element.name + " " + std::to_string(row + 1) + " of " +
         std::to_string(element.rows) + ": it is damaged, or was not written to its end";
}

class Reader {
 public:
  Reader(const PlyHeader& header, const image::ByteSource& source, std::size_t most, Mesh& mesh)
      : header_(header),
        bytes_(source, header.end),
        swap_(header.swapped()),
        most_(most),
        mesh_(mesh) {}

  std::expected<bool, std::string> read() {
    if (header_.order == image::PlyOrder::ascii) return false;
    bool has_vertices = false, has_faces = false;
    for (const PlyElement& element : header_.elements) {
      if (has_vertices && has_faces) break;
      const std::size_t least = std::max<std::size_t>(least_bytes(element), 1);
      const std::uint64_t fit = bytes_.left() / least;
      const auto rows = static_cast<std::uint64_t>(element.rows);
      if (element.properties.empty() && rows > 0) return false;
      if (element.name == "face" && rows > most_)
        return std::unexpected(too_many_triangles(rows, most_));
      if (rows > fit) return std::unexpected(ends_early(element, static_cast<std::int64_t>(fit)));
      std::expected<bool, std::string> done = true;
      if (element.name == "vertex") {
        done = read_vertices(element), has_vertices = true;
      } else if (element.name == "face") {
        if (!has_vertices) return false;
        done = read_faces(element), has_faces = true;
      } else {
        done = skip(element);
      }
      if (!done || !*done) return done;
    }
    return has_vertices && has_faces;
  }

 private:
  std::expected<bool, std::string> read_vertices(const PlyElement& element) {
    const auto rows = static_cast<std::size_t>(element.rows);
    if (has_lists(element) || rows >= TriangleHit::no_triangle) return false;
    const std::vector<Column> columns = columns_of(element, mesh_);
    if (columns.empty()) return false;
    for (const Column& column : columns)
      column.to->reserve((column.to == &mesh_.uvs ? 2 : 3) * rows);
    const std::size_t stride = least_bytes(element);
    for (std::int64_t row = 0; row < element.rows; ++row) {
      const unsigned char* record = bytes_.take(stride);
      if (record == nullptr) return std::unexpected(ends_early(element, row));
      for (const Column& column : columns)
        column.to->push_back(
            static_cast<float>(image::ply_number(record + column.offset, column.type, swap_)));
    }
    return true;
  }

  std::expected<bool, std::string> read_faces(const PlyElement& element) {
    if (std::count_if(element.properties.begin(), element.properties.end(), is_corner_list) != 1)
      return false;
    // Coordinates of corners instead of vertices: a matter for the library.
    for (const PlyProperty& property : element.properties)
      if (property.name == "texcoord") return false;
    mesh_.triangles.reserve(3 * static_cast<std::size_t>(element.rows));
    for (std::int64_t row = 0; row < element.rows; ++row)
      for (const PlyProperty& property : element.properties) {
        const auto list = take(property);
        if (!list) return std::unexpected(ends_early(element, row));
        if (!is_corner_list(property)) continue;
        if (list->count > 4) return false;
        add_face(*list, property.type);
        if (mesh_.triangle_count() > most_)
          return std::unexpected(too_many_triangles(mesh_.triangle_count(), most_));
      }
    return true;
  }

  std::expected<bool, std::string> skip(const PlyElement& element) {
    for (std::int64_t row = 0; row < element.rows; ++row)
      for (const PlyProperty& property : element.properties)
        if (!take(property)) return std::unexpected(ends_early(element, row));
    return true;
  }

  // The values of a property of the next record, one or a list.
  struct List {
    const unsigned char* first;
    std::size_t count;
  };
  std::optional<List> take(const PlyProperty& property) {
    double count = 1;
    if (property.count) {
      const unsigned char* stored = bytes_.take(static_cast<std::size_t>(property.count->bytes));
      if (stored == nullptr) return {};
      count = image::ply_number(stored, *property.count, swap_);
    }
    const auto bytes = static_cast<std::size_t>(property.type.bytes);
    if (!(count >= 0 && count * static_cast<double>(bytes) <= double{Bytes::most})) return {};
    const auto number = static_cast<std::size_t>(count);
    const unsigned char* first = bytes_.take(number * bytes);
    return first == nullptr ? std::nullopt : std::optional(List{first, number});
  }

  void add_face(const List& list, const PlyType& type) {
    if (list.count < 3) return;
    std::array<std::uint32_t, 4> corner{};
    for (std::size_t k = 0; k < list.count; ++k) {
      // Those below 0 name no vertex either.
      const double index =
          image::ply_number(list.first + k * static_cast<std::size_t>(type.bytes), type, swap_);
      corner[k] = index >= 0 ? static_cast<std::uint32_t>(index) : TriangleHit::no_triangle;
    }
    auto& to = mesh_.triangles;
    if (list.count == 3) {
      to.insert(to.end(), corner.begin(), corner.begin() + 3);
      return;
    }
    const std::size_t at = cut_of(mesh_, corner);
    const auto c = [&](std::size_t k) { return corner[(at + k) % 4]; };
    to.insert(to.end(), {c(0), c(1), c(2), c(0), c(2), c(3)});
  }

  const PlyHeader& header_;
  Bytes bytes_;
  bool swap_;
  std::size_t most_;
  Mesh& mesh_;
};

}  // namespace

std::expected<bool, std::string> read_binary_ply(const std::string& file,
                                                 std::size_t most_triangles, Mesh& mesh) {
  const auto source = image::open_bytes(file, 0);
  if (!source) return std::unexpected("the file cannot be opened");
  if (!image::is_ply(**source)) return false;
  const auto header = image::read_ply_header(**source);
  if (!header) return std::unexpected(header.error().message.substr(file.size() + 2));
  if (std::none_of(header->elements.begin(), header->elements.end(), [](const PlyElement& element) {
        return element.name != "vertex" && element.rows > 0;
      }))
    return std::unexpected("the mesh has no faces, only points; export it with faces");
  auto done = Reader(*header, **source, most_triangles, mesh).read();
  if (!done || !*done) mesh = {};
  return done;
}

}  // namespace pse::surface
