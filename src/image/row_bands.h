// The rows of an open image, decoded in bands when somebody asks and forgotten when others take
// their place: how a program that reads an image at its own pixel never holds it wholly. Between
// reader.h and whoever fills tiles. A small image is one band and is kept.
#pragma once

#include <list>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "image/reader.h"

namespace pse::image {

class RowBands {
 public:
  // Of these channels of `reader`, which must live as long and which nobody else reads meanwhile.
  RowBands(ImageReader& reader, std::vector<int> channels, const ReadLimits& limits = {});

  struct Band {
    int y0 = 0, y1 = 0;                      // rows of the data window
    std::vector<std::vector<float>> planes;  // one per channel, data-width * (y1 - y0)
  };
  // The bands that hold rows [y0, y1) of the data window, from top to bottom. Twice as many rows as
  // the tallest call asked for stay in memory, so that rows of tiles under way do not push each
  // other out. Safe to call from several threads. The error is the reader's.
  Result<std::vector<std::shared_ptr<const Band>>> rows(int y0, int y1);

  const Window& window() const { return window_; }
  int band_height() const { return height_; }
  // Bands decoded so far; counts those decoded again.
  int decoded() const { return decoded_; }

 private:
  Result<std::shared_ptr<const Band>> band(int number);
  Result<std::shared_ptr<const Band>> decode(int number);

  ImageReader& reader_;
  const std::vector<int> channels_;
  const ReadLimits limits_;
  const Window window_;
  int height_ = 1;  // of a band

  std::mutex mutex_;  // of the reader and of what follows
  std::list<std::pair<int, std::shared_ptr<const Band>>> held_;  // by number, the last used first
  std::size_t most_held_ = 0;
  int decoded_ = 0;
};

}  // namespace pse::image
