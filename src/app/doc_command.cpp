// `pse doc`: what builtins, library functions and the plane's variables are. The texts stand where
// the things are defined: in the table of builtins, above the functions of library/, and below for
// the variables.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "app/help.h"
#include "app/session.h"
#include "app/text_file.h"
#include "diag/diagnostics.h"
#include "lower/builtins.h"
#include "lower/library.h"

namespace pse::app {
namespace {

struct Entry {
  std::string name, signature, text;
  std::string home;  // "builtin, noise", "library/turbulence.pse", "variable"
};

// The variables of the image plane; image_plane.h defines them.
const std::vector<Entry>& variables() {
  static const std::vector<Entry> all = {
      {"x", "x",
       "to the right in the picture's plane: -aspect at its left edge, 0 in the middle, aspect at "
       "the right",
       "variable"},
      {"y", "y", "upward in the picture's plane: -1 at its bottom, 0 in the middle, 1 at the top",
       "variable"},
      {"u", "u", "across the picture: 0 at its left edge, 1 at the right", "variable"},
      {"v", "v", "up the picture: 0 at its bottom, 1 at the top", "variable"},
      {"point", "point", "the sample's place in space: [x y 0], moved by --xform", "variable"},
      {"px", "px", "column of the pixel, from 0 at the left; pixel centres are at .5", "variable"},
      {"py", "py", "row of the pixel, from 0 at the top; pixel centres are at .5", "variable"},
      {"frame", "frame", "number of the frame", "variable"},
      {"time", "time", "seconds: frame / fps", "variable"},
      {"fps", "fps", "frames per second", "variable"},
      {"width", "width", "pixels of a row of the picture", "variable"},
      {"height", "height", "pixels of a column of the picture", "variable"},
      {"aspect", "aspect", "width / height", "variable"},
      {"pixelsize", "pixelsize", "side of a pixel in the picture's plane: 2 / height", "variable"},
      {"pixel_freq", "pixel_freq",
       "the highest frequency that pixels can show, in cycles per unit: 0.5 / pixelsize",
       "variable"},
      {"seed", "seed", "the number given with --seed", "variable"},
      {"prepass", "prepass.near, prepass.far, prepass.step",
       "where a prepass found matter on the pixel's ray, and what step it looks with; for the marchers",
       "variable"},
      {"xform", "xform", "the 16 numbers of --xform, row by row", "variable"},
      {"begin_frame", "if begin_frame ...",
       "true where a frame begins: the block is computed once per frame", "variable"},
      {"place", "place", "the surface's place in the world (docs/surfaces.md); `point` is the same "
       "in the object's own frame", "variable of surfaces"},
      {"normal", "normal", "the surface's direction, of length 1, on the side of the eye",
       "variable of surfaces"},
      {"uv", "uv", "the surface's coordinates, v upward", "variable of surfaces"},
      {"id", "id", "number of the object, from 1", "variable of surfaces"},
      {"depth", "depth", "metres in front of the eye's plane", "variable of surfaces"},
      {"view", "view", "direction to the eye, of length 1", "variable of surfaces"},
      {"light_direction", "light_direction",
       "towards the light, of length 1; light2_direction is the second's", "variable of surfaces"},
      {"light_color", "light_color", "what arrives from the light", "variable of surfaces"},
      {"trace", "trace(origin, direction)",
       "what a ray meets first: its parts are .distance .place .point .normal .uv .id .backface",
       "rays, on surfaces"},
      {"radiance", "radiance(origin, direction)",
       "colour and alpha of what a ray meets, shaded by its own program", "rays, on surfaces"},
      {"visible", "visible(place, other_place)",
       "1 where nothing stands between two places, else 0", "rays, on surfaces"}};
  return all;
}

// The comment lines directly above line `end` of a text, joined to one paragraph.
std::string comment_above(std::string_view text, std::size_t end) {
  std::string comment;
  while (end > 0) {
    const std::size_t before = text.rfind('\n', end - 2);
    const std::size_t start = end < 2 || before == std::string_view::npos ? 0 : before + 1;
    std::string_view line = text.substr(start, end - start);
    if (!line.starts_with('#')) break;
    line.remove_prefix(line.starts_with("# ") ? 2 : 1);
    while (!line.empty() && line.back() <= ' ') line.remove_suffix(1);
    comment = comment.empty() ? std::string(line) : std::string(line) + " " + comment;
    end = start;
  }
  return comment;
}

void add_functions(std::string_view text, const std::string& home, std::vector<Entry>& entries) {
  constexpr std::string_view word = "function ";
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    std::string_view line = text.substr(at, end - at);
    if (line.starts_with(word)) {
      line.remove_prefix(word.size());
      const std::string_view signature = line.substr(0, std::min(line.rfind(')') + 1, line.size()));
      entries.push_back({std::string(signature.substr(0, signature.find('('))),
                         std::string(signature), comment_above(text, at), home});
    }
    at = end + 1;
  }
}

std::vector<Entry> all_entries(const Session& session) {
  std::vector<Entry> entries = variables();
  for (const Builtin& builtin : builtins()) {
    std::string text(builtin.doc);
    if (text.empty() && !builtin.same_as.empty())
      text = fmt::format("the same as {}", builtin.same_as);
    entries.push_back({std::string(builtin.name),
                       fmt::format("{}({})", builtin.name, builtin.parameters), text,
                       fmt::format("builtin, {}", builtin.group)});
  }
  for (const LibraryFile& file : library_files())
    add_functions(file.text, fmt::format("library/{}.pse", file.name), entries);
  // Modules of the user.
  for (const std::filesystem::path& folder : session.search_path()) {
    std::error_code error;
    for (const auto& file : std::filesystem::directory_iterator(folder, error))
      if (file.path().extension() == ".pse")
        add_functions(read_text_file(file.path().string()), file.path().string(), entries);
  }
  return entries;
}

std::string overview(const std::vector<Entry>& entries) {
  std::map<std::string, std::vector<std::string>> homes;
  for (const Entry& entry : entries) homes[entry.home].push_back(entry.name);
  std::string out;
  for (const auto& [home, names] : homes)
    out += fmt::format("{}\n{}\n", home, wrap(fmt::format("{}", fmt::join(names, " ")), 2));
  return out + "`pse doc NAME` explains one of them.\n";
}

}  // namespace

Exit doc_command(Session& session) {
  const std::vector<Entry> entries = all_entries(session);
  const auto& names = session.arguments.positionals;
  const bool json = session.arguments.has("json");

  // The entries asked for.
  std::vector<Entry> chosen;
  for (const std::string& name : names) {
    const std::size_t before = chosen.size();
    std::copy_if(entries.begin(), entries.end(), std::back_inserter(chosen),
                 [&](const Entry& e) { return e.name == name; });
    if (chosen.size() > before) continue;
    std::vector<std::string> known;
    for (const Entry& entry : entries) known.push_back(entry.name);
    const std::string near = nearest_name(name, known);
    throw usage_error(
        fmt::format("there is no function or variable `{}`", name),
        near.empty() ? "`pse doc --list` lists them" : fmt::format("did you mean `{}`?", near));
  }
  const std::vector<Entry>& shown = names.empty() ? entries : chosen;

  if (json) {
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const Entry& e : shown)
      all.push_back(
          {{"name", e.name}, {"signature", e.signature}, {"text", e.text}, {"home", e.home}});
    session.console.print(all.dump(2) + "\n");
  } else if (session.arguments.has("list")) {
    for (const Entry& e : shown) session.console.print(e.name + "\n");
  } else if (names.empty()) {
    session.console.print(overview(entries));
  } else {
    for (const Entry& e : shown)
      session.console.print(fmt::format("{}  ({})\n{}", e.signature, e.home, wrap(e.text, 4)));
  }
  return Exit::ok;
}

}  // namespace pse::app
