// Walking the skeleton: magic number and versions; the file's metadata; for each grid its name,
// type, three offsets, and its own metadata behind the first of them.
#include "volume/modules/structure.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace pse::volume {
namespace {

constexpr std::uint32_t oldest = 222;  // file version from which the layout is the one walked here
constexpr std::uint32_t most_entries = 10000;
constexpr std::uint32_t longest_name = 4096;

// Thrown where the skeleton contradicts itself; does not leave this file.
struct Broken {
  const char* what;
};

class Walk {
 public:
  Walk(const std::string& file, std::uint64_t size) : in_(file, std::ios::binary), size_(size) {}

  void go() {
    std::array<unsigned char, 8> magic{};
    take(magic.data(), 8);
    const std::array<unsigned char, 8> expected = {0x20, 0x42, 0x44, 0x56, 0, 0, 0, 0};
    if (magic != expected) throw Broken{nullptr};
    const auto version = number<std::uint32_t>();
    if (version < oldest) return;
    skip(8);  // the library's version
    const auto has_offsets = number<char>();
    skip(36);
    walk_metadata();
    const auto grids = number<std::int32_t>();
    if (grids < 0 || grids > static_cast<std::int32_t>(most_entries))
      throw Broken{"an impossible number of grids"};
    for (std::int32_t i = 0; i < grids && has_offsets != 0; ++i) walk_grid();
  }

 private:
  void take(void* to, std::size_t count) {
    if (at_ + count > size_) throw Broken{"the file ends too early"};
    in_.read(static_cast<char*>(to), static_cast<std::streamsize>(count));
    if (!in_) throw Broken{"it cannot be read to its end"};
    at_ += count;
  }
  template <class T>
  T number() {
    T value{};
    take(&value, sizeof value);
    return value;
  }
  void seek(std::uint64_t to) {
    if (to > size_) throw Broken{"the file ends too early"};
    in_.seekg(static_cast<std::streamoff>(to));
    at_ = to;
  }
  void skip(std::uint64_t count) { seek(at_ + count); }
  void skip_name() {
    const auto length = number<std::uint32_t>();
    if (length > longest_name) throw Broken{"a name of impossible length"};
    skip(length);
  }
  void walk_metadata() {
    const auto count = number<std::uint32_t>();
    if (count > most_entries) throw Broken{"an impossible number of attributes"};
    for (std::uint32_t i = 0; i < count; ++i) {
      skip_name();
      skip_name();
      skip(number<std::uint32_t>());
    }
  }
  void walk_grid() {
    skip_name();
    skip_name();
    skip_name();  // of the grid whose voxels it shares
    const auto grid = number<std::uint64_t>(), block = number<std::uint64_t>(),
               end = number<std::uint64_t>();
    if (grid < at_ || block < grid || end < block) throw Broken{"grids in impossible places"};
    if (end > size_) throw Broken{"the file ends too early"};
    seek(grid);
    number<std::uint32_t>();  // compression
    walk_metadata();
    if (at_ > end) throw Broken{"a grid's attributes are longer than the grid"};
    seek(end);
  }

  std::ifstream in_;
  std::uint64_t size_ = 0, at_ = 0;
};

}  // namespace

Result<void> check_structure(const std::string& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error))
    return fail(ErrorKind::not_found, "there is no file " + file);
  if (!std::filesystem::is_regular_file(file, error))
    return fail(ErrorKind::cannot_read,
                "cannot read " + file + ": it is " +
                    (std::filesystem::is_directory(file, error) ? "a folder" : "no file"));
  const auto size = std::filesystem::file_size(file, error);
  if (error || ::access(file.c_str(), R_OK) != 0)
    return fail(ErrorKind::cannot_read, "cannot read " + file + ": " + std::strerror(errno));
  if (size == 0) return fail(ErrorKind::damaged, file + " is empty: write it anew");
  try {
    Walk(file, size).go();
    return {};
  } catch (const Broken& broken) {
    if (broken.what == nullptr) return fail(ErrorKind::not_an_image, file + " is not a VDB file");
    return fail(ErrorKind::damaged, file + " is damaged or cut off: " + broken.what);
  }
}

}  // namespace pse::volume
