// Tables behind the interfaces of images; see table.h.
#include "image/table.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>

namespace pse::image {
namespace {

// A whole table in memory: one row of pixels.
class TableReader : public ImageReader {
 public:
  TableReader(Columns columns, std::string format) : columns_(std::move(columns)) {
    spec_.display = spec_.data = {0, 0, static_cast<int>(columns_.rows()), 1};
    for (const std::string& name : columns_.names)
      spec_.channels.push_back({name, PixelType::float32});
    spec_.storage = std::to_string(columns_.rows()) + " rows";
    spec_.format = std::move(format);
  }

  Result<void> read_rows(int y0, int y1, std::span<const int> channels,
                         std::span<float* const> planes) override {
    for (std::size_t i = 0; i < channels.size() && y0 < y1; ++i)
      std::ranges::copy(columns_.values[static_cast<std::size_t>(channels[i])], planes[i]);
    return {};
  }

 private:
  Columns columns_;
};

// The column in which a channel is stored.
std::string column_of(const ImageSpec& spec, const std::string& channel) {
  if (channel == "R" || channel == "G" || channel == "B")
    return std::string("color.") + static_cast<char>(std::tolower(channel[0]));
  if (channel == "A") return "alpha";
  const std::size_t dot = channel.rfind('.');
  if (dot == std::string::npos) return channel;
  const std::string layer = channel.substr(0, dot + 1);
  const auto same = std::count_if(spec.channels.begin(), spec.channels.end(),
                                  [&](const Channel& c) { return c.name.starts_with(layer); });
  if (same == 1) return channel.substr(0, dot);
  std::string name = layer;
  for (const char c : channel.substr(dot + 1))
    name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return name;
}

class CsvWriter : public ImageWriter {
 public:
  CsvWriter(const ImageSpec& spec, OutputFile file)
      : ImageWriter(spec, file.name()), file_(std::move(file)) {
    for (const Channel& channel : spec_.channels)
      text_ += (text_.empty() ? "" : ",") + column_of(spec_, channel.name);
    text_ += '\n';
  }

 protected:
  Result<void> put_rows(int, int count, std::span<const float* const> planes,
                        std::ptrdiff_t stride) override {
    std::array<char, 32> digits{};
    for (std::ptrdiff_t row = 0; row < count; ++row) {
      for (std::ptrdiff_t x = 0; x < spec_.data.width(); ++x) {
        for (std::size_t c = 0; c < planes.size(); ++c) {
          // The shortest text that reads as the same number.
          const auto end = std::to_chars(digits.data(), digits.data() + digits.size(),
                                         planes[c][row * stride + x]);
          if (c > 0) text_ += ',';
          text_.append(digits.data(), end.ptr);
        }
        text_ += '\n';
      }
      if (!flush()) return std::unexpected(file_.error());
    }
    return {};
  }

  Result<void> finish() override {
    if (!flush()) return std::unexpected(file_.error());
    return file_.commit();
  }

 private:
  bool flush() {
    const bool good = file_.write(text_.data(), text_.size());
    text_.clear();
    return good;
  }

  OutputFile file_;
  std::string text_;
};

}  // namespace

Result<std::unique_ptr<ImageReader>> open_table(const Bytes& bytes, const ReadOptions& options) {
  const bool ply = is_ply(*bytes);
  auto columns = ply ? read_ply(*bytes, options.limits) : read_csv(*bytes, options.limits);
  if (!columns) return std::unexpected(columns.error());
  return std::make_unique<TableReader>(std::move(*columns), ply ? "ply" : "csv");
}

Result<std::unique_ptr<ImageWriter>> open_csv_writer(const std::string& path, const ImageSpec& spec,
                                                     const WriteOptions& options) {
  auto file = OutputFile::create(path, options.sync);
  if (!file) return std::unexpected(file.error());
  return std::make_unique<CsvWriter>(spec, std::move(*file));
}

}  // namespace pse::image
