// Reading programs and modules.
#include "app/program_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "app/free_names.h"
#include "app/text_file.h"
#include "lang/parser.h"
#include "stream/image_plane.h"
#include "surface/surface_source.h"

namespace pse::app {

namespace fs = std::filesystem;

ProgramFile read_program(const std::string& name, const Session& session) {
  ProgramFile program;
  program.path = session.find_file(name);
  const std::string shown = program.path == "-" ? "<stdin>" : program.path;
  program.file = program.sources.add(shown, read_text_file(program.path));
  return program;
}

LowerHost module_host(const std::string& program_path, const Session& session) {
  std::vector<fs::path> folders = {program_path == "-" ? fs::path(".")
                                                       : fs::path(program_path).parent_path()};
  const std::vector<fs::path> more = session.search_path();
  folders.insert(folders.end(), more.begin(), more.end());

  LowerHost host;
  host.find_module = [folders](SourceMap& sources,
                               const std::string& name) -> std::optional<FileId> {
    for (const fs::path& folder : folders) {
      const fs::path file = folder / (name + ".pse");
      std::error_code error;
      if (fs::is_regular_file(file, error))
        return sources.add(file.string(), read_text_file(file.string()));
    }
    return std::nullopt;
  };
  // Without images at hand a texture counts as a colour.
  host.texture_components = [](const std::string&, const std::string& layer, std::string&) {
    return layer == "alpha" || layer == "Z" ? 1 : 3;
  };
  // Without volumes at hand a grid counts as a number, unless it is called as a colour is.
  host.volume_components = [](const std::string&, const std::string& grid, std::string&) {
    return grid == "color" || grid == "v" || grid == "velocity" ? 3 : 1;
  };
  host.texture_size = [](const std::string&, std::string&) { return std::pair(16, 16); };
  return host;
}

Lowered survey(ProgramFile& program, const LowerHost& host, Diagnostics& diagnostics,
               const std::vector<StreamName>& images) {
  const lang::Program tree = lang::parse(program.sources, program.file, diagnostics);
  LowerOptions options;
  // A tree with gaps is only lowered, not searched for names.
  options.stream = images.empty() && !diagnostics.has_errors() ? image_names_read(tree) : images;
  // Without a scene at hand a program may be meant for one with a few lights.
  if (images.empty())
    for (const StreamName& name : surface::surface_names(4)) options.stream.push_back(name);
  for (const StreamName& name : image_plane_names()) options.stream.push_back(name);
  if (diagnostics.has_errors()) {
    add_later_errors(program.sources, tree, host, options, diagnostics);
    return {};
  }
  return lower_program(program.sources, tree, host, options, diagnostics);
}

}  // namespace pse::app
