// What the tests of images share: a folder that vanishes, the real files, small images with known
// numbers.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "image/reader.h"
#include "image/writer.h"

namespace pse::image::test {

// A folder for one test; removed with everything in it.
class Folder {
 public:
  Folder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "pse-image-XXXXXX").string();
    path_ = ::mkdtemp(pattern.data());
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  // Number of entries, hidden ones included.
  int entries() const {
    return static_cast<int>(std::distance(std::filesystem::directory_iterator(path_), {}));
  }

 private:
  std::filesystem::path path_;
};

using Content = std::vector<unsigned char>;

inline Content content_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return Content(std::istreambuf_iterator<char>(file), {});
}

inline void put_content(const std::string& path, const Content& content) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(content.data()),
             static_cast<std::streamsize>(content.size()));
}

// A file of the folder of real input, or "" when it is not there.
inline std::string real_file(const std::string& name) {
  for (const char* folder : {"../shared/data/", "../../shared/data/"}) {
    const std::string path = std::string(PSE_SOURCE_DIR "/") + folder + name;
    if (std::filesystem::exists(path)) return path;
  }
  return {};
}

#define PSE_REAL_FILE(variable, name)                             \
  const std::string variable = pse::image::test::real_file(name); \
  if (variable.empty()) GTEST_SKIP() << name << " is not in ../shared/data"

// An image whose every number tells where it is: channel + x / 64 + y / 4096, exact in half for
// small x and y.
inline Image numbered(Window display, Window data, std::vector<Channel> channels) {
  ImageSpec spec;
  spec.display = display;
  spec.data = data;
  spec.channels = std::move(channels);
  Image image(spec);
  for (std::size_t c = 0; c < image.planes.size(); ++c)
    for (int y = data.y0; y < data.y1; ++y)
      for (int x = data.x0; x < data.x1; ++x)
        image.pixel(static_cast<int>(c), x, y) = static_cast<float>(c) +
                                                 static_cast<float>(x - data.x0) / 16.0f +
                                                 static_cast<float>(y - data.y0) / 256.0f;
  return image;
}

template <class T>
std::string message_of(const Result<T>& result) {
  return result ? "no error" : result.error().message;
}

}  // namespace pse::image::test
