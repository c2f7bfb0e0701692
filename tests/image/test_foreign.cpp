// Formats behind OpenImageIO. Skipped, saying so, where the module was not built.
#include <sys/resource.h>
#include <sys/wait.h>

#include <cmath>
#include <csignal>

#include "files.h"
#include "image/foreign.h"
#include "image/module_loader.h"

namespace pse::image {
namespace {

using namespace test;

#define PSE_NEEDS_MODULE() \
  if (!load_module("pse_oiio", foreign_images_entry)) GTEST_SKIP() << "without OpenImageIO"

const std::vector<Channel> rgba = {{"R", PixelType::float16},
                                   {"G", PixelType::float16},
                                   {"B", PixelType::float16},
                                   {"A", PixelType::float16}};

// Smooth colours between 0 and 1 under half alpha.
Image smooth(int channels) {
  Image image = numbered({0, 0, 32, 20}, {0, 0, 32, 20},
                         std::vector<Channel>(rgba.begin(), rgba.begin() + channels));
  for (auto& plane : image.planes)
    for (auto& value : plane) value = 0.05f + value / 10;
  if (channels == 4) std::fill(image.planes[3].begin(), image.planes[3].end(), 0.5f);
  return image;
}

TEST(Foreign, WhatIsWrittenIsRead) {
  PSE_NEEDS_MODULE();
  const std::vector<std::tuple<const char*, int, double>> table = {
      {"a.tif", 4, 0.01}, {"a.jpg", 3, 0.03}, {"a.tga", 4, 0.01}, {"a.bmp", 3, 0.01},
      {"a.ppm", 3, 0.01}, {"a.hdr", 3, 0.01}, {"a.webp", 3, 0.05}};
  for (const auto& [name, channels, tolerance] : table) {
    Folder folder;
    const Image image = smooth(channels);
    const auto written = write_image(folder / name, image);
    ASSERT_TRUE(written) << name << ": " << message_of(written);
    EXPECT_EQ(folder.entries(), 1);
    const auto read = read_image(folder / name);
    ASSERT_TRUE(read) << name << ": " << message_of(read);
    ASSERT_EQ(read->spec.data, image.spec.data) << name;
    for (int c = 0; c < channels; ++c) {
      const std::string& channel = image.spec.channels[static_cast<std::size_t>(c)].name;
      ASSERT_GE(read->spec.find(channel), 0) << name << " " << channel;
      for (int y = 0; y < 20; ++y)
        for (int x = 0; x < 32; ++x)
          ASSERT_NEAR(read->at(read->spec.find(channel), x, y), image.at(c, x, y), tolerance)
              << name << " " << channel << x << "," << y;
    }
  }
}

TEST(Foreign, FromMemory) {
  PSE_NEEDS_MODULE();
  Folder folder;
  for (const char* name : {"a.tif", "a.jpg", "a.hdr"}) {
    ASSERT_TRUE(write_image(folder / name, smooth(3)));
    auto reader = open_reader(bytes_from_memory("standard input", content_of(folder / name)));
    ASSERT_TRUE(reader) << message_of(reader);
    EXPECT_EQ((*reader)->spec().data.width(), 32);
    const auto image = read_image(**reader, {});
    ASSERT_TRUE(image);
    EXPECT_NEAR(image->at(1, 5, 6), smooth(3).at(1, 5, 6), 0.03);
  }
}

TEST(Foreign, DamageIsSaid) {
  PSE_NEEDS_MODULE();
  Folder folder;
  for (const char* name : {"a.tif", "a.hdr", "a.jpg"}) {
    ASSERT_TRUE(write_image(folder / name, smooth(3)));
    const Content content = content_of(folder / name);
    for (const std::size_t keep : {std::size_t{3}, std::size_t{20}, content.size() / 3}) {
      put_content(folder / name,
                  Content(content.begin(), content.begin() + static_cast<std::ptrdiff_t>(keep)));
      const auto read = read_image(folder / name);
      // JPEG decoders show what there is.
      EXPECT_TRUE(!read || std::string(name) == "a.jpg") << name << " cut to " << keep;
    }
  }
}

// An SGI file of 4 x 1 pixels whose run of pixels is longer than its row: OpenImageIO's reader ends
// the process it is in.
TEST(Foreign, AReaderThatBreaksDownIsSaid) {
  PSE_NEEDS_MODULE();
  Folder folder;
  const auto sgi = [](const Content& runs) {
    Content file = {0x01, 0xda, 1, 1, 0, 2, 0, 4, 0, 1, 0, 1, 0, 0, 0, 0, 0, 0, 0, 255};
    file.resize(512);
    const auto size = static_cast<unsigned char>(runs.size());
    for (const Content& table : {Content{0, 0, 2, 8}, Content{0, 0, 0, size}})
      file.insert(file.end(), table.begin(), table.end());
    file.insert(file.end(), runs.begin(), runs.end());
    return file;
  };
  put_content(folder / "good.sgi", sgi({0x84, 0, 85, 170, 255, 0}));
  ReadOptions stored;
  stored.working.reset();
  const auto good = read_image(folder / "good.sgi", stored);
  ASSERT_TRUE(good) << message_of(good);
  EXPECT_EQ(good->planes[0], (std::vector<float>{0, 85 / 255.0f, 170 / 255.0f, 1}));
  put_content(folder / "bad.sgi", sgi({0x7f, 9, 0x7f, 9, 0}));
  for (int i = 0; i < 2; ++i) {
    const auto bad = read_image(folder / "bad.sgi", stored);
    ASSERT_FALSE(bad);
    EXPECT_EQ(bad.error().kind, ErrorKind::damaged);
    EXPECT_NE(bad.error().message.find("broke down"), std::string::npos) << bad.error().message;
  }
  // The next file is read as ever.
  EXPECT_TRUE(read_image(folder / "good.sgi", stored));
}

TEST(Foreign, AFullDiskLeavesTheOldFile) {
  PSE_NEEDS_MODULE();
  for (const char* name : {"a.jpg", "a.tif", "a.hdr", "a.tga", "a.ppm", "a.bmp"}) {
    Folder folder;
    put_content(folder / name, {1, 2, 3});
    const pid_t child = ::fork();
    if (child == 0) {
      std::signal(SIGXFSZ, SIG_IGN);
      const rlimit most{400, 400};
      ::setrlimit(RLIMIT_FSIZE, &most);
      const Image image = smooth(3);
      ::_exit(write_image(folder / name, image) ? 1 : 0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << name << " " << status;
    EXPECT_EQ(content_of(folder / name), (Content{1, 2, 3})) << name;
    EXPECT_EQ(folder.entries(), 1);
  }
}

}  // namespace
}  // namespace pse::image
