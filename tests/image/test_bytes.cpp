// Bytes of pipes: all of them, in their order, in memory or on disk; and what is no source of
// bytes.
#include <sys/stat.h>

#include <thread>

#include "files.h"
#include "image/byte_source.h"

namespace pse::image {
namespace {

using test::Folder;

unsigned char byte_at(std::size_t i) { return static_cast<unsigned char>(i * 7 + i / 4096); }

TEST(Bytes, APipeOfAnySizeIsReadWhole) {
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{100}, (std::size_t{32} << 20) + 12345}) {
    Folder folder;
    const std::string fifo = folder / "pipe";
    ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
    test::Content content(size);
    for (std::size_t i = 0; i < size; ++i) content[i] = byte_at(i);
    std::jthread writer([&] { test::put_content(fifo, content); });
    const auto bytes = open_bytes(fifo, std::uint64_t{1} << 32);
    ASSERT_TRUE(bytes) << bytes.error().message;
    EXPECT_EQ((*bytes)->size(), size);
    EXPECT_FALSE((*bytes)->is_file());
    test::Content back(size + 10);
    EXPECT_EQ((*bytes)->read_at(0, back.data(), back.size()), static_cast<std::int64_t>(size));
    back.resize(size);
    EXPECT_TRUE(back == content);
    EXPECT_EQ((*bytes)->read_at(size, back.data(), 1), 0);
    EXPECT_EQ(folder.entries(), 1);
  }
}

TEST(Bytes, TooMuchOfAPipeIsRefused) {
  Folder folder;
  const std::string fifo = folder / "pipe";
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  std::jthread writer([&] {
    ::signal(SIGPIPE, SIG_IGN);
    test::put_content(fifo, test::Content(200'000));
  });
  const auto bytes = open_bytes(fifo, 100'000);
  ASSERT_FALSE(bytes);
  EXPECT_EQ(bytes.error().kind, ErrorKind::too_large);
}

}  // namespace
}  // namespace pse::image
