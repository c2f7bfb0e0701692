// The images given on the command line as a source of samples: each layer is a named value at every
// pixel. The tables of --insert come with them.
#pragma once

#include <memory>
#include <optional>

#include "app/inserted_tables.h"
#include "app/render_options.h"
#include "image/layers.h"
#include "image/reader.h"
#include "image/row_bands.h"
#include "stream/executor.h"
#include "stream/sample_source.h"

namespace pse::app {

class InputImages {
 public:
  InputImages(const RenderOptions& options, const Session& session);

  // Opens each image's file for a frame and checks that their sizes agree. Throws Failure (input).
  void open(int frame);
  // Whether another frame needs other files.
  bool vary() const;

  // The names that the open images bring, those of the image without a name bare.
  std::vector<StreamName> names() const;
  // The frame of the pictures in file coordinates; the first image's. Nothing without images.
  std::optional<image::Window> display() const;
  // The image without a name, open for the frame.
  struct Bare {
    image::ImageReader& reader;
    const std::vector<image::Layer>& layers;
    const std::string& file;
  };
  std::optional<Bare> bare() const;
  // Names of the image without a name that somebody else brings.
  void hide(std::vector<std::string> names) { hidden_ = std::move(names); }

  // Where any of them has pixels, joined with the display window.
  std::optional<image::Window> data() const;
  // Files opened for this frame, with what tells one version of a file from another.
  std::vector<std::pair<std::string, std::string>> identities() const;

  // Gives what fills the channels that the module reads in, a band of rows at a time (RowBands), as
  // long as no other frame is opened. `picture_plane` is the picture, for inserted tables. Both
  // throw Failure (input).
  TileSource load(const ir::Module& module, const ImagePlane& picture_plane);

  // Whether a name is what a prepass has found, which is known between pixels too (span_places.h).
  static bool is_span(const StreamName& name);
  // `places` with what a prepass has found, where load() has read it; as long as no other frame is
  // opened. fill() throws Failure (input).
  std::unique_ptr<SampleSource> anywhere(const ir::Module& module,
                                         std::unique_ptr<SampleSource> places) const;

 private:
  struct Open {
    std::string name;     // of the variable
    std::string pattern;  // as found
    std::string file = {};  // of this frame
    std::unique_ptr<image::ImageReader> reader = nullptr;
    std::vector<image::Layer> layers = {};
    std::vector<int> channels = {};                    // that the program reads
    std::shared_ptr<image::RowBands> bands = nullptr;  // their pixels
    bool derived = false;
  };
  bool is_hidden(const Open& image, const image::Layer& layer) const;

  std::vector<Open> images_;
  InsertedTables tables_;
  std::vector<std::string> hidden_;
  image::ReadOptions read_;
};

// A file's size and time of change; "-" has none.
std::string file_identity(const std::string& file);

}  // namespace pse::app
