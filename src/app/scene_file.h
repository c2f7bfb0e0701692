// A scene as it is written: a TOML file beside the programs (docs/surfaces.md has the keys).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/knobs.h"
#include "surface/camera.h"
#include "surface/scene.h"
#include "surface/shape_words.h"

namespace pse::app {

// An object's place at time 0, and how it changes by the second.
struct Placement {
  surface::Vec3 at, turn, scale{1, 1, 1};  // turn: degrees about x, then y, then z
  surface::Vec3 move, spin;                // metres and degrees per second

  surface::Affine at_time(double seconds) const;
};

struct SceneObject {
  std::string name;
  surface::ShapeSpec shape;
  Placement placement;
  std::string program;  // as written; empty: the scene's, or the command line's
  std::vector<KnobSetting> knobs;
  int line = 0;
};

struct SceneCamera {
  surface::Camera camera;
  bool has_eye = false, has_target = false, has_fov = false;
  double orbit = 0;  // degrees per second round `up` through the target
};

struct SceneFile {
  std::string path;
  std::string program, background;  // as written; may be empty
  std::optional<SceneCamera> camera;
  std::vector<surface::Light> lights;
  bool has_lights = false;
  std::vector<SceneObject> objects;
};

// Throws Failure (input) with file and line.
SceneFile read_scene_file(const std::string& path);

// "eye=3,2,4 target=0,0,0 fov=35": the camera of the command line. Throws Failure (usage).
SceneCamera parse_camera(const std::string& words);

}  // namespace pse::app
