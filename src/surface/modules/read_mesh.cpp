// Assimp in a child process. Its readers trust what files say of themselves: a few changed bytes of
// a PLY file make them run for minutes, stop the process, or write where they should not.
#include "surface/modules/read_mesh.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <filesystem>

#include "base/side_process.h"

namespace pse::surface {
namespace {

constexpr rlim_t most_memory = rlim_t{8} << 30;  // of addresses; what is mapped already counts

// All triangles of a mesh of the file, in the file's world.
void append(const aiMesh& from, bool normals, bool uvs, Mesh& to) {
  const auto base = static_cast<std::uint32_t>(to.vertex_count());
  for (unsigned v = 0; v < from.mNumVertices; ++v) {
    const aiVector3D& p = from.mVertices[v];
    to.positions.insert(to.positions.end(), {p.x, p.y, p.z});
    if (normals) {
      const aiVector3D& n = from.mNormals[v];
      to.normals.insert(to.normals.end(), {n.x, n.y, n.z});
    }
    if (uvs) {
      const aiVector3D& t = from.mTextureCoords[0][v];
      to.uvs.insert(to.uvs.end(), {t.x, t.y});
    }
  }
  for (unsigned f = 0; f < from.mNumFaces; ++f) {
    const aiFace& face = from.mFaces[f];
    if (face.mNumIndices != 3) continue;
    for (unsigned k = 0; k < 3; ++k) to.triangles.push_back(base + face.mIndices[k]);
  }
}

// The error, or nothing.
std::string read_here(const std::string& file, Mesh& mesh) {
  try {
    Assimp::Importer importer;
    const aiScene* scene =
        importer.ReadFile(file, aiProcess_Triangulate | aiProcess_PreTransformVertices |
                                    aiProcess_JoinIdenticalVertices | aiProcess_SortByPType);
    if (scene == nullptr)
      return std::string("this is not a mesh that can be read: ") + importer.GetErrorString();
    bool normals = true, uvs = true;
    const auto has_triangles = [&](unsigned i) {
      return (scene->mMeshes[i]->mPrimitiveTypes & aiPrimitiveType_TRIANGLE) != 0;
    };
    for (unsigned i = 0; i < scene->mNumMeshes; ++i) {
      if (!has_triangles(i)) continue;
      normals = normals && scene->mMeshes[i]->HasNormals();
      uvs = uvs && scene->mMeshes[i]->HasTextureCoords(0);
    }
    for (unsigned i = 0; i < scene->mNumMeshes; ++i)
      if (has_triangles(i) || scene->mNumMeshes == 1)
        append(*scene->mMeshes[i], normals && has_triangles(i), uvs && has_triangles(i), mesh);
    return "";
  } catch (const std::bad_alloc&) {
    return "there is not enough memory to read it";
  } catch (const std::exception& problem) {
    return std::string("this is not a mesh that can be read: ") + problem.what();
  }
}

}  // namespace

bool read_in_child(const std::string& file, Mesh& mesh, std::string& error) {
  std::error_code ignored;
  const auto megabytes = static_cast<rlim_t>(std::filesystem::file_size(file, ignored) >> 20);
  const auto read = [&](int pipe) {
    error = read_here(file, mesh);
    return side::put_all(pipe, error) && side::put_all(pipe, mesh.positions) &&
           side::put_all(pipe, mesh.normals) && side::put_all(pipe, mesh.uvs) &&
           side::put_all(pipe, mesh.triangles);
  };
  const auto take = [&](int pipe) {
    return side::get_all(pipe, error) && side::get_all(pipe, mesh.positions) &&
           side::get_all(pipe, mesh.normals) && side::get_all(pipe, mesh.uvs) &&
           side::get_all(pipe, mesh.triangles);
  };
  switch (side::run(most_memory, 5 + megabytes, read, take)) {
    case side::Ended::whole:
      break;
    case side::Ended::not_started:
      error = "no process can be started to read it";
      break;
    case side::Ended::took_too_long:
      error = "reading it takes too long; the file is damaged, or too large for its form";
      break;
    case side::Ended::broke_down:
      error = "the file is damaged: its reader broke down";
      break;
  }
  return error.empty();
}

}  // namespace pse::surface
