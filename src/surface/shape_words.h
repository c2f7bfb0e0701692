// Shapes by name and settings: `sphere`, `torus minor=0.3`, `bunny.obj`. What --on and a scene file
// say of an object's shape.
#pragma once

#include <expected>
#include <map>
#include <string>

#include "surface/mesh.h"
#include "surface/shapes.h"

namespace pse::surface {

struct Setting {
  std::string key;
  std::vector<double> numbers;
  std::string text;  // for messages, as written
  int line = 0;      // of a scene file
};

struct ShapeSpec {
  std::string shape;  // a name of shape_names() or a mesh's file
  std::vector<Setting> settings;
  int line = 0;
};

struct MadeShape {
  std::shared_ptr<const Shape> shape;
  std::vector<std::string> notes;  // what a mesh's reading left out
};

struct ShapeError {
  std::string message, hint;
  int line = 0;        // of the setting at fault
  bool usage = false;  // the words are wrong; else a file is
};

// "torus minor=0.3" taken apart; numbers of a list are divided by commas.
std::expected<ShapeSpec, ShapeError> parse_shape(const std::string& words);
// "superquadric:north=2" as it is written, with a setting, in quotes; empty where no shape's name
// or mesh comes first.
std::string quoted_settings(const std::string& words);
bool has_setting(const std::string& shape, const std::string& key);
// The names of shapes, and their settings with what they are unless told.
std::vector<std::pair<std::string, std::string>> shape_names();
bool is_shape_name(const std::string& name);

// Whether the words name a program, whose isosurface is meant: `blob.pse level=0.5`.
bool is_field_name(const std::string& name);
std::expected<MadeShape, ShapeError> make_field_shape(const ShapeSpec& spec, Field field);

// `fit_meshes`: a mesh is centred and scaled to 2 metres unless told otherwise.
std::expected<MadeShape, ShapeError> make_shape(const ShapeSpec& spec, bool fit_meshes);

}  // namespace pse::surface
