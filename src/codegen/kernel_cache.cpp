// One file per kernel: a line that says what it is, the hash of what follows, the objects. Written
// under a name of its own and renamed, so a reader sees a whole file or none. The time of last use
// is the file's time; the oldest go first.
#include "codegen/kernel_cache.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <sstream>
#include <system_error>
#include <vector>

namespace pse {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view mark = "pse kernel 2\n";
constexpr std::string_view extension = ".kernel";

std::string digest(std::string_view object) {
  Hasher hasher;
  hasher.add(object);
  return hasher.finish().text() + "\n";
}

}  // namespace

fs::path KernelCache::path_of(const Hash128& key) const {
  return folder_ / (key.text() + std::string(extension));
}

std::optional<std::string> KernelCache::find(const Hash128& key) const {
  if (folder_.empty()) return std::nullopt;
  const fs::path path = path_of(key);
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::nullopt;
  std::ostringstream text;
  text << file.rdbuf();
  std::string content = std::move(text).str();
  const std::size_t head = mark.size() + 33;
  if (content.size() < head || !content.starts_with(mark)) return std::nullopt;
  std::string object = content.substr(head);
  if (content.substr(mark.size(), 33) != digest(object)) return std::nullopt;
  std::error_code ignored;
  fs::last_write_time(path, fs::file_time_type::clock::now(), ignored);
  return object;
}

void KernelCache::keep(const Hash128& key, const std::string& object) const {
  if (folder_.empty()) return;
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) return;
  static std::atomic<unsigned> counter{0};
  fs::path temporary = path_of(key);
  temporary += ".tmp" + std::to_string(getpid()) + "." + std::to_string(counter++);
  {
    std::ofstream file(temporary, std::ios::binary);
    file << mark << digest(object) << object;
    file.flush();
    if (!file) {
      file.close();
      fs::remove(temporary, error);
      return;
    }
  }
  fs::rename(temporary, path_of(key), error);
  if (error) fs::remove(temporary, error);
  make_room();
}

void KernelCache::make_room() const {
  struct Entry {
    fs::file_time_type used;
    std::uintmax_t size;
    fs::path path;
  };
  std::vector<Entry> entries;
  std::uintmax_t total = 0;
  std::error_code error;
  for (fs::directory_iterator it(folder_, error), end; !error && it != end; it.increment(error)) {
    std::error_code gone;  // another process may be making room as well
    const std::string name = it->path().filename().string();
    if (name.find(extension) == std::string::npos) continue;
    const Entry entry{it->last_write_time(gone), it->file_size(gone), it->path()};
    if (gone) continue;
    // What a killed process left behind.
    const bool unfinished = it->path().extension() != extension;
    if (unfinished && fs::file_time_type::clock::now() - entry.used < std::chrono::hours(1))
      continue;
    total += entry.size;
    entries.push_back(entry);
  }
  std::ranges::sort(entries, {}, &Entry::used);
  for (const Entry& entry : entries) {
    if (total <= limit_) return;
    fs::remove(entry.path, error);
    total -= entry.size;
  }
}

}  // namespace pse
