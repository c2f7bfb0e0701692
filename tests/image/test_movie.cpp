// Films, checked with ffprobe and by decoding them again. Skipped, saying so, where ffmpeg is
// missing.
#include "image/movie.h"

#include <cmath>
#include <cstdio>

#include "files.h"

namespace pse::image {
namespace {

using namespace test;

// What a command prints.
Content output_of(const std::string& command) {
  Content content;
  FILE* pipe = ::popen(command.c_str(), "r");
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe))
    content.push_back(static_cast<unsigned char>(c));
  ::pclose(pipe);
  return content;
}

bool has_ffmpeg() { return !output_of("command -v ffmpeg").empty(); }

// A frame of one colour.
Image plain(int width, int height, float red, float green, float blue) {
  Image image =
      numbered({0, 0, width, height}, {0, 0, width, height},
               {{"R", PixelType::float16}, {"G", PixelType::float16}, {"B", PixelType::float16}});
  const float colour[3] = {red, green, blue};
  for (std::size_t c = 0; c < 3; ++c)
    std::fill(image.planes[c].begin(), image.planes[c].end(), colour[c]);
  return image;
}

Result<void> add(MovieWriter& movie, const Image& image) {
  auto frame = movie.next_frame(image.spec);
  if (!frame) return std::unexpected(frame.error());
  std::vector<const float*> planes;
  for (const auto& plane : image.planes) planes.push_back(plane.data());
  if (auto done = (*frame)->write_rows(image.spec.data.height(), planes); !done) return done;
  return (*frame)->close();
}

TEST(Movie, TagsSizeAndColours) {
  if (!has_ffmpeg()) GTEST_SKIP() << "without ffmpeg";
  Folder folder;
  const std::string path = folder / "a.mp4";
  const std::vector<std::vector<float>> colours = {{1, 0, 0}, {0, 1, 0}, {0.2f, 0.2f, 0.2f}};
  const Image first = plain(33, 17, 1, 0, 0);
  auto movie = open_movie(path, first.spec, {});
  ASSERT_TRUE(movie) << message_of(movie);
  for (const auto& c : colours) {
    const auto done = add(**movie, plain(33, 17, c[0], c[1], c[2]));
    ASSERT_TRUE(done) << message_of(done);
  }
  EXPECT_FALSE(std::filesystem::exists(path));
  const auto closed = (*movie)->close();
  ASSERT_TRUE(closed) << message_of(closed);
  EXPECT_EQ(folder.entries(), 1);

  const Content told = output_of(
      "ffprobe -v error -count_frames -select_streams v -show_entries "
      "stream=codec_name,width,height,pix_fmt,color_range,color_space,color_transfer,color_"
      "primaries,nb_read_frames,"
      "r_frame_rate -of default=nw=1:nk=0 " +
      path);
  const std::string text(told.begin(), told.end());
  for (const char* line : {"codec_name=h264", "width=34", "height=18", "pix_fmt=yuv420p",
                           "color_range=tv", "color_space=bt709", "color_transfer=bt709",
                           "color_primaries=bt709", "r_frame_rate=24/1", "nb_read_frames=3"})
    EXPECT_NE(text.find(line), std::string::npos) << line << " in\n" << text;

  // The index stands before the pictures.
  const Content file = content_of(path);
  const std::string all(file.begin(), file.end());
  EXPECT_LT(all.find("moov"), all.find("mdat"));

  // Decoded again the colours are the same, in the added column too.
  const Content pixels = output_of("ffmpeg -v error -i " + path +
                                   " -f rawvideo -pix_fmt rgb24 -sws_flags accurate_rnd -");
  ASSERT_EQ(pixels.size(), 3u * 34 * 18 * 3);
  for (std::size_t frame = 0; frame < 3; ++frame)
    for (std::size_t c = 0; c < 3; ++c)
      for (const std::size_t at :
           {std::size_t{0}, std::size_t{34 * 9 + 16}, std::size_t{34 * 18 - 1}})
        EXPECT_NEAR(pixels[(frame * 34 * 18 + at) * 3 + c],
                    std::round(srgb_encode(colours[frame][c]) * 255), 6)
            << frame << " " << c << " " << at;
}

TEST(Movie, WhatGoesWrongIsSaid) {
  Folder folder;
  put_content(folder / "a.mp4", {1, 2, 3});
  const Image frame = plain(16, 16, 1, 0, 0);
  MovieOptions options;
  options.program = "no-such-program-anywhere";
  const auto missing = open_movie(folder / "a.mp4", frame.spec, options);
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().message.find("no-such-program-anywhere is not installed"),
            std::string::npos);

  // A program that ends at once without reading.
  options.program = "false";
  auto movie = open_movie(folder / "a.mp4", frame.spec, options);
  ASSERT_TRUE(movie) << message_of(movie);
  bool good = true;
  for (int i = 0; i < 2000 && good; ++i) good = add(**movie, frame).has_value();
  EXPECT_FALSE(good);
  EXPECT_FALSE((*movie)->close());
  EXPECT_EQ(content_of(folder / "a.mp4"), (Content{1, 2, 3}));

  options = {};
  options.frames_per_second = 0;
  EXPECT_FALSE(open_movie(folder / "a.mp4", frame.spec, options));
  EXPECT_FALSE(open_movie(folder / "none/a.mp4", frame.spec, {}));
  EXPECT_EQ(folder.entries(), 1);
}

TEST(Movie, GivenUpHalfway) {
  if (!has_ffmpeg()) GTEST_SKIP() << "without ffmpeg";
  Folder folder;
  put_content(folder / "a.mp4", {1, 2, 3});
  const Image frame = plain(16, 16, 1, 0, 0);
  {
    auto movie = open_movie(folder / "a.mp4", frame.spec, {});
    ASSERT_TRUE(movie && add(**movie, frame));
    EXPECT_FALSE(add(**movie, plain(16, 18, 1, 0, 0)));
  }
  EXPECT_EQ(content_of(folder / "a.mp4"), (Content{1, 2, 3}));
  EXPECT_EQ(folder.entries(), 1);
}

}  // namespace
}  // namespace pse::image
