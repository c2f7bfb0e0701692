// Choosing channels. A format for display holds a picture; EXR holds everything.
#include "app/output_plan.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "diag/diagnostics.h"
#include "lower/scan.h"

namespace pse::app {
namespace {

std::string format_of(const OutputRequest& request, const image::WriteOptions& write) {
  if (request.file == "-") return write.format.empty() ? "exr" : write.format;
  const std::string format = image::format_of_name(request.file);
  return format.empty() ? write.format : format;
}

bool is_display(const OutputRequest& request, const image::WriteOptions& write) {
  return image::is_movie_name(request.file) ||
         image::is_display_format(format_of(request, write));
}

const ProgramOutput* find_output(const Program& program, const std::string& name) {
  const auto found = std::find_if(program.outputs.begin(), program.outputs.end(),
                                  [&](const ProgramOutput& output) { return output.name == name; });
  return found == program.outputs.end() ? nullptr : &*found;
}

const ProgramOutput& require_output(const Program& program, const std::string& name) {
  if (const ProgramOutput* output = find_output(program, name)) return *output;
  std::vector<std::string> names;
  for (const ProgramOutput& output : program.outputs) names.push_back(output.name);
  const std::string near = nearest_name(name, names);
  throw usage_error(fmt::format("the program sets no variable `{}`", name),
                    near.empty() ? fmt::format("it sets: {}", fmt::join(names, ", "))
                                 : fmt::format("did you mean `{}`?", near));
}

std::size_t module_output(const Program& program, const ProgramOutput& output, int component) {
  const std::string name =
      output.components == 1 ? output.name : fmt::format("{}.{}", output.name, component);
  const auto& outputs = program.module().outputs;
  const auto found = std::find_if(outputs.begin(), outputs.end(),
                                  [&](const ir::Output& o) { return o.name == name; });
  if (found == outputs.end()) throw std::logic_error("the module has no output " + name);
  return static_cast<std::size_t>(found - outputs.begin());
}

// The channels of a picture for display: colour or grey, and alpha.
void add_picture(PlannedFile& file, const Program& program, const ProgramOutput& output,
                 const ProgramOutput* alpha) {
  const char* const names[] = {"R", "G", "B", "A"};
  const auto add = [&](const char* name, const ProgramOutput& from, int component) {
    file.channels.push_back(
        {{name, image::PixelType::float32}, module_output(program, from, component)});
  };
  if (output.components == 1) {
    add("Y", output, 0);
  } else {
    for (int c = 0; c < 3; ++c) add(names[c], output, std::min(c, output.components - 1));
    if (output.components == 4) add("A", output, 3);
  }
  if (alpha != nullptr && alpha->components == 1 && output.components != 4) add("A", *alpha, 0);
  // Numbers that are not colours are shown as they are.
  if (output.name != "color" && !image::is_colour_name(output.name))
    file.write.tone = image::Tone::raw;
}

void add_layer(PlannedFile& file, const Program& program, const ProgramOutput& output,
               const RenderOptions& options) {
  image::StorageOptions storage;
  if (options.storage) storage = {*options.storage, *options.storage};
  for (const image::OutputChannel& channel :
       image::channels_of(output.name, output.components, storage))
    file.channels.push_back({channel.channel, module_output(program, output, channel.component)});
}

}  // namespace

std::vector<std::string> wanted_variables(const RenderOptions& options, const lang::Program& tree) {
  std::set<std::string> set_names;
  lower::collect_assigned(tree.body, set_names);
  std::vector<std::string> wanted;
  for (const OutputRequest& output : options.outputs) {
    if (!output.variables.empty())
      wanted.insert(wanted.end(), output.variables.begin(), output.variables.end());
    else if (is_display(output, options.write) && set_names.contains("color"))
      wanted.insert(wanted.end(), {"color", "alpha"});
    else
      return {};
  }
  // Names that the program does not set are reported once it is compiled.
  std::erase_if(wanted, [&](const std::string& name) { return !set_names.contains(name); });
  return wanted;
}

std::vector<PlannedFile> plan_outputs(const RenderOptions& options, const Program& program) {
  std::vector<PlannedFile> files;
  if (program.outputs.empty())
    throw Failure(Exit::program, "the program sets no variable, so there is nothing to write",
                  "set color");
  for (const OutputRequest& request : options.outputs) {
    PlannedFile file{request.file, options.write, {}};
    file.write.format = format_of(request, options.write);
    if (is_display(request, options.write)) {
      const ProgramOutput* color = find_output(program, "color");
      const ProgramOutput* alpha = find_output(program, "alpha");
      if (request.variables.empty()) {
        add_picture(file, program, color != nullptr ? *color : program.outputs.front(),
                    color != nullptr ? alpha : nullptr);
      } else {
        const ProgramOutput& first = require_output(program, request.variables.front());
        const bool with_alpha = request.variables.size() == 2 && request.variables[1] == "alpha";
        if (request.variables.size() > 1 && !with_alpha)
          throw usage_error(fmt::format("{} holds one picture, not {}", request.file,
                                        fmt::join(request.variables, ", ")),
                            "write them to an EXR file, or each to a file of its own");
        add_picture(file, program, first, with_alpha ? &require_output(program, "alpha") : nullptr);
      }
    } else if (request.variables.empty()) {
      for (const ProgramOutput& output : program.outputs) add_layer(file, program, output, options);
    } else {
      for (const std::string& name : request.variables)
        add_layer(file, program, require_output(program, name), options);
    }
    files.push_back(std::move(file));
  }
  return files;
}

}  // namespace pse::app
