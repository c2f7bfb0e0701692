// A file that appears whole or not at all: it is written without a name (or under a temporary one)
// beside its target and takes the target's place in one step. Whatever happens before that leaves
// the old file as it was.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "image/error.h"

namespace pse::image {

class OutputFile {
 public:
  // "-" is standard output. Devices and pipes are supported: they get the content at commit.
  // `sync` waits for the disk before the file takes its place.
  static Result<OutputFile> create(const std::string& path, bool sync = true);

  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&& other) noexcept;
  ~OutputFile();  // without commit: nothing remains

  // False when the disk refused; error() then says why. After a failure every later write fails
  // too.
  bool write(const void* from, std::size_t count);
  bool seek(std::uint64_t position);
  std::uint64_t tell() const { return position_ + buffer_.size(); }
  bool failed() const { return errno_ != 0; }
  ImageError error() const;

  // A path under which libraries and child processes can write the content themselves, instead of
  // write().
  std::string path_for_others() const;

  // Puts the file in its place. Call once, last.
  Result<void> commit();

  const std::string& name() const { return name_; }  // as messages show it

 private:
  OutputFile() = default;
  bool flush();
  bool copy_to(int target);
  void discard();

  std::string name_;
  std::string target_;     // the file to replace; empty: a device or a pipe
  std::string temporary_;  // the temporary's name; empty while it has none
  int file_ = -1;
  int device_ = -1;  // where the content goes at commit when there is no target
  bool sync_ = true;
  unsigned mode_ = 0;  // permissions of the file to replace; 0: a new file
  int errno_ = 0;
  std::uint64_t position_ = 0;  // of the buffer's start
  std::vector<char> buffer_;
};

}  // namespace pse::image
