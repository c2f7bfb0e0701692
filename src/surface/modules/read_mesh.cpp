// Assimp in a child process. Its readers trust what files say of themselves: a few changed bytes of a
// PLY file make them run for minutes, stop the process, or write where they should not.
#include "surface/modules/read_mesh.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <assimp/Importer.hpp>
#include <filesystem>

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

bool put(int pipe, const void* data, std::size_t bytes) {
  const char* at = static_cast<const char*>(data);
  while (bytes > 0) {
    const ssize_t done = ::write(pipe, at, bytes);
    if (done <= 0) return false;
    at += done, bytes -= static_cast<std::size_t>(done);
  }
  return true;
}

bool get(int pipe, void* data, std::size_t bytes) {
  char* at = static_cast<char*>(data);
  while (bytes > 0) {
    const ssize_t done = ::read(pipe, at, bytes);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return false;
    at += done, bytes -= static_cast<std::size_t>(done);
  }
  return true;
}

template <class Values>
bool put_all(int pipe, const Values& values) {
  const std::uint64_t count = values.size();
  return put(pipe, &count, sizeof count) &&
         put(pipe, values.data(), count * sizeof(typename Values::value_type));
}

template <class Values>
bool get_all(int pipe, Values& values) {
  constexpr std::uint64_t most = std::uint64_t{1} << 30;
  std::uint64_t count = 0;
  if (!get(pipe, &count, sizeof count) || count > most) return false;
  values.resize(count);
  return get(pipe, values.data(), count * sizeof(typename Values::value_type));
}

void limit(__rlimit_resource which, rlim_t most) {
  const rlimit value{most, most};
  ::setrlimit(which, &value);
}

// Never returns.
[[noreturn]] void run_child(int pipe, const std::string& file, rlim_t seconds) {
  limit(RLIMIT_AS, most_memory), limit(RLIMIT_CORE, 0), limit(RLIMIT_CPU, seconds);
  for (const int signal : {SIGINT, SIGTERM, SIGABRT, SIGSEGV, SIGXCPU, SIGBUS, SIGFPE})
    ::signal(signal, SIG_DFL);
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  const int nowhere = ::open("/dev/null", O_WRONLY);
  ::dup2(nowhere, STDERR_FILENO), ::dup2(nowhere, STDOUT_FILENO);
  Mesh mesh;
  const std::string error = read_here(file, mesh);
  const bool sent = put_all(pipe, error) && put_all(pipe, mesh.positions) &&
                    put_all(pipe, mesh.normals) && put_all(pipe, mesh.uvs) &&
                    put_all(pipe, mesh.triangles);
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
  const bool whole = get_all(ends[0], error) && get_all(ends[0], mesh.positions) &&
                     get_all(ends[0], mesh.normals) && get_all(ends[0], mesh.uvs) &&
                     get_all(ends[0], mesh.triangles);
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
