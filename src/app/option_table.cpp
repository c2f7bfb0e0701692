// The commands of pse with their options, in the order in which help shows them.
#include "app/option_table.h"

#include <algorithm>
#include <array>

#include "app/picture_options.h"

namespace pse::app {
namespace {

using enum Takes;

using namespace options;

const std::vector<CommandSpec>& table() {
  static const std::vector<CommandSpec> all = {
      {"render",
       "PROGRAM [IMAGE...] [name=IMAGE...] [Name=VALUE...] -o FILE",
       "compute a picture or a sequence of pictures",
       "Runs PROGRAM at every pixel and writes what it sets. `-` reads the program, or an image, "
       "from standard input.\n"
       "\n"
       "The first IMAGE brings its channels as `color`, `alpha`, `Z` and so on; name=IMAGE brings "
       "them as `name.color`... "
       "Name=VALUE sets a knob of the program. A knob is taken from the program, the variable "
       "PSE_Name, the --params file "
       "or the command line; the later one wins.\n"
       "\n"
       "In the name of a sequence, %04d stands for the frame number in four digits, #### as well; "
       "a lone # is four digits.",
       Offer::program,
       render_options(),
       {{"pse render marble.pse -o marble.png", "a picture of 512 x 512 pixels"},
        {"pse render marble.pse --res 1920x1080 Scale=3 -o marble.exr",
         "another size and another value of a knob"},
        {"pse render fire.pse -f 1-100 -o fire.%04d.exr", "a sequence"},
        {"pse render fire.pse -f 1-100 -o fire.mp4", "a film"},
        {"pse render over.pse fg=ball.%04d.exr bg=sky.exr -f 1-3 -o out.%04d.exr", "compositing"},
        {"pse render a.pse -o - | pse render b.pse - -o b.png", "programs as filters"},
        {"pse render marble.pse --help", "the program's own knobs"}}},
      {"trace",
       "SCENE|SHAPE|MESH -o FILE.exr",
       "trace surfaces into a picture that programs are run on",
       "Writes where the surfaces of a scene, a shape or a mesh are: P, N, uv, id, Z and others as "
       "channels of an EXR file. `pse render PROGRAM FILE.exr` then shades them, as often as "
       "wanted, without tracing again.",
       Offer::file,
       trace_options(),
       {{"pse trace bunny.obj --res 1024x1024 -o bunny.exr", "a mesh"},
        {"pse trace scene.toml -o scene.exr", "a scene"},
        {"pse render marble.pse bunny.exr -o bunny.png", "shade it"}}},
      {"bake",
       "PROGRAM|MESH [MESH] [Name=VALUE...] -o FILE",
       "compute a volume, or the texture of a mesh",
       "With a MESH (.obj .ply .gltf .glb) and a picture to write: runs PROGRAM at every texel of "
       "the mesh's texture coordinates, where it reads point, normal and uv as on a visible "
       "surface, and writes what it sets. As with --on the mesh is fitted; \"MESH fit=false\" "
       "keeps its size.\n"
       "\n"
       "Otherwise a volume. "
       "Runs PROGRAM at every voxel of a box and writes the variables density, temperature, color "
       "and distance that it sets as grids of an OpenVDB file. In a program that sets none of them "
       "the functions of these names are called instead: `function density(p)` is enough.\n"
       "\n"
       "Matter is where density is above 0; what is empty takes no room. `temperature` is in "
       "kelvin. `distance` makes a level set: metres to a surface, negative inside.\n"
       "\n"
       "A MESH (OBJ, PLY, glTF) becomes the level set of its distances, `--band` voxels far, with "
       "--res voxels along its longest side.",
       Offer::program,
       bake_options(),
       {{"pse bake marble.pse spot.obj -o albedo.png --res 1024 --samples 4", "a texture"},
        {"pse bake cloud.pse -o cloud.vdb --res 200", "density, temperature and color"},
        {"pse bake fire.pse -f 1-100 -o fire.%04d.vdb --bounds -1,0,-1,1,3,1", "a sequence"},
        {"pse bake cloud.pse -o density=cloud.vdb --up z", "one grid, for a program with z up"}}},
      {"check",
       "PROGRAM... [IMAGE] [name=IMAGE...]",
       "report errors and warnings of programs",
       "Compiles each PROGRAM as far as its errors need and prints what it found. `-` is standard "
       "input. With images, "
       "programs may read the channels that these have; without, `color`, `alpha`, `Z` and "
       "name.channel of any name.",
       Offer::program,
       {json, warn, include, quiet, help},
       {{"pse check *.pse", "all programs here"},
        {"pse check fire.pse heat.exr", "with the image that the program reads"},
        {"pse check --json a.pse", "for an editor"}}},
      {"fmt",
       "PROGRAM...",
       "lay a program out in pse's one style",
       "Prints the formatted program, or rewrites the files in place. `-` is standard input.",
       Offer::program,
       {{"", "check", nothing, "", "change nothing; exit 6 where a file is not formatted"},
        {"i", "in-place", nothing, "", "rewrite the files"},
        quiet,
        help},
       {{"pse fmt -i *.pse", "format all programs here"},
        {"pse fmt --check *.pse", "for a script"}}},
      {"info",
       "FILE...",
       "tell what is in a program or an image",
       "For a program: what it reads and sets, its knobs, and how many operations are computed "
       "when compiling, once per frame and "
       "once per sample. For an image: size, channels, layers and provenance.",
       Offer::file,
       {json, include, quiet, help},
       {{"pse info marble.pse", ""}, {"pse info ball.0001.exr", ""}}},
      {"doc",
       "[NAME...]",
       "documentation of functions and variables",
       "Prints the documentation of builtin functions, of the library and of the variables that "
       "the image plane brings. "
       "Without a name: an overview.",
       Offer::nothing,
       {{"l", "list", nothing, "", "only the names, a line each"}, json, include, help},
       {{"pse doc Noise", ""}, {"pse doc --list", ""}}},
      {"diff",
       "IMAGE IMAGE",
       "compare two images",
       "Compares the channels that both have, pixel by pixel. Exit 0 where no difference is above "
       "the tolerance, else 6.",
       Offer::image,
       {{"", "tolerance", one, "X", "largest difference that counts as equal; default 0"},
        {"o",
         "output",
         one,
         "FILE",
         "write the absolute differences as an image",
         {},
         Offer::image},
        json,
        include,
        quiet,
        help},
       {{"pse diff a.exr b.exr --tolerance 1e-3", ""}}},
      {"completion",
       "bash|zsh|fish",
       "print a shell's completion script",
       "Prints the script. For bash: source <(pse completion bash). For zsh: save it as _pse in a "
       "folder of $fpath. For "
       "fish: save it as ~/.config/fish/completions/pse.fish.",
       Offer::nothing,
       {help},
       {{"source <(pse completion bash)", "in ~/.bashrc"}}},
      {"help",
       "[COMMAND]",
       "help on a command",
       "Prints what COMMAND --help prints; with --man its manual page in the format of man.",
       Offer::nothing,
       {{"", "man", nothing, "", "print a manual page"}, help},
       {{"pse help render", ""}, {"pse help --man render | man -l -", "read the manual page"}}},
      {"version",
       "",
       "print the version",
       "Prints the version of pse.",
       Offer::nothing,
       {help},
       {}},
  };
  return all;
}

constexpr std::array<std::pair<std::string_view, std::string_view>, 9> statuses = {{
    {"0", "all went well"},
    {"1", "the program failed while running"},
    {"2", "wrong arguments"},
    {"3", "the program has errors"},
    {"4", "an input could not be read"},
    {"5", "an output could not be written"},
    {"6", "a strict check failed: -Werror, fmt --check, diff, --nan error"},
    {"130", "interrupted (SIGINT)"},
    {"143", "terminated (SIGTERM)"},
}};

constexpr std::array<std::pair<std::string_view, std::string_view>, 7> variables = {{
    {"PSE_Name", "value of the knob `Name`"},
    {"PSE_PATH", "folders of modules and images, separated by colons"},
    {"XDG_CACHE_HOME", "compiled kernels are kept in its folder pse; default ~/.cache"},
    {"XDG_CONFIG_HOME",
     "pse/pse.toml is read there after pse.toml here and upward; default ~/.config"},
    {"NO_COLOR", "when set, no colours"},
    {"OCIO", "an OpenColorIO configuration, for --display and --view"},
    {"SOURCE_DATE_EPOCH", "the date of manual pages; no other file holds a time"},
}};

}  // namespace

std::span<const CommandSpec> commands() { return table(); }

const CommandSpec* find_command(std::string_view name) {
  const auto found =
      std::find_if(table().begin(), table().end(), [&](const auto& c) { return c.name == name; });
  return found == table().end() ? nullptr : &*found;
}

const OptionSpec* find_option(const CommandSpec& command, std::string_view name) {
  const auto found = std::find_if(command.options.begin(), command.options.end(),
                                  [&](const OptionSpec& option) { return option.name == name; });
  return found == command.options.end() ? nullptr : &*found;
}

std::span<const std::pair<std::string_view, std::string_view>> exit_statuses() { return statuses; }
std::span<const std::pair<std::string_view, std::string_view>> environment_variables() {
  return variables;
}

}  // namespace pse::app
