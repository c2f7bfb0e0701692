// Assimp in a child process. Its readers trust what files say of themselves: a few changed bytes of a
// PLY file make them run for minutes, stop the process, or write where they should not.
#include "surface/modules/read_mesh.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

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

// Never returns.
[[noreturn]] void run_child(int pipe, const std::string& file, rlim_t seconds) {
  side::settle(most_memory, seconds);
  Mesh mesh;
  const std::string error = read_here(file, mesh);
  const bool sent = side::put_all(pipe, error) && side::put_all(pipe, mesh.positions) &&
                    side::put_all(pipe, mesh.normals) && side::put_all(pipe, mesh.uvs) &&
                    side::put_all(pipe, mesh.triangles);
  ::_exit(sent ? 0 : 1);
}

}  // namespace

bool read_in_child(const std::string& file, Mesh& mesh, std::string& error) {
  std::error_code ignored;
  const auto megabytes = static_cast<rlim_t>(std::filesystem::file_size(file, ignored) >> 20);
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return error = "no process can be started to read it", false;
  const pid_t child = ::fork();
  if (child < 0) {
    ::close(ends[0]), ::close(ends[1]);
    return error = "no process can be started to read it", false;
  }
  if (child == 0) run_child(ends[1], file, 5 + megabytes);
  ::close(ends[1]);
  const bool whole = side::get_all(ends[0], error) && side::get_all(ends[0], mesh.positions) &&
                     side::get_all(ends[0], mesh.normals) && side::get_all(ends[0], mesh.uvs) &&
                     side::get_all(ends[0], mesh.triangles);
  ::close(ends[0]);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!whole)
    error = WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL)
                ? "reading it takes too long; the file is damaged, or too large for its form"
                : "the file is damaged: its reader broke down";
  return whole && error.empty();
}

}  // namespace pse::surface
