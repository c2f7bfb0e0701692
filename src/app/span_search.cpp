// Rays in batches through the program that says where matter is: what the prepass looks with
// (app/prepass.h).
#include <algorithm>

#include "app/prepass.h"
#include "app/surfaces.h"
#include "stream/batches.h"

namespace pse::app {

SpanSearch::SpanSearch(const Program& program, const ImagePlane& plane,
                       const std::vector<Knob>& knobs,
                       const std::vector<ExternalFunction>& externals, int threads,
                       RunStatus& status)
    : program_(program),
      places_(image_plane_samples(program.module(), plane)),
      start_(plane_state(program.module(), plane, knobs)),
      threads_(threads),
      status_(status) {
  start_.externals = externals;
  const auto& outputs = program.module().outputs;
  const auto find = [&](const char* name) {
    return static_cast<std::size_t>(
        std::find_if(outputs.begin(), outputs.end(),
                     [&](const ir::Output& output) { return output.name == name; }) -
        outputs.begin());
  };
  near_output_ = find("span.0");
  far_output_ = find("span.1");
  count_output_ = find("evaluations");
}

bool SpanSearch::look(std::vector<Ray>& rays, int step) {
  constexpr std::int64_t batch = 1024;
  const ir::Module& module = program_.module();
  FrameState state = start_;
  for (std::size_t i = 0; i < module.inputs.size(); ++i)
    if (module.inputs[i].name == "prepass.step") state.uniforms[i] = static_cast<float>(step);
  program_.kernel->run_frame(state, status_);
  if (status_.failed_check >= 0 || status_.cancel) return false;

  const auto part = [&](std::int64_t number) {
    const auto size = static_cast<std::int64_t>(rays.size());
    return std::span(rays).subspan(
        static_cast<std::size_t>(number * batch),
        static_cast<std::size_t>(std::min(batch, size - number * batch)));
  };
  std::vector<double> counts(rays.size() / batch + 1);
  BatchPlan plan;
  plan.batches = (static_cast<std::int64_t>(rays.size()) + batch - 1) / batch;
  plan.capacity = batch;
  plan.threads = threads_;
  plan.count = [&](std::int64_t number) { return static_cast<std::int64_t>(part(number).size()); };
  plan.fill = [&](std::int64_t number, std::span<float* const> planes) {
    const auto some = part(number);
    std::vector<double> x, y;
    for (const Ray& ray : some) x.push_back(ray.x), y.push_back(ray.y);
    places_->fill(x, y, planes);
    for (std::size_t i = 0; i < module.inputs.size(); ++i) {
      if (planes[i] == nullptr) continue;
      for (std::size_t k = 0; k < some.size(); ++k) {
        if (module.inputs[i].name == "prepass.near") planes[i][k] = some[k].near;
        if (module.inputs[i].name == "prepass.far") planes[i][k] = some[k].far;
      }
    }
  };
  plan.drain = [&](std::int64_t number, std::span<float* const> planes) {
    const auto some = part(number);
    for (std::size_t k = 0; k < some.size(); ++k) {
      some[k].near = planes[near_output_][k];
      some[k].far = planes[far_output_][k];
      if (count_output_ < module.outputs.size())
        counts[static_cast<std::size_t>(number)] += double(planes[count_output_][k]);
    }
  };
  const BatchEnd end = run_batches(program_, state, plan, status_);
  for (const double count : counts) evaluations_ += count;
  return end.end == RunEnd::finished;
}

}  // namespace pse::app
