// A writer around a writer; see framed.h.
#include "image/framed.h"

#include <algorithm>

namespace pse::image {
namespace {

class Framed : public ImageWriter {
 public:
  Framed(std::unique_ptr<ImageWriter> frame, const ImageSpec& spec)
      : ImageWriter(spec, "the frame"), frame_(std::move(frame)) {
    rows_.assign(spec.channels.size(),
                 std::vector<float>(static_cast<std::size_t>(spec.display.width())));
    for (const auto& row : rows_) pointers_.push_back(row.data());
  }

 protected:
  Result<void> put_rows(int y, int count, std::span<const float* const> planes,
                        std::ptrdiff_t stride) override {
    if (y == spec_.data.y0)
      if (auto above = fill_to(y); !above) return above;
    const Window& frame = spec_.display;
    const int first = std::max(spec_.data.x0, frame.x0), last = std::min(spec_.data.x1, frame.x1);
    for (int row = 0; row < count; ++row) {
      if (y + row < frame.y0 || y + row >= frame.y1) continue;
      for (std::size_t c = 0; c < planes.size() && first < last; ++c)
        std::copy_n(planes[c] + row * stride + (first - spec_.data.x0), last - first,
                    rows_[c].data() + (first - frame.x0));
      if (auto done = frame_->write_rows(1, pointers_); !done) return done;
    }
    return {};
  }

  Result<void> finish() override {
    for (auto& row : rows_) std::fill(row.begin(), row.end(), 0.0f);
    if (auto below = fill_to(spec_.display.y1); !below) return below;
    return frame_->close();
  }

 private:
  // Writes rows of zeros up to the frame's row y.
  Result<void> fill_to(int y) {
    for (const int end = std::min(y, spec_.display.y1) - spec_.display.y0;
         frame_->next_row() < end;)
      if (auto done = frame_->write_rows(1, pointers_); !done) return done;
    return {};
  }

  std::unique_ptr<ImageWriter> frame_;
  std::vector<std::vector<float>> rows_;  // one row of the frame, by channel
  std::vector<const float*> pointers_;
};

}  // namespace

std::unique_ptr<ImageWriter> put_in_frame(std::unique_ptr<ImageWriter> frame,
                                          const ImageSpec& spec) {
  return std::make_unique<Framed>(std::move(frame), spec);
}

}  // namespace pse::image
