// Opening input images and copying their pixels into tiles.
#include "app/input_images.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>

#include "app/span_places.h"
#include "image/sequence.h"

namespace pse::app {
namespace {

constexpr std::string_view prepass_near = "prepass.near", prepass_far = "prepass.far";

Failure input_failure(const image::ImageError& error) { return {Exit::input, error.message}; }

std::string stream_prefix(const std::string& name) { return name.empty() ? "" : name + "."; }

// One module input and the plane of the image's bands that feeds it.
struct Feed {
  std::size_t input;
  std::size_t plane;
  float outside = 0;  // where the image has no pixels
};

// Without a pixel of a prepass matter may be anywhere.
float outside_of(const std::string& component) {
  return component == prepass_near ? anywhere_near : component == prepass_far ? anywhere_far : 0;
}

// An image's pixels on their way into tiles.
struct Stream {
  std::shared_ptr<image::RowBands> bands;
  std::vector<Feed> feeds;
  image::Window display;
};

// Copies the parts of an image's planes that lie under the tile.
void fill(const Stream& stream, const TileView& tile) {
  const image::Window& data = stream.bands->window();
  const int origin_x = stream.display.x0, origin_y = stream.display.y0;
  const auto bands = stream.bands->rows(tile.rect.y0 + origin_y, tile.rect.y1 + origin_y);
  if (!bands) throw input_failure(bands.error());
  const int x0 = tile.rect.x0 + origin_x, x1 = tile.rect.x1 + origin_x;
  const int begin = std::clamp(data.x0, x0, x1), end = std::clamp(data.x1, begin, x1);
  for (const Feed& feed : stream.feeds) {
    float* to = tile.planes[feed.input];
    std::fill_n(to, tile.count, feed.outside);
    for (const auto& band : *bands)
      for (int y = std::max(band->y0, tile.rect.y0 + origin_y);
           y < std::min(band->y1, tile.rect.y1 + origin_y) && begin < end; ++y)
        std::copy_n(band->planes[feed.plane].data() +
                        std::int64_t{y - band->y0} * data.width() + (begin - data.x0),
                    end - begin,
                    to + std::int64_t{y - origin_y - tile.rect.y0} * tile.rect.width() +
                        (begin - x0));
  }
}

}  // namespace

std::string file_identity(const std::string& file) {
  struct stat status {};
  if (file == "-" || stat(file.c_str(), &status) != 0) return "";
  return fmt::format("{} {}.{:09}", status.st_size, status.st_mtim.tv_sec, status.st_mtim.tv_nsec);
}

InputImages::InputImages(const RenderOptions& options, const Session& session)
    : tables_(options, session) {
  read_.working = options.write.working;
  // Before anything is opened: a reader goes on with as many as there are then.
  image::set_codec_threads(thread_count(options.threads));
  for (const ImageRequest& image : options.images)
    images_.push_back(
        {.name = image.name, .pattern = session.find_file(image.file), .derived = image.derived});
}

bool InputImages::vary() const {
  return tables_.vary() ||
         std::any_of(images_.begin(), images_.end(),
                     [](const Open& image) { return image::is_pattern(image.pattern); });
}

void InputImages::open(int frame) {
  tables_.open(frame);
  for (Open& image : images_) {
    const auto file = image::frame_name(image.pattern, frame);
    if (!file) throw usage_error(file.error());
    if (image.reader && image.file == *file) continue;
    auto reader = image::open_reader(*file, read_);
    if (!reader) throw input_failure(reader.error());
    image.file = *file;
    image.bands.reset();
    image.reader = std::move(*reader);
    image.layers = image::layers_of(image.reader->spec());
  }
  for (const Open& image : images_) {
    const image::Window &first = images_.front().reader->spec().display,
                        &here = image.reader->spec().display;
    if (first.width() != here.width() || first.height() != here.height())
      throw Failure(Exit::input, fmt::format("the images differ in size: {} is {}x{}, {} is {}x{}",
                                             images_.front().file, first.width(), first.height(),
                                             image.file, here.width(), here.height()));
  }
}

std::vector<StreamName> InputImages::names() const {
  std::vector<StreamName> names;
  for (const Open& image : images_)
    for (const image::Layer& layer : image.layers)
      if (!is_hidden(image, layer))
        names.push_back(
            {stream_prefix(image.name) + layer.name, layer.components(), ir::Rate::sample});
  for (StreamName& name : tables_.names()) names.push_back(std::move(name));
  return names;
}

bool InputImages::is_hidden(const Open& image, const image::Layer& layer) const {
  return image.name.empty() &&
         std::find(hidden_.begin(), hidden_.end(), layer.name) != hidden_.end();
}

std::optional<InputImages::Bare> InputImages::bare() const {
  for (const Open& image : images_)
    if (image.name.empty() && image.reader) return Bare{*image.reader, image.layers, image.file};
  return std::nullopt;
}

std::optional<image::Window> InputImages::display() const {
  if (images_.empty()) return std::nullopt;
  return images_.front().reader->spec().display;
}

std::optional<image::Window> InputImages::data() const {
  std::optional<image::Window> joined = display();
  if (joined) *joined = joined->joined(images_.front().reader->spec().data);
  return joined;
}

std::vector<std::pair<std::string, std::string>> InputImages::identities() const {
  std::vector<std::pair<std::string, std::string>> all;
  for (const Open& image : images_)
    if (!image.derived) all.emplace_back(image.name + "=" + image.file, file_identity(image.file));
  for (auto& table : tables_.identities()) all.push_back(std::move(table));
  return all;
}

TileSource InputImages::load(const ir::Module& module, const ImagePlane& picture_plane) {
  auto streams = std::make_shared<std::vector<Stream>>();
  for (Open& image : images_) {
    // Find the channels that the program reads, and the inputs they feed.
    std::vector<int> channels;
    std::vector<Feed> feeds;
    for (const image::Layer& layer : image.layers) {
      if (is_hidden(image, layer)) continue;
      const std::string name = stream_prefix(image.name) + layer.name;
      for (int c = 0; c < layer.components(); ++c) {
        const std::string component =
            layer.components() == 1 ? name : fmt::format("{}.{}", name, c);
        const int channel = layer.channels[static_cast<std::size_t>(c)];
        for (std::size_t i = 0; i < module.inputs.size(); ++i) {
          if (module.inputs[i].rate != ir::Rate::sample || module.inputs[i].name != component)
            continue;
          const auto known = std::ranges::find(channels, channel);
          feeds.push_back(
              {i, static_cast<std::size_t>(known - channels.begin()), outside_of(component)});
          if (known == channels.end()) channels.push_back(channel);
        }
      }
    }
    if (channels.empty()) continue;

    // Read the first rows now: what is broken should be known before anything is computed. What
    // another frame of the same file has read is still there.
    if (!image.bands || image.channels != channels)
      image.bands = std::make_shared<image::RowBands>(*image.reader, channels, read_.limits);
    image.channels = channels;
    const image::Window& data = image.bands->window();
    if (const auto first = image.bands->rows(data.y0, data.y0 + 1); !first)
      throw input_failure(first.error());
    streams->push_back({image.bands, std::move(feeds), image.reader->spec().display});
  }
  return [streams = std::shared_ptr<const std::vector<Stream>>(streams),
          tables = tables_.load(module, picture_plane)](const TileView& tile) {
    tables(tile);
    for (const Stream& stream : *streams) fill(stream, tile);
  };
}

bool InputImages::is_span(const StreamName& name) {
  return name.components == 1 && (name.name == prepass_near || name.name == prepass_far);
}

std::unique_ptr<SampleSource> InputImages::anywhere(const ir::Module& module,
                                                    std::unique_ptr<SampleSource> places) const {
  for (const Open& image : images_) {
    if (!image.bands) continue;
    const image::Window& display = image.reader->spec().display;
    StoredSpans spans{image.bands, display.x0, display.y0};
    const auto find = [&](std::string_view component,
                          const image::Layer& layer) -> std::optional<StoredSpans::Bound> {
      if (layer.components() != 1 || stream_prefix(image.name) + layer.name != component)
        return std::nullopt;
      const auto channel = std::ranges::find(image.channels, layer.channels[0]);
      for (std::size_t i = 0; i < module.inputs.size() && channel != image.channels.end(); ++i)
        if (module.inputs[i].rate == ir::Rate::sample && module.inputs[i].name == component)
          return StoredSpans::Bound{i, static_cast<std::size_t>(channel - image.channels.begin())};
      return std::nullopt;
    };
    for (const image::Layer& layer : image.layers) {
      if (const auto near = find(prepass_near, layer)) spans.near = near;
      if (const auto far = find(prepass_far, layer)) spans.far = far;
    }
    if (spans.near || spans.far) places = with_spans(std::move(places), std::move(spans));
  }
  return places;
}

}  // namespace pse::app
