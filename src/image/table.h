// Tables as images: a row is a pixel and a column is a channel, so a table of n rows is an image of
// n x 1 pixels, and all that can be done with an image can be done with it. 1985 paper, "Now
// What?": data bases are inserted into the image prior to pixel streaming.
//
// CSV: one line of column names, then a line of numbers for each row, divided by commas, semicolons
// or tabs (whichever the first line holds). Empty lines and lines that begin with # are left out;
// names may stand in quotes. `light.r,light.g,light.b` make the vector `light`, as for EXR.
//
// PLY: the points (element vertex) in ASCII or binary of either order. x y z keep their names; nx
// ny nz are normal.x .y .z; red green blue are color.r .g .b, decoded from sRGB where they are
// bytes; other properties keep their names.
#pragma once

#include "image/output_file.h"
#include "image/reader.h"
#include "image/writer.h"

namespace pse::image {

// A table's columns, all of the same length.
struct Columns {
  std::vector<std::string> names;
  std::vector<std::vector<float>> values;

  std::size_t rows() const { return values.empty() ? 0 : values.front().size(); }
  int find(std::string_view name) const;
};

bool is_ply(const ByteSource& bytes);
bool is_csv(const ByteSource& bytes);  // by the name's ending: .csv or .tsv

// What is wrong is said with its line or row: a row that is too long or too short, what is no
// number, NaN, no rows at all.
Result<Columns> read_csv(const ByteSource& bytes, const ReadLimits& limits);
Result<Columns> read_ply(const ByteSource& bytes, const ReadLimits& limits);

// Either as an image of rows x 1 pixels.
Result<std::unique_ptr<ImageReader>> open_table(const Bytes& bytes, const ReadOptions& options);

// Each pixel becomes a row, in reading order. The channel R is the column color.r, A alpha, Z Z;
// the only channel of a layer is a column of the layer's name.
Result<std::unique_ptr<ImageWriter>> open_csv_writer(const std::string& path, const ImageSpec& spec,
                                                     const WriteOptions& options);

}  // namespace pse::image
