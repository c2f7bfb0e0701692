// Reading EXR; see exr_reader.h. Parts of one file become one set of channels over the window that
// covers all parts.
#include "image/exr_reader.h"

#include <OpenEXR/ImfBoxAttribute.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfThreading.h>

#include <algorithm>
#include <cstring>

#include "image/exr_attributes.h"
#include "image/exr_header.h"

namespace pse::image {
namespace {

// The library's view of a ByteSource. Small reads are served from a block.
class InStream : public Imf::IStream {
 public:
  explicit InStream(Bytes bytes) : Imf::IStream(bytes->name().c_str()), bytes_(std::move(bytes)) {}

  bool read(char to[], int count) override {
    int done = 0;
    while (done < count) {
      if (at_ < block_at_ || at_ >= block_at_ + block_.size()) fill();
      const std::size_t skip = static_cast<std::size_t>(at_ - block_at_);
      const std::size_t n = std::min(block_.size() - skip, static_cast<std::size_t>(count - done));
      std::memcpy(to + done, block_.data() + skip, n);
      at_ += n;
      done += static_cast<int>(n);
    }
    return at_ < bytes_->size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t position) override { at_ = position; }
  void clear() override {}

 private:
  void fill() {
    block_.resize(std::size_t{1} << 16);
    const std::int64_t got = bytes_->read_at(at_, block_.data(), block_.size());
    block_.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
    block_at_ = at_;
    if (got < 0) throw Iex::InputExc("the file cannot be read");
    if (got == 0) throw Iex::InputExc("the file ends too early");
  }

  Bytes bytes_;
  std::uint64_t at_ = 0, block_at_ = 0;
  std::vector<char> block_;
};

// One channel of one part.
struct Source {
  int part = 0;
  std::string name;
  int x_step = 1, y_step = 1;
};

struct Part {
  Imf::InputPart input;
  Window data;
  std::vector<int> channels;  // those of ours that lie in it
};

int floor_to(int value, int step) {
  const int rest = value % step;
  return value - (rest < 0 ? rest + step : rest);
}

// The prefix that a part's channels get. Parts of the chosen view lose the view's name.
std::string prefix_of(const Imf::Header& header, const std::string& view) {
  std::string name = header.hasName() ? header.name() : "";
  if (!header.hasView()) return name;
  const std::string& own = header.view();
  if (name.ends_with("." + own)) name.resize(name.size() - own.size() - 1);
  if (name == own) name.clear();
  if (own == view) return name;
  return name.empty() ? own : own + "." + name;
}

class ExrReader : public ImageReader {
 public:
  ExrReader(Bytes bytes, const ReadOptions& options)
      : stream_(bytes), name_(bytes->name()), file_(stream_, Imf::globalThreadCount()) {
    const auto& first = file_.header(0);
    spec_.format = "exr";
    spec_.display = exr::window_of(first.displayWindow());
    exr::read_attributes(first, spec_);
    spec_.storage = exr::describe_storage(first, file_.parts());

    std::string view = options.view;
    if (view.empty() && first.hasView()) view = first.view();
    for (int i = 0; i < file_.parts(); ++i) add_part(i, view);
    for (const auto& part : parts_) spec_.data = spec_.data.joined(part.data);
    if (file_.parts() == 1 && Imf::hasMultiView(first))
      move_views(Imf::multiView(first), options.view);
  }

  const std::string& name() const { return name_; }

  Result<void> read_rows(int y0, int y1, std::span<const int> channels,
                         std::span<float* const> planes) override {
    if (y0 < spec_.data.y0 || y1 > spec_.data.y1 || y0 > y1 || channels.size() != planes.size())
      return fail(ErrorKind::bad_request, "rows outside the data window of " + name_);
    try {
      for (std::size_t i = 0; i < parts_.size(); ++i)
        read_part(static_cast<int>(i), y0, y1, channels, planes);
      return {};
    } catch (const std::bad_alloc&) {
      return fail(ErrorKind::too_large, "not enough memory to read " + name_);
    } catch (const std::exception& problem) {
      return std::unexpected(exr::explain(name_, problem));
    }
  }

 private:
  void add_part(int index, const std::string& view) {
    const auto& header = file_.header(index);
    const std::string type = header.hasType() ? header.type() : "";
    if (type.starts_with("deep")) throw Iex::InputExc("deep data is not read");
    Part part{Imf::InputPart(file_, index), exr::window_of(header.dataWindow()), {}};

    // A channel's name gets the part's in front, unless it says it already, or it is the picture's
    // own colour, or it names a layer itself (`N.X` of a part `normals`), or it is the depth.
    const std::string prefix = file_.parts() > 1 ? prefix_of(header, view) : "";
    const bool own_view = !header.hasView() || header.view() == view;
    const auto& list = header.channels();
    bool plain = false;
    if (!has_root_colour_ && own_view &&
        (list.findChannel("R") != nullptr || list.findChannel("Y") != nullptr))
      plain = has_root_colour_ = true;
    for (auto c = list.begin(); c != list.end(); ++c) {
      std::string name = c.name();
      const bool said = name.starts_with(prefix + ".") || (!plain && name == prefix);
      const bool whole = own_view && spec_.find(name) < 0 &&
                         (name == "Z" || name.find('.') != std::string::npos);
      if (!prefix.empty() && !said && !plain && !whole) name = prefix + "." + name;
      while (spec_.find(name) >= 0) name = "part" + std::to_string(index + 1) + "." + name;
      const auto& channel = c.channel();
      const PixelType pixel = channel.type == Imf::HALF    ? PixelType::float16
                              : channel.type == Imf::FLOAT ? PixelType::float32
                                                           : PixelType::uint32;
      part.channels.push_back(static_cast<int>(spec_.channels.size()));
      spec_.channels.push_back({name, pixel});
      sources_.push_back({index, c.name(), channel.xSampling, channel.ySampling});
    }
    parts_.push_back(std::move(part));
  }

  // In one part with several views the first has no prefix. When another is asked for they change
  // places.
  void move_views(const Imf::StringVector& views, const std::string& wanted) {
    if (wanted.empty() || views.empty() || views.front() == wanted) return;
    if (std::find(views.begin(), views.end(), wanted) == views.end())
      throw Iex::ArgExc("there is no view " + wanted);
    const auto is_of = [&](const std::string& name, const std::string& view) {
      return name.starts_with(view + ".") || name.find("." + view + ".") != std::string::npos;
    };
    for (auto& channel : spec_.channels) {
      std::string& name = channel.name;
      const bool other = std::any_of(views.begin() + 1, views.end(),
                                     [&](const auto& view) { return is_of(name, view); });
      if (is_of(name, wanted)) {
        const auto at = name.starts_with(wanted + ".") ? 0 : name.find("." + wanted + ".") + 1;
        name.erase(at, wanted.size() + 1);
      } else if (!other) {
        name.insert(0, views.front() + ".");
      }
    }
  }

  // The rows of those asked-for channels that lie in one part.
  void read_part(int index, int y0, int y1, std::span<const int> channels,
                 std::span<float* const> planes) {
    Part& part = parts_[static_cast<std::size_t>(index)];
    const int width = spec_.data.width();
    const int first = std::max(y0, part.data.y0), last = std::min(y1, part.data.y1);
    const bool covers =
        part.data.x0 == spec_.data.x0 && part.data.x1 == spec_.data.x1 && first == y0 && last == y1;

    // Point the full-size channels straight into the caller's planes.
    Imf::FrameBuffer full;
    std::vector<std::size_t> coarse;
    for (std::size_t i = 0; i < channels.size(); ++i) {
      const Source& source = sources_.at(static_cast<std::size_t>(channels[i]));
      if (source.part != index) continue;
      if (!covers)
        std::fill_n(planes[i], static_cast<std::size_t>(width) * static_cast<std::size_t>(y1 - y0),
                    0.0f);
      if (source.x_step != 1 || source.y_step != 1) {
        coarse.push_back(i);
      } else {
        full.insert(source.name, slice(planes[i], spec_.data.x0, y0, width, 1, 1));
      }
    }
    if (first >= last) return;
    if (full.begin() != full.end()) {
      part.input.setFrameBuffer(full);
      part.input.readPixels(first, last - 1);
    }
    for (const std::size_t i : coarse)
      read_coarse(part, sources_[static_cast<std::size_t>(channels[i])], first, last,
                  planes[i] - std::ptrdiff_t{y0} * width - spec_.data.x0);
  }

  // A sub-sampled channel: each stored value stands for x_step * y_step pixels right and below of
  // it. `origin` is where pixel (0, 0) would be.
  void read_coarse(Part& part, const Source& source, int first, int last, float* origin) {
    const int xs = source.x_step, ys = source.y_step;
    const int x_first = floor_to(part.data.x0, xs), y_first = floor_to(first, ys);
    const int columns = (part.data.x1 - 1 - x_first) / xs + 1;
    const int rows = (last - 1 - y_first) / ys + 1;
    std::vector<float> stored(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
    Imf::FrameBuffer buffer;
    buffer.insert(source.name, slice(stored.data(), x_first / xs, y_first / ys, columns, xs, ys));
    part.input.setFrameBuffer(buffer);
    part.input.readPixels(std::max(y_first, part.data.y0), last - 1);

    for (int y = first; y < last; ++y)
      for (int x = part.data.x0; x < part.data.x1; ++x)
        origin[std::ptrdiff_t{y} * spec_.data.width() + x] =
            stored[static_cast<std::size_t>((y - y_first) / ys) *
                       static_cast<std::size_t>(columns) +
                   static_cast<std::size_t>((x - x_first) / xs)];
  }

  // A plane whose first float is that of sample (x0, y0), as the library wants to be told.
  static Imf::Slice slice(float* plane, int x0, int y0, int width, int x_step, int y_step) {
    const std::ptrdiff_t back = (std::ptrdiff_t{y0} * width + x0) * std::ptrdiff_t{sizeof(float)};
    char* origin = reinterpret_cast<char*>(reinterpret_cast<std::intptr_t>(plane) - back);
    return Imf::Slice(Imf::FLOAT, origin, sizeof(float),
                      sizeof(float) * static_cast<std::size_t>(width), x_step, y_step);
  }

  InStream stream_;
  std::string name_;
  Imf::MultiPartInputFile file_;
  std::vector<Part> parts_;
  std::vector<Source> sources_;  // one per channel
  bool has_root_colour_ = false;
};

}  // namespace

Result<std::unique_ptr<ImageReader>> open_exr(const Bytes& bytes, const ReadOptions& options) {
  if (auto good = check_exr_header(*bytes, options.limits); !good)
    return std::unexpected(good.error());
  try {
    return std::make_unique<ExrReader>(bytes, options);
  } catch (const std::bad_alloc&) {
    return fail(ErrorKind::too_large, "not enough memory to read " + bytes->name());
  } catch (const std::exception& problem) {
    return std::unexpected(exr::explain(bytes->name(), problem));
  }
}

void set_codec_threads(int count) { Imf::setGlobalThreadCount(std::max(0, count)); }

}  // namespace pse::image
