// What happens to NaN and infinity on their way into a file. They are counted in every case, so
// that they are never silent. Plus infinity in the channel Z is no fault: it means that nothing was
// hit.
#pragma once

#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "image/writer.h"

namespace pse::image {

enum class NanPolicy {
  keep,   // write them
  black,  // write 0
  box3,   // write the mean of the finite values among the 3 x 3 neighbours, 0 where there are none
  error   // refuse: ErrorKind::not_finite
};
std::optional<NanPolicy> nan_policy_from_name(std::string_view name);

// What was found in one channel.
struct NotFinite {
  std::int64_t nan = 0, infinite = 0;
  int x = 0, y = 0;  // the first place, row by row
  std::int64_t count() const { return nan + infinite; }
};
using NanReport = std::vector<NotFinite>;  // one per channel of the spec

// "3 NaN and 1 infinite value in N.X, the first at pixel (12, 7)"; empty when all is well.
std::string describe(const NanReport& report, const ImageSpec& spec);

// A writer that applies the policy and hands on. The report is filled while rows pass.
std::unique_ptr<ImageWriter> with_nan_policy(std::unique_ptr<ImageWriter> writer, NanPolicy policy,
                                             std::shared_ptr<NanReport> report);
// The same for an image in memory.
Result<NanReport> apply_nan_policy(Image& image, NanPolicy policy);

}  // namespace pse::image
