// Reading a text with a bound on its size.
#include "app/text_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

#include "app/console.h"
#include "app/failure.h"

namespace pse::app {
namespace {

constexpr std::size_t most_bytes = 16u << 20;

}  // namespace

std::string read_text_file(const std::string& path) {
  const bool standard_input = path == "-";
  const std::string shown = standard_input ? "standard input" : path;
  std::error_code error;
  if (!standard_input && std::filesystem::is_directory(path, error))
    throw Failure(Exit::input, fmt::format("cannot read {}: it is a folder", shown));

  const auto close = [](std::FILE* file) { return file == stdin ? 0 : std::fclose(file); };
  const std::unique_ptr<std::FILE, decltype(close)> file(
      standard_input ? stdin : std::fopen(path.c_str(), "rb"), close);
  if (!file)
    throw Failure(Exit::input, fmt::format("cannot read {}: {}", shown, std::strerror(errno)));

  std::string text;
  std::string block(1 << 16, '\0');
  while (const std::size_t count = std::fread(block.data(), 1, block.size(), file.get())) {
    text.append(block, 0, count);
    if (text.size() > most_bytes)
      throw Failure(Exit::input, fmt::format("{} is larger than the {} that a text may have", shown,
                                             human_bytes(most_bytes)));
  }
  if (std::ferror(file.get()) != 0)
    throw Failure(Exit::input, fmt::format("cannot read {}: {}", shown, std::strerror(errno)));
  return text;
}

}  // namespace pse::app
