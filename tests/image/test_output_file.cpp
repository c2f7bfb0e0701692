// Whatever goes wrong while writing, the old file stays and nothing else is left.
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <csignal>

#include "files.h"
#include "image/output_file.h"

namespace pse::image {
namespace {

using namespace test;

// Large enough that no buffer hides a full disk.
Image large() {
  Image image =
      numbered({0, 0, 600, 600}, {0, 0, 600, 600},
               {{"B", PixelType::float32}, {"G", PixelType::float32}, {"R", PixelType::float32}});
  std::uint32_t state = 1;
  for (auto& plane : image.planes)
    for (auto& value : plane)
      value = static_cast<float>(state = state * 1664525u + 1013904223u) / 4294967296.0f;
  return image;
}

TEST(OutputFile, AppearsAtCommitAndNotBefore) {
  Folder folder;
  put_content(folder / "a", {1, 2, 3});
  {
    auto file = OutputFile::create(folder / "a");
    ASSERT_TRUE(file);
    EXPECT_TRUE(file->write("new", 3));
    EXPECT_EQ(content_of(folder / "a"), (Content{1, 2, 3}));
  }
  EXPECT_EQ(content_of(folder / "a"), (Content{1, 2, 3}));
  auto file = OutputFile::create(folder / "a");
  ASSERT_TRUE(file);
  EXPECT_TRUE(file->write("naw", 3) && file->seek(1) && file->write("e", 1));
  const auto done = file->commit();
  ASSERT_TRUE(done) << message_of(done);
  EXPECT_EQ(content_of(folder / "a"), (Content{'n', 'e', 'w'}));
  EXPECT_EQ(folder.entries(), 1);
}

TEST(OutputFile, PermissionsAndLinksAreKept) {
  Folder folder;
  put_content(folder / "a", {1});
  ::chmod((folder / "a").c_str(), 0640);
  std::filesystem::create_symlink("a", folder / "link");
  auto file = OutputFile::create(folder / "link");
  ASSERT_TRUE(file && file->write("x", 1) && file->commit());
  struct stat about {};
  ::lstat((folder / "link").c_str(), &about);
  EXPECT_TRUE(S_ISLNK(about.st_mode));
  ::stat((folder / "a").c_str(), &about);
  EXPECT_EQ(about.st_mode & 0777, 0640u);
  EXPECT_EQ(content_of(folder / "a"), (Content{'x'}));
}

TEST(OutputFile, PlacesThatCannotBeWritten) {
  Folder folder;
  for (const std::string& path : {folder / "none/a.exr", folder / "", std::string(),
                                  folder / std::string("a\0b", 3), std::string("/proc/a.exr")}) {
    const auto file = OutputFile::create(path);
    ASSERT_FALSE(file) << path;
    EXPECT_EQ(file.error().kind, ErrorKind::cannot_write);
    EXPECT_TRUE(file.error().is_output());
  }
}

TEST(OutputFile, AFullDeviceIsSaid) {
  const Image image = large();
  for (const char* format : {"exr", "png"}) {
    WriteOptions options;
    options.format = format;
    const auto written = write_image("/dev/full", image, options);
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().kind, ErrorKind::disk_full) << message_of(written);
  }
  WriteOptions options;
  options.format = "exr";
  EXPECT_TRUE(write_image("/dev/null", image, options));
}

// A child with a limit on the size of files, 0 when all is as it should be.
int write_under_limit(const std::string& path, rlim_t limit) {
  const pid_t child = ::fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit most{limit, limit};
    ::setrlimit(RLIMIT_FSIZE, &most);
    const auto written = write_image(path, large());
    ::_exit(written ? 1 : written.error().kind == ErrorKind::disk_full ? 0 : 2);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 3;
}

TEST(OutputFile, AFullDiskLeavesTheOldFile) {
  for (const char* name : {"a.exr", "a.png"})
    for (const rlim_t limit : {0, 1, 4096, 262144, 300000, 900000}) {
      Folder folder;
      put_content(folder / name, {1, 2, 3});
      EXPECT_EQ(write_under_limit(folder / name, limit), 0) << name << " " << limit;
      EXPECT_EQ(content_of(folder / name), (Content{1, 2, 3}));
      EXPECT_EQ(folder.entries(), 1) << name << " " << limit;
    }
}

TEST(OutputFile, AKilledWriterLeavesTheOldFile) {
  Folder folder;
  put_content(folder / "a.exr", {1, 2, 3});
  const pid_t child = ::fork();
  if (child == 0) {
    const Image image = large();
    auto writer = open_writer(folder / "a.exr", image.spec);
    std::vector<const float*> planes;
    for (const auto& plane : image.planes) planes.push_back(plane.data());
    if (writer && (*writer)->write_rows(500, planes)) ::raise(SIGKILL);
    ::_exit(1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(content_of(folder / "a.exr"), (Content{1, 2, 3}));
  EXPECT_EQ(folder.entries(), 1);
}

TEST(OutputFile, AWriterThatIsGivenUpLeavesTheOldFile) {
  Folder folder;
  const Image image = large();
  std::vector<const float*> planes;
  for (const auto& plane : image.planes) planes.push_back(plane.data());
  for (const char* name : {"a.exr", "a.png"}) {
    put_content(folder / name, {7});
    auto writer = open_writer(folder / name, image.spec);
    ASSERT_TRUE(writer);
    ASSERT_TRUE((*writer)->write_rows(100, planes));
    const auto closed = (*writer)->close();
    ASSERT_FALSE(closed);
    EXPECT_EQ(closed.error().kind, ErrorKind::bad_request);
    writer->reset();
    EXPECT_EQ(content_of(folder / name), (Content{7}));
  }
  EXPECT_EQ(folder.entries(), 2);
}

// Standard output is a pipe here: seeking backwards in the file must not matter.
TEST(OutputFile, StandardOutput) {
  Folder folder;
  const Image image = large();
  const std::string copy = folder / "copy.exr";
  const pid_t child = ::fork();
  if (child == 0) {
    int ends[2] = {};
    if (::pipe(ends) != 0) ::_exit(1);
    if (::fork() == 0) {
      ::close(ends[1]);
      ::dup2(ends[0], 0);
      const auto read = read_image("-");
      ::_exit(read && write_image(copy, *read) ? 0 : 1);
    }
    ::close(ends[0]);
    ::dup2(ends[1], 1);
    ::close(ends[1]);
    const bool good = write_image("-", image).has_value();
    ::close(1);
    int status = 0;
    ::wait(&status);
    ::_exit(good && WIFEXITED(status) ? WEXITSTATUS(status) : 2);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  const auto read = read_image(copy);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->planes[0], image.planes[0]);
}

TEST(Writer, RequestsThatMakeNoSense) {
  Folder folder;
  Image image =
      numbered({0, 0, 4, 4}, {0, 0, 4, 4}, {{"R", PixelType::float16}, {"R", PixelType::float16}});
  EXPECT_EQ(write_image(folder / "a.exr", image).error().kind, ErrorKind::bad_request);
  image.spec.channels[1].name = "";
  EXPECT_EQ(write_image(folder / "a.exr", image).error().kind, ErrorKind::bad_request);
  image.spec.channels[1].name = std::string(300, 'x');
  EXPECT_EQ(write_image(folder / "a.exr", image).error().kind, ErrorKind::bad_request);
  image.spec.channels[1].name = "G";
  EXPECT_EQ(write_image(folder / "a", image).error().kind, ErrorKind::unsupported);
  image.spec.display = {};
  EXPECT_EQ(write_image(folder / "a.exr", image).error().kind, ErrorKind::bad_request);
  image.spec.display = image.spec.data = {0, 0, 2'000'000'000, 2'000'000'000};
  EXPECT_EQ(open_writer(folder / "a.exr", image.spec).error().kind, ErrorKind::too_large);
  EXPECT_EQ(folder.entries(), 0);
}

}  // namespace
}  // namespace pse::image
