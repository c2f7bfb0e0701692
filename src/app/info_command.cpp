// `pse info`: what is in a program, an image or a volume.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "app/knobs.h"
#include "app/program_file.h"
#include "app/report.h"
#include "app/stats.h"
#include "image/compare.h"
#include "passes/pipeline.h"
#include "volume/vdb.h"

namespace pse::app {
namespace {

using Json = nlohmann::ordered_json;

struct ProgramInfo {
  std::string name;
  std::vector<Knob> knobs;
  std::vector<ProgramOutput> outputs;
  std::vector<std::string> reads;
  OperationCounts operations;
};

ProgramInfo examine_program(const std::string& name, Session& session) {
  ProgramFile program = read_program(name, session);
  Diagnostics diagnostics;
  Lowered lowered = survey(program, module_host(program.path, session), diagnostics);
  if (diagnostics.has_errors()) report(diagnostics, program.sources, session);
  ProgramInfo info{program.sources.file(program.file).name,
                   std::move(lowered.knobs),
                   std::move(lowered.outputs),
                   std::move(lowered.reads),
                   {}};
  count_written("lower", lowered.module, info.operations);
  const passes::PipelineOptions pipeline{
      .optimize = true,
      .calls = std::move(lowered.calls),
      .after_pass = [&](std::string_view pass, const ir::Module& module) {
        count_written(pass, module, info.operations);
      }};
  count_compiled(passes::run_pipeline(std::move(lowered.module), pipeline), info.operations);
  return info;
}

std::string output_text(const ProgramOutput& output) {
  return output.components == 1 ? output.name
                                : fmt::format("{}[{}]", output.name, output.components);
}

std::string program_text(const ProgramInfo& info) {
  std::vector<std::string> sets;
  for (const ProgramOutput& output : info.outputs) sets.push_back(output_text(output));
  std::string out = fmt::format("{}: program\n", info.name);
  out +=
      fmt::format("  reads       {}\n",
                  info.reads.empty() ? "nothing" : fmt::format("{}", fmt::join(info.reads, " ")));
  out += fmt::format("  sets        {}\n",
                     sets.empty() ? "nothing" : fmt::format("{}", fmt::join(sets, " ")));
  out += operations_text(info.operations, "  ");
  return out + knob_help(info.knobs);
}

Json program_json(const ProgramInfo& info) {
  Json knobs = Json::array(), outputs = Json::array();
  for (const Knob& knob : info.knobs) {
    Json entry = {{"knob", knob.name}};
    if (knob.is_text())
      entry["value"] = knob.text;
    else if (knob.is_boolean)
      entry["value"] = knob.value.front() != 0;
    else if (knob.value.size() == 1)
      entry["value"] = knob.value.front();
    else
      entry["value"] = knob.value;
    if (knob.min) entry["min"] = *knob.min;
    if (knob.max) entry["max"] = *knob.max;
    for (const auto& [key, text] : {std::pair{"label", &knob.label},
                                    {"help", &knob.help},
                                    {"widget", &knob.widget},
                                    {"units", &knob.units},
                                    {"page", &knob.page}})
      if (!text->empty()) entry[key] = *text;
    if (!knob.options.empty()) entry["options"] = knob.options;
    knobs.push_back(std::move(entry));
  }
  for (const ProgramOutput& output : info.outputs)
    outputs.push_back({{"name", output.name}, {"components", output.components}});
  return {{"file", info.name},
          {"kind", "program"},
          {"reads", info.reads},
          {"sets", outputs},
          {"knobs", knobs},
          {"operations",
           {{"written",
             {{"constant", info.operations.written[0]},
              {"frame", info.operations.written[1]},
              {"sample", info.operations.written[2]}}},
            {"compiled", {{"frame", info.operations.frame}, {"sample", info.operations.sample}}}}}};
}

image::ImageSpec examine_image(const std::string& file) {
  const auto reader = image::open_reader(file);
  if (!reader) throw Failure(Exit::input, reader.error().message);
  return (*reader)->spec();
}

std::string image_text(const std::string& name, const image::ImageSpec& spec) {
  std::string out = fmt::format("{}: image\n", name);
  for (const auto& [heading, text] : image::describe(spec)) {
    // Texts of several lines stand below their heading.
    if (text.find('\n') == std::string::npos) {
      out += fmt::format("  {:<18}  {}\n", heading, text);
    } else {
      out += fmt::format("  {}\n", heading);
      for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        out += fmt::format("    {}\n", text.substr(at, end - at));
        at = end + 1;
      }
    }
  }
  return out;
}

Json image_json(const std::string& name, const image::ImageSpec& spec) {
  Json json = {{"file", name},
               {"kind", "image"},
               {"width", spec.display.width()},
               {"height", spec.display.height()}};
  for (const auto& [heading, text] : image::describe(spec)) json["about"][heading] = text;
  for (const image::Channel& channel : spec.channels)
    json["channels"].push_back({{"name", channel.name}, {"type", image::name_of(channel.type)}});
  for (const auto& [key, text] : spec.attributes) json["attributes"][key] = text;
  return json;
}

// A grid, and of those that can be read the side of a voxel and the range of the values.
struct GridFacts {
  volume::GridInfo head;
  double voxel = 0;
  std::optional<std::pair<float, float>> range;  // the background is one of the values
  bool has_nan = false;
  std::string unread;  // why its voxels cannot be read
};

template <class Value>
Value taken(volume::Result<Value> result) {
  if (!result) throw Failure(Exit::input, result.error().message);
  return std::move(*result);
}

std::vector<GridFacts> examine_volume(const std::string& file) {
  constexpr std::size_t limit = std::size_t{8} << 30;
  volume::Vdb* const vdb = taken(volume::open_vdb());
  std::vector<GridFacts> all;
  const std::vector<volume::GridInfo> heads = taken(vdb->info(file)).grids;
  for (auto one = heads.begin(); one != heads.end(); ++one) {
    const volume::GridInfo& head = *one;
    GridFacts facts{.head = head};
    if (head.components > 0) {
      // Of several grids of one name each has a number.
      const auto same = [&](const volume::GridInfo& other) { return other.name == head.name; };
      const bool shared = std::ranges::count_if(heads, same) > 1;
      const auto number = std::count_if(heads.begin(), one, same);
      const std::string name = shared ? fmt::format("{}[{}]", head.name, number) : head.name;
      const auto read = vdb->read(file, name, limit);
      // What is sound and of another kind is only told.
      if (!read && read.error().kind != volume::ErrorKind::damaged) {
        facts.unread = read.error().message;
        all.push_back(std::move(facts));
        continue;
      }
      const volume::GridData data = taken(read);
      facts.voxel = 1 / std::hypot(data.to_index[0], data.to_index[1], data.to_index[2]);
      std::pair<float, float> range{INFINITY, -INFINITY};
      for (const auto* values : {&data.voxels, &data.even})
        for (const float value : *values) {
          range = {std::fmin(range.first, value), std::fmax(range.second, value)};
          facts.has_nan = facts.has_nan || std::isnan(value);
        }
      if (range.first <= range.second) facts.range = range;
    }
    all.push_back(std::move(facts));
  }
  return all;
}

const char* class_of(const volume::GridInfo& grid) {
  if (grid.kind == volume::GridKind::fog) return "fog volume";
  return grid.kind == volume::GridKind::level_set ? "level set" : "data";
}

std::string volume_text(const std::string& name, const std::vector<GridFacts>& grids) {
  std::string out = fmt::format("{}: volume\n", name);
  if (grids.empty()) out += "  no grid\n";
  for (const auto& [head, voxel, range, has_nan, unread] : grids) {
    out += fmt::format("  {}: {}, {}\n", volume::shown_name(head.name), head.type, class_of(head));
    if (head.low[0] > head.high[0])
      out += "    voxels  none with values\n";
    else
      out += fmt::format("    voxels  {} with values, [{}] to [{}]\n", head.active,
                         fmt::join(head.low, " "), fmt::join(head.high, " "));
    if (voxel > 0) out += fmt::format("    side    {:.6g} m\n", voxel);
    if (range)
      out += fmt::format("    values  {:.6g} to {:.6g}{}\n", range->first, range->second,
                         has_nan ? ", and some that are NaN" : "");
    if (!unread.empty()) out += fmt::format("    unread  {}\n", unread);
  }
  return out;
}

Json volume_json(const std::string& name, const std::vector<GridFacts>& grids) {
  Json json = {{"file", name}, {"kind", "volume"}, {"grids", Json::array()}};
  for (const auto& [head, voxel, range, has_nan, unread] : grids) {
    Json grid = {{"name", head.name},     {"type", head.type}, {"class", class_of(head)},
                 {"active", head.active}, {"low", head.low},   {"high", head.high}};
    if (voxel > 0) grid["voxel"] = voxel;
    if (range) grid["range"] = {range->first, range->second};
    if (has_nan) grid["nan"] = true;
    if (!unread.empty()) grid["unread"] = unread;
    json["grids"].push_back(std::move(grid));
  }
  return json;
}

}  // namespace

Exit info_command(Session& session) {
  const auto& names = session.arguments.positionals;
  if (names.empty())
    throw usage_error("info needs a program, an image or a volume", "pse info FILE...");
  const bool as_json = session.arguments.has("json");
  Json all = Json::array();
  for (const std::string& name : names) {
    if (name.ends_with(".pse")) {
      const ProgramInfo info = examine_program(name, session);
      as_json ? all.push_back(program_json(info)) : session.console.print(program_text(info));
    } else if (name.ends_with(".vdb")) {
      const std::string file = session.find_file(name);
      const std::vector<GridFacts> grids = examine_volume(file);
      as_json ? all.push_back(volume_json(file, grids))
              : session.console.print(volume_text(file, grids));
    } else {
      const std::string file = session.find_file(name);
      const image::ImageSpec spec = examine_image(file);
      as_json ? all.push_back(image_json(file, spec))
              : session.console.print(image_text(file, spec));
    }
  }
  if (as_json)
    session.console.print(all.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  return Exit::ok;
}

}  // namespace pse::app
