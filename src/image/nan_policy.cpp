// NaN and infinity; see nan_policy.h. Rows pass through a window of three, because box3 looks at
// the neighbours; the neighbours are always those that the program computed, never repaired ones.
#include "image/nan_policy.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pse::image {
namespace {

bool is_fault(float value, bool depth) {
  return !std::isfinite(value) && !(depth && value == std::numeric_limits<float>::infinity());
}

// Counts the faults of a row. True when there are any.
bool count_row(const float* row, int width, bool depth, int x0, int y, NotFinite& found) {
  bool any = false;
  for (int x = 0; x < width; ++x) {
    if (!is_fault(row[x], depth)) continue;
    if (found.count() == 0) found.x = x0 + x, found.y = y;
    ++(std::isnan(row[x]) ? found.nan : found.infinite);
    any = true;
  }
  return any;
}

// The mean of the finite values around column x of three rows; missing rows are null.
float mean_around(const float* above, const float* here, const float* below, int x, int width) {
  double sum = 0;
  int count = 0;
  for (const float* row : {above, here, below})
    for (int i = std::max(x - 1, 0); row != nullptr && i <= std::min(x + 1, width - 1); ++i)
      if (std::isfinite(row[i])) sum += row[i], ++count;
  return count == 0 ? 0.0f : static_cast<float>(sum / count);
}

class Repairer : public ImageWriter {
 public:
  Repairer(std::unique_ptr<ImageWriter> writer, NanPolicy policy, std::shared_ptr<NanReport> report)
      : ImageWriter(writer->spec(), "the image"),
        writer_(std::move(writer)),
        policy_(policy),
        report_(std::move(report)),
        window_(3) {
    report_->assign(spec_.channels.size(), {});
    repaired_.resize(spec_.channels.size());
    for (const auto& channel : spec_.channels) depth_.push_back(channel.name == "Z");
  }

 protected:
  Result<void> put_rows(int y, int count, std::span<const float* const> planes,
                        std::ptrdiff_t stride) override {
    const int width = spec_.data.width();
    if (policy_ != NanPolicy::box3) return put_plain(y, count, planes, stride);
    for (int row = 0; row < count; ++row) {
      Row& next = window_[static_cast<std::size_t>(y + row - spec_.data.y0) % 3];
      next.values.resize(planes.size());
      next.faulty.assign(planes.size(), false);
      for (std::size_t c = 0; c < planes.size(); ++c) {
        const float* from = planes[c] + row * stride;
        next.values[c].assign(from, from + width);
        next.faulty[c] = count_row(from, width, depth_[c], spec_.data.x0, y + row, (*report_)[c]);
      }
      if (y + row > spec_.data.y0)
        if (auto done = repair(y + row - 1, true); !done) return done;
    }
    return {};
  }

  Result<void> finish() override {
    if (policy_ == NanPolicy::box3)
      if (auto done = repair(spec_.data.y1 - 1, false); !done) return done;
    return writer_->close();
  }

 private:
  struct Row {
    std::vector<std::vector<float>> values;  // by channel
    std::vector<bool> faulty;
  };

  // All policies that look at no neighbours.
  Result<void> put_plain(int y, int count, std::span<const float* const> planes,
                         std::ptrdiff_t stride) {
    const int width = spec_.data.width();
    std::vector<const float*> out(planes.begin(), planes.end());
    bool any = false;
    for (int row = 0; row < count; ++row)
      for (std::size_t c = 0; c < planes.size(); ++c)
        any |= count_row(planes[c] + row * stride, width, depth_[c], spec_.data.x0, y + row,
                         (*report_)[c]);
    if (!any || policy_ == NanPolicy::keep) return writer_->write_rows(count, planes, stride);
    if (policy_ == NanPolicy::error) return fail(ErrorKind::not_finite, describe(*report_, spec_));
    for (std::size_t c = 0; c < planes.size(); ++c) {
      repaired_[c].clear();
      for (int row = 0; row < count; ++row)
        for (int x = 0; x < width; ++x) {
          const float value = planes[c][row * stride + x];
          repaired_[c].push_back(is_fault(value, depth_[c]) ? 0.0f : value);
        }
      out[c] = repaired_[c].data();
    }
    return writer_->write_rows(count, out);
  }

  // Hands on row y, mended.
  Result<void> repair(int y, bool has_below) {
    const int width = spec_.data.width(), index = y - spec_.data.y0;
    const auto row_of = [&](int i) -> const Row& {
      return window_[static_cast<std::size_t>(i) % 3];
    };
    const Row& here = row_of(index);
    std::vector<const float*> out(spec_.channels.size());
    for (std::size_t c = 0; c < out.size(); ++c) {
      const float* values = here.values[c].data();
      out[c] = values;
      if (!here.faulty[c]) continue;
      const float* above = index > 0 ? row_of(index - 1).values[c].data() : nullptr;
      const float* below = has_below ? row_of(index + 1).values[c].data() : nullptr;
      repaired_[c].assign(values, values + width);
      for (int x = 0; x < width; ++x)
        if (is_fault(values[x], depth_[c]))
          repaired_[c][static_cast<std::size_t>(x)] = mean_around(above, values, below, x, width);
      out[c] = repaired_[c].data();
    }
    return writer_->write_rows(1, out);
  }

  std::unique_ptr<ImageWriter> writer_;
  NanPolicy policy_;
  std::shared_ptr<NanReport> report_;
  std::vector<Row> window_;  // rows y - 1, y, y + 1, at their number modulo 3
  std::vector<std::vector<float>> repaired_;
  std::vector<bool> depth_;
};

// Puts rows into an image in memory.
class IntoImage : public ImageWriter {
 public:
  explicit IntoImage(Image& image) : ImageWriter(image.spec, "the image"), image_(image) {}

 protected:
  Result<void> put_rows(int y, int count, std::span<const float* const> planes,
                        std::ptrdiff_t stride) override {
    const int width = spec_.data.width();
    for (std::size_t c = 0; c < planes.size(); ++c)
      for (int row = 0; row < count; ++row)
        std::copy_n(planes[c] + row * stride, width,
                    image_.planes[c].data() + std::int64_t{y + row - spec_.data.y0} * width);
    return {};
  }
  Result<void> finish() override { return {}; }

 private:
  Image& image_;
};

}  // namespace

std::optional<NanPolicy> nan_policy_from_name(std::string_view name) {
  if (name == "keep") return NanPolicy::keep;
  if (name == "black") return NanPolicy::black;
  if (name == "box3") return NanPolicy::box3;
  if (name == "error") return NanPolicy::error;
  return std::nullopt;
}

std::string describe(const NanReport& report, const ImageSpec& spec) {
  std::string text;
  for (std::size_t c = 0; c < report.size(); ++c) {
    const NotFinite& found = report[c];
    if (found.count() == 0) continue;
    if (!text.empty()) text += "; ";
    if (found.nan > 0) text += std::to_string(found.nan) + " NaN";
    if (found.nan > 0 && found.infinite > 0) text += " and ";
    if (found.infinite > 0) text += std::to_string(found.infinite) + " infinite";
    text += found.count() == 1 ? " value" : " values";
    text += " in " + spec.channels[c].name + ", the first at pixel (" + std::to_string(found.x) +
            ", " + std::to_string(found.y) + ")";
  }
  return text;
}

std::unique_ptr<ImageWriter> with_nan_policy(std::unique_ptr<ImageWriter> writer, NanPolicy policy,
                                             std::shared_ptr<NanReport> report) {
  return std::make_unique<Repairer>(std::move(writer), policy, std::move(report));
}

Result<NanReport> apply_nan_policy(Image& image, NanPolicy policy) {
  const auto report = std::make_shared<NanReport>();
  Repairer repairer(std::make_unique<IntoImage>(image), policy, report);
  const Image& from = image;
  std::vector<const float*> planes;
  for (const auto& plane : from.planes) planes.push_back(plane.data());
  // Row by row: a row is overwritten only after the rows that look at it have passed.
  for (int y = 0; y < image.spec.data.height(); ++y) {
    if (auto done = repairer.write_rows(1, planes); !done) return std::unexpected(done.error());
    for (auto& plane : planes) plane += image.spec.data.width();
  }
  if (auto done = repairer.close(); !done) return std::unexpected(done.error());
  return *report;
}

}  // namespace pse::image
