// Opening input images and copying their pixels into tiles.
#include "app/input_images.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>

#include "image/sequence.h"

namespace pse::app {
namespace {

Failure input_failure(const image::ImageError& error) { return {Exit::input, error.message}; }

std::string stream_prefix(const std::string& name) { return name.empty() ? "" : name + "."; }

// One module input and the plane that feeds it.
struct Feed {
  std::size_t input;
  std::shared_ptr<const image::Image> picture;
  std::size_t plane;
};

// Copies the part of a plane that lies under the tile; 0 where the image has no pixels.
void fill(const Feed& feed, int origin_x, int origin_y, const TileView& tile) {
  const image::Window& data = feed.picture->spec.data;
  const std::vector<float>& plane = feed.picture->planes[feed.plane];
  float* out = tile.planes[feed.input];
  const int x0 = tile.rect.x0 + origin_x, x1 = tile.rect.x1 + origin_x;
  const int begin = std::clamp(data.x0, x0, x1), end = std::clamp(data.x1, begin, x1);
  for (int row = tile.rect.y0; row < tile.rect.y1; ++row, out += tile.rect.width()) {
    const int y = row + origin_y;
    const bool inside = y >= data.y0 && y < data.y1 && begin < end;
    std::fill_n(out, tile.rect.width(), 0.0f);
    if (inside) {
      const std::int64_t start = std::int64_t{y - data.y0} * data.width() + (begin - data.x0);
      std::copy_n(plane.begin() + start, end - begin, out + (begin - x0));
    }
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
  for (const ImageRequest& image : options.images)
    images_.push_back(
        {image.name, session.find_file(image.file), {}, nullptr, {}, image.derived});
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
  struct Loaded {
    std::vector<Feed> feeds;
    std::vector<image::Window> displays;  // one per feed
  };
  auto loaded = std::make_shared<Loaded>();

  for (Open& image : images_) {
    // Find the channels that the program reads, and the inputs they feed.
    std::vector<std::string> channels;
    std::vector<std::size_t> inputs;
    const image::ImageSpec& spec = image.reader->spec();
    for (const image::Layer& layer : image.layers) {
      if (is_hidden(image, layer)) continue;
      const std::string name = stream_prefix(image.name) + layer.name;
      for (int c = 0; c < layer.components(); ++c) {
        const std::string component =
            layer.components() == 1 ? name : fmt::format("{}.{}", name, c);
        for (std::size_t i = 0; i < module.inputs.size(); ++i) {
          if (module.inputs[i].rate != ir::Rate::sample || module.inputs[i].name != component)
            continue;
          inputs.push_back(i);
          channels.push_back(
              spec.channels[static_cast<std::size_t>(layer.channels[static_cast<std::size_t>(c)])]
                  .name);
        }
      }
    }
    if (channels.empty()) continue;

    // Read them.
    auto picture = image::read_image(*image.reader, read_.limits, channels);
    if (!picture) throw input_failure(picture.error());
    const auto shared = std::make_shared<const image::Image>(std::move(*picture));
    for (std::size_t k = 0; k < channels.size(); ++k) {
      const int plane = shared->spec.find(channels[k]);
      if (plane < 0)
        throw Failure(Exit::input, fmt::format("{} has no channel {}", image.file, channels[k]));
      loaded->feeds.push_back({inputs[k], shared, static_cast<std::size_t>(plane)});
      loaded->displays.push_back(spec.display);
    }
  }
  return [loaded = std::shared_ptr<const Loaded>(loaded),
          tables = tables_.load(module, picture_plane)](const TileView& tile) {
    tables(tile);
    for (std::size_t k = 0; k < loaded->feeds.size(); ++k)
      fill(loaded->feeds[k], loaded->displays[k].x0, loaded->displays[k].y0, tile);
  };
}

}  // namespace pse::app
