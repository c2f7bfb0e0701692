// The commands of pse with their options, in the order in which help shows them.
#include "app/option_table.h"

#include <algorithm>
#include <array>

namespace pse::app {
namespace {

using enum Takes;

// Options that several commands share.
const OptionSpec help = {"h", "help", nothing, "", "show this help; with a program also its knobs"};
const OptionSpec quiet = {"q", "quiet", nothing, "", "say nothing but warnings and errors"};
const OptionSpec include = {
    "I", "include",       many, "DIR", "look for modules and files here too, before PSE_PATH",
    {},  Offer::directory};
const OptionSpec define = {
    "D", "define", many, "Name=VALUE", "set a knob; the same as Name=VALUE alone", {}, Offer::knob};
const OptionSpec warn = {
    "W", "warn", many, "WHICH",
    "`error` makes warnings errors (exit 6), `no-NAME` hides those called NAME, `none` hides all"};
const OptionSpec json = {"", "json", nothing, "", "print JSON instead of text"};
const OptionSpec threads = {
    "t", "threads", one, "N", "threads to compute with; 0: all", {}, Offer::nothing, "PSE_THREADS"};

std::vector<OptionSpec> render_options() {
  return {
      {"o",
       "output",
       many,
       "FILE",
       "the picture to write: .exr .png .mp4 and others, `-` for standard output; NAME=FILE writes "
       "the variable NAME "
       "(or NAME,NAME...); may be given several times",
       {},
       Offer::image},
      {"f",
       "frames",
       one,
       "LIST",
       "frames to compute: 1-100, 1-100x5, 1,5,9, -10--1",
       {},
       Offer::nothing,
       "PSE_FRAMES"},
      threads,
      {"",
       "res",
       one,
       "WxH",
       "size of the picture in pixels; default: that of the first image, else 512x512",
       {},
       Offer::nothing,
       "PSE_RES"},
      {"",
       "clip",
       one,
       "X0,Y0,X1,Y1",
       "compute only these pixels of the picture, X1 and Y1 excluded",
       {},
       Offer::nothing,
       "PSE_CLIP"},
      {"",
       "xform",
       one,
       "NUMBERS",
       "matrix from the picture's plane to `point`: 6, 9 or 16 numbers, row by row",
       {},
       Offer::nothing,
       "PSE_XFORM"},
      {"",
       "on",
       one,
       "SHAPE",
       "run the program on the visible surface of a shape (sphere, torus, box, plane, superquadric, "
       "vase, revolution; `torus minor=0.2` sets it up) or of a mesh (.obj .ply .gltf .glb)",
       {},
       Offer::file},
      {"",
       "scene",
       one,
       "FILE",
       "run programs on the objects of a scene, a TOML file; PROGRAM is for those that name none. "
       "PROGRAM may also be a scene itself",
       {},
       Offer::file},
      {"",
       "camera",
       one,
       "WORDS",
       "with --on or --scene: eye=X,Y,Z target=X,Y,Z fov=DEGREES; default: all objects in view"},
      {"",
       "slice",
       one,
       "AXIS=PLACE",
       "show the density on a plane: --slice z=0, x=0.2 and so on; for function density(p)"},
      {"",
       "prepass",
       one,
       "N",
       "look for matter at one of N pixels and steps first and compute only where it is; for "
       "programs that set `span = raymarch_interval(...)`"},
      {"",
       "prepass-image",
       one,
       "FILE",
       "keep what the prepass found: an EXR with the channels near and far",
       {},
       Offer::image},
      {"", "seed", one, "N", "value of the variable `seed`", {}, Offer::nothing, "PSE_SEED"},
      {"", "fps", one, "RATE", "frames per second; default 24", {}, Offer::nothing, "PSE_FPS"},
      {"",
       "insert",
       many,
       "[NAME=]FILE",
       "spread the rows of a table (.csv, .tsv, .ply, or any image) over the picture; the program "
       "reads its columns as NAME.column",
       {},
       Offer::file},
      {"",
       "rule",
       many,
       "NAME=RULE",
       "how rows that meet in a pixel become its value, for an inserted table or one of its columns: "
       "sum (the default), max, mean, nearest"},
      define,
      {"",
       "params",
       many,
       "FILE",
       "set knobs from a file: TOML, or lines of `Name value`",
       {},
       Offer::file},
      include,
      {"", "layers", one, "NAMES", "write only these variables, separated by commas"},
      {"",
       "format",
       one,
       "NAME",
       "format of a picture whose name does not say it; on standard output default exr",
       {"exr", "png"}},
      {"", "half", nothing, "", "EXR: store every channel in 16 bits"},
      {"", "float", nothing, "", "EXR: store every channel in 32 bits"},
      {"", "bits", one, "N", "PNG: bits of a channel; default 8", {"8", "16"}},
      {"",
       "compression",
       one,
       "NAME",
       "EXR: how to compress; default zip",
       {"none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"}},
      {"", "tiled", nothing, "", "EXR: store tiles instead of scan lines"},
      {"",
       "colorspace",
       one,
       "NAME",
       "the space of the program's colours; default lin_rec709",
       {"lin_rec709", "acescg"}},
      {"",
       "display",
       one,
       "NAME",
       "transform to the screen for PNG, JPEG and MP4: `srgb`, `filmic` or `none`; `ocio` is the "
       "usual display of the configuration that $OCIO names, and any other name one of its displays. "
       "Default srgb"},
      {"", "view", one, "NAME", "a view of that display in $OCIO's configuration; default its first"},
      {"",
       "nan",
       one,
       "POLICY",
       "what to do with NaN and infinity in a result; default keep, with a warning",
       {"keep", "black", "box3", "error"}},
      {"", "resume", nothing, "", "skip frames whose file was made by the same recipe"},
      {"", "no-provenance", nothing, "", "do not store program, knobs and frame in the picture"},
      warn,
      {"",
       "antialias",
       one,
       "HOW",
       "clean edges: `procedural` finds them in the program and takes more samples only where they "
       "cross; `supersample=N` takes N samples in every pixel; `none` one. Default procedural",
       {},
       Offer::nothing,
       "PSE_ANTIALIAS"},
      {"", "samples", one, "N", "the same as --antialias supersample=N"},
      {"",
       "filter",
       one,
       "NAME",
       "the pixel's kernel: `cubic` (the chapter's), `box`, `disc`, `cone`, `paraboloid`, `gauss`; "
       "NAME*WIDTH widens it. Default cubic"},
      {"", "tile", one, "N", "side of the tiles that threads work on, in pixels; default 64"},
      {"",
       "width",
       one,
       "N",
       "samples per vector instruction; 0: the best for this processor",
       {"0", "1", "4", "8", "16", "32"}},
      {"",
       "tier",
       one,
       "TIER",
       "which compiled code draws: `first`, made at once; `optimised`, by LLVM; `auto`: the first "
       "until the other is ready. All give the same picture. Default auto",
       {"auto", "first", "optimised"},
       Offer::nothing,
       "PSE_TIER"},
      {"", "interpret", nothing, "", "run by the reference interpreter instead of compiled code"},
      {"", "no-optimize", nothing, "", "leave out the optimising passes"},
      {"", "no-cache", nothing, "", "neither use nor keep compiled kernels on disk"},
      {"",
       "emit",
       one,
       "STAGE",
       "print a stage of the compiler on standard output and stop",
       {"tokens", "ast", "ir", "opt", "llvm", "asm"}},
      {"",
       "stats",
       optional,
       "FORMAT",
       "report times, operations by rate, and memory; `--stats=json` for JSON on standard output",
       {"text", "json"}},
      {"",
       "progress",
       one,
       "STYLE",
       "how to report progress; default bar on a terminal, else none",
       {"plain", "bar", "json", "none"}},
      quiet,
      help,
  };
}

std::vector<OptionSpec> bake_options() {
  // Options that mean what they mean to `pse render`.
  const auto shared = [](std::string_view name) {
    for (const OptionSpec& option : render_options())
      if (option.name == name) return option;
    return OptionSpec{};
  };
  return {
      {"o",
       "output",
       many,
       "FILE",
       "the file to write: NAME.vdb for a volume, a picture for a mesh's texture; NAMES=FILE writes "
       "the grids or variables NAMES, separated by commas",
       {},
       Offer::file},
      shared("frames"),
      threads,
      {"",
       "res",
       one,
       "N",
       "voxels along the longest side, or NxNxN along x, y and z; default 128. Of a texture N or "
       "WxH texels; default 2048"},
      {"", "samples", one, "N", "texture: samples in each texel, 1, 4, 9...; default 1"},
      {"",
       "dilate",
       one,
       "N",
       "texture: texels that colours reach beyond the edges of charts; default 16"},
      {"", "udim", one, "TILE", "texture: the tile to bake, 1001 and on, of a mesh with several"},
      {"",
       "bounds",
       one,
       "X0,Y0,Z0,X1,Y1,Z1",
       "the box, from its lowest to its highest corner, in metres; one number N: from -N to N; "
       "default 1"},
      {"", "up", one, "AXIS", "which axis of the file points up; default y", {"y", "z"}},
      {"", "half", nothing, "", "store 16 bits a number; the default"},
      {"", "float", nothing, "", "store 32 bits a number"},
      {"",
       "band",
       one,
       "N",
       "how far from the surface distances are kept, in voxels; default 3"},
      {"", "fit", nothing, "", "a mesh: move and scale it so that it is centred, its longest side 2"},
      {"", "memory", one, "MIB", "stop where the grids take more memory; default 8192"},
      shared("seed"),
      shared("fps"),
      define,
      shared("params"),
      include,
      {"",
       "nan",
       one,
       "POLICY",
       "what to do with NaN and infinity: store nothing there (black), with a warning, or end with "
       "exit 6 (error)",
       {"black", "error"}},
      shared("resume"),
      shared("no-provenance"),
      warn,
      shared("width"),
      shared("tier"),
      shared("interpret"),
      shared("no-optimize"),
      shared("no-cache"),
      shared("progress"),
      quiet,
      help,
  };
}

// Those of render that a traced picture has a use for.
std::vector<OptionSpec> trace_options() {
  constexpr std::array<std::string_view, 16> kept = {
      "output", "frames",   "threads", "res",           "clip", "camera", "fps",  "compression",
      "tiled",  "progress", "resume",  "no-provenance", "tile", "quiet",  "help", "include"};
  std::vector<OptionSpec> options;
  for (const OptionSpec& option : render_options())
    if (std::find(kept.begin(), kept.end(), option.name) != kept.end()) options.push_back(option);
  return options;
}

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
       "With a MESH (.obj .ply .gltf .glb) and a picture to write: runs PROGRAM at every texel of the "
       "mesh's texture coordinates, where it reads point, normal and uv as on a visible surface, and "
       "writes what it sets. As with --on the mesh is fitted; \"MESH fit=false\" keeps its size.\n"
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
