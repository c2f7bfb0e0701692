// `--insert NAME=FILE`: tables whose rows are spread over the picture before the program runs; the
// program reads their columns at each pixel as the channels NAME.column. 1985 paper, "Now What?":
// "direct insertion of large data bases into the image prior to pixel streaming".
//
// A row's place is in its columns x y (the picture's plane), u v (0 to 1) or px py (pixels from the
// top left); what is nearest is said by `depth` (the least) or z (the greatest: z points to the
// viewer). With --xform, x y z are where the program's `point` is.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "app/render_options.h"
#include "image/layers.h"
#include "image/reader.h"
#include "image/splat.h"
#include "stream/executor.h"

namespace pse::app {

class InsertedTables {
 public:
  InsertedTables(const RenderOptions& options, const Session& session);

  // Reads each table's file of a frame. Throws Failure (input), also where a table has no place.
  void open(int frame);
  bool vary() const;
  // The channels that the open tables bring, with `coverage`.
  std::vector<StreamName> names() const;
  std::vector<std::pair<std::string, std::string>> identities() const;

  // Spreads the columns that the module reads over the whole picture.
  TileSource load(const ir::Module& module, const ImagePlane& plane) const;

 private:
  struct Table {
    std::string name, pattern, file;
    image::Image rows;  // any image: a pixel is a row
    std::vector<image::Layer> layers;
  };
  image::Rule rule_of(const Table& table, const std::string& layer) const;
  void check_rules() const;

  std::vector<Table> tables_;
  std::vector<InsertRule> rules_;
  image::ReadOptions read_;
};

}  // namespace pse::app
