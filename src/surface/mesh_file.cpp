// Counting faces by their marks in the file.
#include "surface/mesh_file.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <vector>

namespace pse::surface {
namespace {

namespace fs = std::filesystem;
constexpr std::uintmax_t most_bytes = std::uintmax_t{1} << 30;

// Lines of an OBJ file that are faces; each makes a triangle or more.
std::size_t faces_of_obj(std::ifstream& stream) {
  std::vector<char> block(1 << 20);
  std::size_t faces = 0;
  bool line_start = true, face = false;
  while (stream.read(block.data(), static_cast<std::streamsize>(block.size())), stream.gcount() > 0)
    for (std::streamsize i = 0; i < stream.gcount(); ++i) {
      const char c = block[static_cast<std::size_t>(i)];
      if (face && (c == ' ' || c == '\t')) ++faces;
      face = line_start && c == 'f';
      line_start = c == '\n';
    }
  return faces;
}

// The number after "element face" in a PLY file's head.
std::size_t faces_of_ply(std::ifstream& stream) {
  std::string line;
  for (int lines = 0; lines < 1000 && std::getline(stream, line); ++lines) {
    constexpr std::string_view mark = "element face ";
    if (line.starts_with("end_header")) break;
    if (!line.starts_with(mark)) continue;
    std::size_t count = 0;
    std::from_chars(line.data() + mark.size(), line.data() + line.size(), count);
    return count;
  }
  return 0;
}

std::string ending_of(const std::string& file) {
  std::string ending = fs::path(file).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

}  // namespace

std::string too_many_triangles(std::size_t count, std::size_t most) {
  return "the mesh has " + std::to_string(count) + " faces and at most " + std::to_string(most) +
         " are taken; make a coarser copy of it first";
}

MeshKind mesh_kind(const std::string& file) {
  const std::string ending = ending_of(file);
  if (ending == ".ply") return MeshKind::ply;
  if (ending == ".obj") return MeshKind::obj;
  return ending == ".gltf" || ending == ".glb" ? MeshKind::gltf : MeshKind::none;
}

std::string look_at_mesh_file(const std::string& file) {
  std::error_code error;
  if (!fs::exists(file, error)) return "there is no such file";
  if (!fs::is_regular_file(file, error)) return "this is not a file";
  if (mesh_kind(file) == MeshKind::none) return "meshes are .obj, .ply, .gltf or .glb files";
  if (fs::file_size(file, error) == 0 || error) return "the file is empty";
  if (!std::ifstream(file, std::ios::binary)) return "the file cannot be opened";
  return "";
}

std::string too_much_for_library(const std::string& file, std::size_t most_triangles) {
  constexpr const char* instead = ", or save it as binary PLY with faces of three or four corners";
  std::error_code error;
  if (fs::file_size(file, error) > most_bytes)
    return std::string("the file is larger than 1 GiB; make a coarser copy of it first") + instead;
  std::ifstream stream(file, std::ios::binary);
  const MeshKind kind = mesh_kind(file);
  const std::size_t faces = kind == MeshKind::obj   ? faces_of_obj(stream)
                            : kind == MeshKind::ply ? faces_of_ply(stream)
                                                    : 0;
  return faces > most_triangles ? too_many_triangles(faces, most_triangles) + instead : "";
}

}  // namespace pse::surface
