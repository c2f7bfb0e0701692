// Sorting samples by program, running each program on its own, and putting the results back.
#include "surface/shader.h"

#include <algorithm>
#include <utility>

#include "antialias/path.h"
#include "ir/reads.h"
#include "stream/planes.h"

namespace pse::surface {
namespace {

std::string component_name(const ProgramOutput& output, int component) {
  return output.components == 1 ? output.name : output.name + "." + std::to_string(component);
}

// Index of the entry called `name`, added where there is none.
template <class Entry>
std::size_t index_of(std::vector<Entry>& entries, const Entry& entry) {
  const auto found = std::find_if(entries.begin(), entries.end(),
                                  [&](const Entry& e) { return e.name == entry.name; });
  if (found != entries.end()) return static_cast<std::size_t>(found - entries.begin());
  entries.push_back(entry);
  return entries.size() - 1;
}

// The run that this thread works for, so that what a ray meets is stopped with it.
thread_local const RunStatus* current_run = nullptr;

class CurrentRun {
 public:
  explicit CurrentRun(const RunStatus& run) : before_(std::exchange(current_run, &run)) {}
  ~CurrentRun() { current_run = before_; }
  CurrentRun(const CurrentRun&) = delete;
  CurrentRun& operator=(const CurrentRun&) = delete;

 private:
  const RunStatus* before_;
};

// Samples side by side that one program shades.
struct Row {
  std::int64_t first, count;
};

// Short rows are copied here: a call costs as much as they do.
void copy_row(const float* from, std::int64_t count, float* to) {
  if (count >= 32) {
    std::copy_n(from, count, to);
    return;
  }
  for (std::int64_t i = 0; i < count; ++i) to[i] = from[i];
}

std::int64_t size_of(const std::vector<Row>& rows) {
  std::int64_t count = 0;
  for (const Row& row : rows) count += row.count;
  return count;
}

// The sample that is the `index`-th of all in the rows, or the last.
std::int64_t sample_at(const std::vector<Row>& rows, std::int64_t index) {
  for (const Row& row : rows) {
    if (index < row.count) return row.first + index;
    index -= row.count;
  }
  return rows.back().first + rows.back().count - 1;
}

}  // namespace

// What a thread keeps from one call of run_samples() to the next: fresh memory costs as much as
// tracing rays. A program that traces comes back to run_samples() within a call, and finds another.
struct Shader::Room {
  std::vector<std::vector<Row>> of_part;  // the samples that each program shades
  std::vector<bool> gathers, results_used;
  std::vector<const float*> in;
  std::vector<float*> out;
  Planes gathered, results;
  Scratch scratch;

  // A room for as long as it is held.
  class Held {
   public:
    Held() {
      if (unused.empty()) unused.push_back(std::make_unique<Room>());
      room_ = std::move(unused.back());
      unused.pop_back();
    }
    ~Held() { unused.push_back(std::move(room_)); }
    Held(const Held&) = delete;
    Held& operator=(const Held&) = delete;
    Room& operator*() const { return *room_; }

   private:
    std::unique_ptr<Room> room_;
    static thread_local std::vector<std::unique_ptr<Room>> unused;
  };
};
thread_local std::vector<std::unique_ptr<Shader::Room>> Shader::Room::Held::unused;

Shader::Shader(std::vector<std::shared_ptr<const Program>> programs, std::vector<int> program_of,
               Paths paths)
    : program_of_(std::move(program_of)),
      split_(std::make_shared<passes::SplitModule>()),
      paths_(paths) {
  for (auto& program : programs) parts_.push_back({std::move(program), {}, {}, false, 0});
  make_module();
}

void Shader::make_module() {
  ir::Module& module = split_->module;
  module.functions.resize(2);
  split_->frame = 1;

  // What is set: a number that another program sets as a vector goes into all its components.
  for (Part& part : parts_)
    for (const ProgramOutput& output : part.program->outputs) {
      ProgramOutput& joined = outputs_[index_of(outputs_, output)];
      joined.components = std::max(joined.components, output.components);
    }
  const std::size_t alpha = index_of(outputs_, ProgramOutput{"alpha", 1, {}});
  std::vector<std::size_t> first(outputs_.size());
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    first[i] = module.outputs.size();
    for (int c = 0; c < outputs_[i].components; ++c)
      module.outputs.push_back({component_name(outputs_[i], c)});
    if (outputs_[i].name == "color" || (outputs_[i].name == "colour" && !has_color_)) {
      has_color_ = true;
      for (std::size_t c = 0; c < 3; ++c)
        color_outputs_[c] = first[i] + std::min<std::size_t>(
                                           c, static_cast<std::size_t>(outputs_[i].components) - 1);
    }
  }
  alpha_output_ = first[alpha];
  path_output_ = module.outputs.size();
  const auto number_of = [](const Part& part, const char* name) {
    const auto& own = part.program->module().outputs;
    const auto found = std::ranges::find(own, name, &ir::Output::name);
    return found == own.end() ? none : static_cast<std::size_t>(found - own.begin());
  };
  const bool has_ends =
      paths_ == Paths::of_traced ||
      (paths_ == Paths::of_stored && std::ranges::any_of(parts_, [&](const Part& part) {
         return number_of(part, antialias::ends_name) != none;
       }));
  if (paths_ != Paths::none) module.outputs.push_back({antialias::path_name});
  if (has_ends) module.outputs.push_back({antialias::ends_name});
  const std::size_t fine_output = module.outputs.size();
  if (paths_ == Paths::of_traced && std::ranges::any_of(parts_, [&](const Part& part) {
        return number_of(part, antialias::fine_name) != none;
      }))
    module.outputs.push_back({antialias::fine_name});
  split_->first_slot = 0;

  // What is read, and where each program finds it.
  module.inputs.push_back({"id", ir::Rate::sample});
  if (paths_ == Paths::of_traced)
    depth_input_ = index_of(module.inputs, ir::Input{"depth", ir::Rate::sample});
  for (Part& part : parts_) {
    const ir::Module& own = part.program->module();
    const std::vector<bool> read = ir::inputs_read(own);
    for (std::size_t i = 0; i < own.inputs.size(); ++i) {
      const bool wanted = own.inputs[i].rate == ir::Rate::sample && read[i];
      part.input_of.push_back(wanted ? index_of(module.inputs, own.inputs[i]) : none);
    }
    part.outputs_of.resize(own.outputs.size());
    for (const ProgramOutput& output : part.program->outputs) {
      const std::size_t joined = index_of(outputs_, output);
      part.sets_alpha = part.sets_alpha || joined == alpha;
      for (int c = 0; c < outputs_[joined].components; ++c) {
        if (output.components > 1 && c >= output.components) break;
        const std::string name = component_name(output, output.components == 1 ? 0 : c);
        for (std::size_t o = 0; o < own.outputs.size(); ++o)
          if (own.outputs[o].name == name)
            part.outputs_of[o].push_back(first[joined] + static_cast<std::size_t>(c));
      }
    }
    if (const std::size_t path = number_of(part, antialias::path_name); path != none) {
      part.outputs_of[path].push_back(path_output_);
      const std::size_t ends = number_of(part, antialias::ends_name);
      if (ends != none) part.outputs_of[ends].push_back(path_output_ + 1);
      const std::size_t fine = number_of(part, antialias::fine_name);
      if (fine != none && fine_output < module.outputs.size())
        part.outputs_of[fine].push_back(fine_output);
    }
    part.first_check = static_cast<std::int32_t>(module.checks.size());
    module.checks.insert(module.checks.end(), own.checks.begin(), own.checks.end());
  }
  for (std::size_t c = 0; c < normal_inputs_.size(); ++c) {
    const auto found =
        std::ranges::find(module.inputs, "normal." + std::to_string(c), &ir::Input::name);
    if (found != module.inputs.end())
      normal_inputs_[c] = static_cast<std::size_t>(found - module.inputs.begin());
  }
}

std::shared_ptr<const Program> Shader::combined(std::shared_ptr<Shader> shader) {
  auto program = std::make_shared<Program>();
  program->outputs = shader->outputs_;
  program->split = shader->split_;
  for (const Part& part : shader->parts_) {
    for (const Knob& knob : part.program->knobs) index_of(program->knobs, knob);
    for (const std::string& name : part.program->reads)
      if (std::find(program->reads.begin(), program->reads.end(), name) == program->reads.end())
        program->reads.push_back(name);
    const CompileTimes& times = part.program->times;
    program->times.parse += times.parse, program->times.lower += times.lower;
    program->times.passes += times.passes, program->times.codegen += times.codegen;
    program->times.from_cache = times.from_cache;
  }
  program->kernel = std::move(shader);
  return program;
}

void Shader::begin_frame(std::vector<FrameState> states, std::shared_ptr<const Scene> scene,
                         const Lens& lens) {
  begin_frame(std::move(states));
  scene_ = std::move(scene);
  lens_ = std::make_unique<Lens>(lens);
  names_ = std::make_unique<NameWriter>(split_->module, scene_, lens);
}

void Shader::begin_frame(std::vector<FrameState> states) {
  states_ = std::move(states);
  ready_ = false;
}

int Shader::width() const { return parts_.empty() ? 1 : parts_.front().program->kernel->width(); }

TierSamples Shader::tier_samples() const {
  TierSamples sum;
  for (const Part& part : parts_) {
    const TierSamples runs = part.program->kernel->tier_samples();
    sum.first += runs.first;
    sum.optimised += runs.optimised;
  }
  return sum;
}

void Shader::run_frame(FrameState& state, RunStatus& status) const {
  const CurrentRun running(status);
  state.uniforms.resize(split_->module.inputs.size());
  for (std::size_t k = 0; k < parts_.size() && status.failed_check < 0; ++k) {
    parts_[k].program->kernel->run_frame(states_[k], status);
    if (status.failed_check >= 0) status.failed_check += parts_[k].first_check;
  }
  ready_ = true;
}

void Shader::run_samples(const FrameState&, RunStatus& status, Scratch&, const float* const* inputs,
                         float* const* outputs, std::int64_t count) const {
  const CurrentRun running(status);
  const float* ids = inputs[id_input_];
  const Room::Held held;
  Room& room = *held;
  if (room.of_part.size() < parts_.size()) room.of_part.resize(parts_.size());
  for (auto& rows : room.of_part) rows.clear();
  const auto last = static_cast<float>(program_of_.size() - 1);
  for (std::int64_t i = 0, end = 0; i < count; i = end) {
    const float id = ids[i];
    for (end = i + 1; end < count && ids[end] == id;) ++end;
    const int part = id >= 0 ? program_of_[static_cast<std::size_t>(std::min(id, last))] : -1;
    if (part >= 0) room.of_part[static_cast<std::size_t>(part)].push_back({i, end - i});
  }
  for (std::size_t o = 0; o < split_->module.outputs.size(); ++o)
    std::fill_n(outputs[o], count, 0.0f);
  for (std::size_t k = 0; k < parts_.size(); ++k)
    if (!room.of_part[k].empty()) run_part(k, status, inputs, outputs, count, room);
  if (paths_ == Paths::none) return;
  float* path = outputs[path_output_];
  for (std::int64_t i = 0; i < count; ++i) {
    const auto id = static_cast<std::uint32_t>(ids[i] * 0x9e3779p0f);
    path[i] = static_cast<float>((static_cast<std::uint32_t>(path[i]) + id) & 0xffffffu);
  }
  if (paths_ == Paths::of_traced && lens_ != nullptr)
    add_folds(inputs, outputs[path_output_ + 1], count);
}

// What jumps where an object hides a part of itself, or two parts of it meet. An end jumps by .05
// (antialias/neighbours.h).
void Shader::add_folds(const float* const* inputs, float* ends, std::int64_t count) const {
  constexpr float of_pixel = 0.015f;  // one pixel's width further away
  constexpr std::array<float, 3> of_normal = {0.12f, 0.09f, 0.07f};
  const float* depths = inputs[depth_input_];
  for (std::int64_t i = 0; i < count; ++i) ends[i] += of_pixel * lens_->depth_in_pixels(depths[i]);
  for (std::size_t c = 0; c < of_normal.size(); ++c) {
    if (normal_inputs_[c] == none) continue;
    const float* normals = inputs[normal_inputs_[c]];
    for (std::int64_t i = 0; i < count; ++i) ends[i] += of_normal[c] * normals[i];
  }
}

void Shader::run_part(std::size_t k, RunStatus& status, const float* const* inputs,
                      float* const* outputs, std::int64_t count, Room& room) const {
  const Part& part = parts_[k];
  const ir::Module& module = part.program->module();
  const std::vector<Row>& rows = room.of_part[k];
  const std::int64_t samples = size_of(rows);
  const bool all = samples == count;

  // Gather.
  room.gathers.assign(module.inputs.size(), false);
  for (std::size_t i = 0; i < room.gathers.size() && !all; ++i)
    room.gathers[i] = part.input_of[i] != none;
  room.gathered.arrange(room.gathers, samples);
  room.in.assign(module.inputs.size(), nullptr);
  for (std::size_t i = 0; i < room.in.size(); ++i) {
    if (part.input_of[i] == none) continue;
    const float* from = inputs[part.input_of[i]];
    room.in[i] = from;
    if (all) continue;
    float* to = room.gathered.pointers()[i];
    room.in[i] = to;
    for (const Row& row : rows) copy_row(from + row.first, row.count, to), to += row.count;
  }

  // Run.
  room.results_used.assign(module.outputs.size(), true);
  room.results.arrange(room.results_used, samples);
  part.program->kernel->run_samples(states_[k], status, room.scratch, room.in.data(),
                                    room.results.pointers().data(), samples);
  if (status.failed_check >= 0) {
    status.failed_check += part.first_check;
    status.failed_sample =
        static_cast<std::uint32_t>(sample_at(rows, std::int64_t{status.failed_sample}));
    return;
  }

  // Scatter.
  for (std::size_t o = 0; o < module.outputs.size(); ++o)
    for (const std::size_t to : part.outputs_of[o]) {
      const float* from = room.results.pointers()[o];
      for (const Row& row : rows)
        copy_row(from, row.count, outputs[to] + row.first), from += row.count;
    }
  if (!part.sets_alpha)
    for (const Row& row : rows) std::fill_n(outputs[alpha_output_] + row.first, row.count, 1.0f);
}

void Shader::radiance(std::span<const Ray> rays, double begin_width, float* const* rgba) const {
  thread_local int depth = 0;
  const std::size_t n = rays.size();
  for (int c = 0; c < 4; ++c) std::fill_n(rgba[c], n, 0.0f);
  if (!ready_ || !has_color_ || depth >= deepest) return;

  std::vector<Hit> hits(n);
  scene_->trace(rays, hits);
  std::vector<Sighting> sightings;
  std::vector<Ray> shown_rays;
  std::vector<Hit> shown;
  for (std::size_t i = 0; i < n; ++i) {
    if (!hits[i].found() && !shades_background()) continue;
    const double t = hits[i].found() ? hits[i].t() : 1;
    shown_rays.push_back(rays[i]), shown.push_back(hits[i]);
    sightings.push_back({static_cast<std::uint32_t>(i), begin_width + lens_->pixel_angle() * t, t});
  }
  const ir::Module& module = split_->module;
  const auto count = static_cast<std::int64_t>(n);
  const Planes inputs(std::vector<bool>(module.inputs.size(), true), count);
  names_->begin(n, inputs.pointers());
  names_->write(sightings, shown_rays, shown, inputs.pointers());
  const Planes outputs(std::vector<bool>(module.outputs.size(), true), count);
  RunStatus status{.outer = current_run};
  Scratch scratch;
  ++depth;
  run_samples({}, status, scratch, inputs.pointers().data(), outputs.pointers().data(), count);
  --depth;
  for (std::size_t c = 0; c < 4; ++c)
    std::copy_n(outputs.pointers()[c < 3 ? color_outputs_[c] : alpha_output_], n, rgba[c]);
}

}  // namespace pse::surface
