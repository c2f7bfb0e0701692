// Batches of places: filled by the source, slopes as differences across the pixel.
#include "antialias/places.h"

#include <algorithm>
#include <limits>

namespace pse::antialias {
namespace {

constexpr std::size_t batch = 1024;

}  // namespace

void Results::resize(std::size_t outputs, std::size_t places) {
  if (outputs <= planes_.pointers().size() && places <= capacity_) return;
  capacity_ = std::max(places, 2 * capacity_);
  planes_ = Planes(std::vector<bool>(std::max(outputs, planes_.pointers().size()), true),
                   static_cast<std::int64_t>(capacity_));
}

std::vector<InputSlope> input_slopes(const ir::Module& module) {
  const std::vector<ir::Input>& inputs = module.inputs;
  std::vector<InputSlope> found;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const std::string& name = inputs[i].name;
    if (name.size() < 3 || name[name.size() - 2] != '$') continue;
    const auto of = std::ranges::find(inputs, name.substr(0, name.size() - 2), &ir::Input::name);
    if (of == inputs.end()) continue;
    found.push_back({i, static_cast<std::size_t>(of - inputs.begin()), name.back() == 'x',
                     inputs[i].rate != ir::Rate::sample});
  }
  return found;
}

PlaceRunner::PlaceRunner(const Program& program, const FrameState& state,
                         const SampleSource& source)
    : program_(program), state_(state), source_(source) {
  const std::vector<ir::Input>& inputs = program.module().inputs;
  used_.resize(inputs.size());
  sloping_.resize(inputs.size());
  for (std::size_t i = 0; i < inputs.size(); ++i) used_[i] = inputs[i].rate == ir::Rate::sample;
  for (const InputSlope& slope : input_slopes(program.module())) {
    if (slope.is_even || source.brings_slope(inputs[slope.input].name)) continue;
    slopes_.push_back(slope);
    sloping_[slope.of] = true;
  }
  for (std::size_t i = 0; i < inputs.size() && !slopes_.empty(); ++i)
    if (used_[i] && inputs[i].name == "id") id_ = i, sloping_[i] = true;
}

void PlaceRunner::fill(std::span<const double> x, std::span<const double> y,
                       std::span<float* const> planes) const {
  source_.fill(x, y, planes);
  if (slopes_.empty()) return;
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
    for (const InputSlope& slope : slopes_) {
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

const Planes& PlaceRunner::inputs(Work& work) const {
  for (const auto& [runner, planes] : work.inputs)
    if (runner == this) return planes;
  return work.inputs.emplace_back(this, Planes(used_, batch)).second;
}

const Results& PlaceRunner::run(Work& work, RunStatus& status) const {
  const std::size_t count = work.places.count, outputs = program_.module().outputs.size();
  const std::span<const double> x = work.places.x, y = work.places.y;
  work.results.resize(outputs, count);
  const std::span<float* const> in = inputs(work).pointers();
  std::vector<float*>& out = work.outputs;
  out.resize(outputs);
  for (std::size_t first = 0; first < count && !status.stopped(); first += batch) {
    const std::size_t size = std::min(batch, count - first);
    fill(x.subspan(first, size), y.subspan(first, size), in);
    for (std::size_t o = 0; o < outputs; ++o) out[o] = work.results[o] + first;
    program_.kernel->run_samples(state_, status, work.scratch, in.data(), out.data(),
                                 static_cast<std::int64_t>(size));
  }
  return work.results;
}

}  // namespace pse::antialias
