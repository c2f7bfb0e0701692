// Batches of places: filled by the source, slopes as differences across the pixel.
#include "antialias/places.h"

#include <algorithm>
#include <limits>

#include "stream/planes.h"

namespace pse::antialias {
namespace {

constexpr std::size_t batch = 1024;

}  // namespace

PlaceRunner::PlaceRunner(const Program& program, const FrameState& state,
                         const SampleSource& source)
    : program_(program), state_(state), source_(source) {
  const std::vector<ir::Input>& inputs = program.module().inputs;
  used_.resize(inputs.size());
  sloping_.resize(inputs.size());
  for (std::size_t i = 0; i < inputs.size(); ++i) used_[i] = inputs[i].rate == ir::Rate::sample;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const std::string& name = inputs[i].name;
    if (!used_[i] || name.size() < 3 || name[name.size() - 2] != '$') continue;
    const auto of = std::ranges::find(inputs, name.substr(0, name.size() - 2), &ir::Input::name);
    if (of == inputs.end()) continue;
    const auto index = static_cast<std::size_t>(of - inputs.begin());
    slopes_.push_back({i, index, name.back() == 'x'});
    sloping_[index] = true;
  }
  for (std::size_t i = 0; i < inputs.size() && !slopes_.empty(); ++i)
    if (used_[i] && inputs[i].name == "id") id_ = i, sloping_[i] = true;
  if (!source.is_even()) return;
  const Planes low(sloping_, 1), high(sloping_, 1);
  for (Slope& slope : slopes_) {
    const double zero[] = {0}, one[] = {1};
    source.fill(zero, zero, low.pointers());
    source.fill(slope.along_x ? one : zero, slope.along_x ? zero : one, high.pointers());
    slope.even = high.pointers()[slope.of][0] - low.pointers()[slope.of][0];
  }
}

void PlaceRunner::fill(std::span<const double> x, std::span<const double> y,
                       std::span<float* const> planes) const {
  source_.fill(x, y, planes);
  if (slopes_.empty()) return;
  if (source_.is_even()) {
    for (const Slope& slope : slopes_) std::fill_n(planes[slope.input], x.size(), slope.even);
    return;
  }
  // Between the pixel's sides where the source can be asked there, else between its neighbours.
  const double step = source_.anywhere() ? 0.5 : 1;
  const auto scale = static_cast<float>(0.5 / step);
  const Planes low(sloping_, static_cast<std::int64_t>(x.size()));
  const Planes high(sloping_, static_cast<std::int64_t>(x.size()));
  for (const bool along_x : {true, false}) {
    std::vector<double> moved(along_x ? x.begin() : y.begin(), along_x ? x.end() : y.end());
    const auto fill_moved = [&](double by, const Planes& to) {
      for (double& place : moved) place += by;
      if (along_x)
        source_.fill(moved, y, to.pointers());
      else
        source_.fill(x, moved, to.pointers());
    };
    fill_moved(-step, low);
    fill_moved(2 * step, high);
    for (const Slope& slope : slopes_) {
      if (slope.along_x != along_x) continue;
      const float *from = low.pointers()[slope.of], *to = high.pointers()[slope.of];
      float* out = planes[slope.input];
      for (std::size_t i = 0; i < x.size(); ++i) out[i] = (to[i] - from[i]) * scale;
      if (id_ == no_id) continue;
      // Only neighbours of the same object count; with none there is no slope.
      const float *here = planes[slope.of], *id = planes[id_];
      const float *id_from = low.pointers()[id_], *id_to = high.pointers()[id_];
      for (std::size_t i = 0; i < x.size(); ++i) {
        const bool has_from = id_from[i] == id[i], has_to = id_to[i] == id[i];
        if (has_from && has_to) continue;
        out[i] = has_to     ? (to[i] - here[i]) * 2 * scale
                 : has_from ? (here[i] - from[i]) * 2 * scale
                            : std::numeric_limits<float>::quiet_NaN();
      }
    }
  }
}

Results PlaceRunner::run(const Places& places, RunStatus& status) const {
  const std::size_t count = places.size(), outputs = program_.module().outputs.size();
  Results results(outputs, std::vector<float>(count));
  const auto capacity = static_cast<std::int64_t>(std::min(count, batch));
  const Planes in(used_, capacity), out(std::vector<bool>(outputs, true), capacity);
  Scratch scratch;
  for (std::size_t first = 0; first < count && !status.cancel; first += batch) {
    const std::size_t size = std::min(batch, count - first);
    fill(std::span(places.x).subspan(first, size), std::span(places.y).subspan(first, size),
         in.pointers());
    program_.kernel->run_samples(state_, status, scratch, in.pointers().data(),
                                 out.pointers().data(), static_cast<std::int64_t>(size));
    for (std::size_t o = 0; o < outputs; ++o)
      std::copy_n(out.pointers()[o], size, results[o].begin() + static_cast<std::ptrdiff_t>(first));
  }
  return results;
}

}  // namespace pse::antialias
