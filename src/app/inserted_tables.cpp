// Reading tables, and from rows to planes of the picture. See the header.
#include "app/inserted_tables.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "app/input_images.h"
#include "image/sequence.h"

namespace pse::app {
namespace {

std::string prefix(const std::string& name) { return name.empty() ? "" : name + "."; }

// The column or component that has one of these names; null if there is none.
const std::vector<float>* column(const image::Image& rows, std::string_view name) {
  const int index = rows.spec.find(name);
  return index < 0 ? nullptr : &rows.planes[static_cast<std::size_t>(index)];
}

enum class Position { plane, unit, pixels, none };

Position position_of(const image::Image& rows) {
  const auto both = [&](std::string_view a, std::string_view b) {
    return column(rows, a) != nullptr && column(rows, b) != nullptr;
  };
  if (both("x", "y")) return Position::plane;
  if (both("u", "v")) return Position::unit;
  if (both("px", "py")) return Position::pixels;
  return Position::none;
}

using Matrix = std::array<double, 16>;

// The inverse by elimination; nothing for a matrix without one.
std::optional<Matrix> inverse(Matrix m) {
  Matrix r = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  const auto at = [](Matrix& a, std::size_t i, std::size_t j) -> double& { return a[4 * i + j]; };
  for (std::size_t c = 0; c < 4; ++c) {
    std::size_t best = c;
    for (std::size_t i = c; i < 4; ++i)
      if (std::fabs(at(m, i, c)) > std::fabs(at(m, best, c))) best = i;
    if (!(std::fabs(at(m, best, c)) > 1e-12)) return std::nullopt;
    for (std::size_t j = 0; j < 4; ++j) {
      std::swap(at(m, c, j), at(m, best, j));
      std::swap(at(r, c, j), at(r, best, j));
    }
    const double pivot = at(m, c, c);
    for (std::size_t j = 0; j < 4; ++j) at(m, c, j) /= pivot, at(r, c, j) /= pivot;
    for (std::size_t i = 0; i < 4; ++i) {
      if (i == c) continue;
      const double factor = at(m, i, c);
      for (std::size_t j = 0; j < 4; ++j) {
        at(m, i, j) -= factor * at(m, c, j);
        at(r, i, j) -= factor * at(r, c, j);
      }
    }
  }
  return r;
}

// Each row's place in the picture.
std::vector<image::Place> places_of(const image::Image& rows, const ImagePlane& plane) {
  const Position position = position_of(rows);
  const char* const names[] = {"x", "u", "px", "y", "v", "py"};
  const auto kind = static_cast<std::size_t>(position);
  const std::vector<float>& a = *column(rows, names[kind]);
  const std::vector<float>& b = *column(rows, names[kind + 3]);
  const std::vector<float>* z = column(rows, "z");
  const std::vector<float>* depth = column(rows, "depth");
  const std::vector<float>* size = column(rows, "size");
  std::optional<Matrix> to_plane;
  if (plane.transform && position == Position::plane) {
    to_plane = inverse(*plane.transform);
    if (!to_plane)
      throw Failure(Exit::usage, "with --insert, --xform needs a matrix that can be inverted");
  }

  std::vector<image::Place> places(a.size());
  const double half = plane.height / 2.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    image::Place& place = places[i];
    double x = a[i], y = b[i], height = z != nullptr ? (*z)[i] : 0;
    if (to_plane) {
      const Matrix& m = *to_plane;
      const auto line = [&](std::size_t k) {
        return m[4 * k] * x + m[4 * k + 1] * y + m[4 * k + 2] * height + m[4 * k + 3];
      };
      const double w = line(3), px = line(0) / w, py = line(1) / w;
      height = line(2) / w;
      x = px, y = py;
    }
    if (position == Position::plane) place = {plane.width / 2.0 + x * half, half - y * half};
    if (position == Position::unit) place = {x * plane.width, (1 - y) * plane.height};
    if (position == Position::pixels) place = {x, y};
    place.distance = depth != nullptr ? (*depth)[i] : -height;
    place.size = size != nullptr ? (*size)[i] : 1;
  }
  return places;
}

// One input of the module and the plane that feeds it.
struct TableFeed {
  std::size_t input;
  std::shared_ptr<const image::Splatted> table;
  const std::vector<float>* plane;
};

void fill(const TableFeed& feed, int width, int height, const TileView& tile) {
  float* out = tile.planes[feed.input];
  for (int y = tile.rect.y0; y < tile.rect.y1; ++y)
    for (int x = tile.rect.x0; x < tile.rect.x1; ++x) {
      const bool inside = x >= 0 && x < width && y >= 0 && y < height;
      *out++ = inside
                   ? (*feed.plane)[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                                   static_cast<std::size_t>(x)]
                   : 0.0f;
    }
}

}  // namespace

InsertedTables::InsertedTables(const RenderOptions& options, const Session& session)
    : rules_(options.rules) {
  read_.working = options.write.working;
  for (const ImageRequest& table : options.insertions)
    tables_.push_back({table.name, session.find_file(table.file), {}, {}, {}});
}

bool InsertedTables::vary() const {
  return std::any_of(tables_.begin(), tables_.end(),
                     [](const Table& table) { return image::is_pattern(table.pattern); });
}

void InsertedTables::open(int frame) {
  for (Table& table : tables_) {
    const auto file = image::frame_name(table.pattern, frame);
    if (!file) throw usage_error(file.error());
    if (table.file == *file) continue;
    auto rows = image::read_image(*file, read_);
    if (!rows) throw Failure(Exit::input, rows.error().message);
    table.file = *file;
    table.rows = std::move(*rows);
    table.layers = image::layers_of(table.rows.spec);
    if (position_of(table.rows) == Position::none) {
      std::vector<std::string> names;
      for (const image::Channel& channel : table.rows.spec.channels) names.push_back(channel.name);
      throw Failure(Exit::input,
                    fmt::format("{} does not say where its rows belong; its columns are {}", *file,
                                fmt::join(names, ", ")),
                    "call two of them x and y, u and v, or px and py");
    }
    for (std::size_t c = 0; c < table.rows.planes.size(); ++c) {
      const auto& values = table.rows.planes[c];
      const auto bad = std::find_if(values.begin(), values.end(),
                                    [](float value) { return !std::isfinite(value); });
      if (bad != values.end())
        throw Failure(Exit::input,
                      fmt::format("{}: `{}` of row {} is NaN or infinite", *file,
                                  table.rows.spec.channels[c].name, bad - values.begin() + 1));
    }
  }
  check_rules();
}

void InsertedTables::check_rules() const {
  for (const InsertRule& rule : rules_) {
    const bool known = std::any_of(tables_.begin(), tables_.end(), [&](const Table& table) {
      return rule.name == table.name ||
             std::any_of(table.layers.begin(), table.layers.end(), [&](const image::Layer& layer) {
               return rule.name == prefix(table.name) + layer.name;
             });
    });
    if (!known)
      throw usage_error(
          fmt::format("--rule {0}={1}: no inserted table brings `{0}`", rule.name, rule.rule_name));
  }
}

image::Rule InsertedTables::rule_of(const Table& table, const std::string& layer) const {
  image::Rule found = image::Rule::sum;
  // The column's own rule counts more than the table's, a later one more than an earlier.
  for (const InsertRule& rule : rules_)
    if (rule.name == table.name) found = rule.rule;
  for (const InsertRule& rule : rules_)
    if (rule.name == prefix(table.name) + layer) found = rule.rule;
  return found;
}

std::vector<StreamName> InsertedTables::names() const {
  std::vector<StreamName> names;
  for (const Table& table : tables_) {
    for (const image::Layer& layer : table.layers)
      names.push_back({prefix(table.name) + layer.name, layer.components(), ir::Rate::sample});
    names.push_back({prefix(table.name) + "coverage", 1, ir::Rate::sample});
  }
  return names;
}

std::vector<std::pair<std::string, std::string>> InsertedTables::identities() const {
  std::vector<std::pair<std::string, std::string>> all;
  for (const Table& table : tables_)
    all.emplace_back("insert " + table.name + "=" + table.file, file_identity(table.file));
  for (const InsertRule& rule : rules_) all.emplace_back("rule " + rule.name, rule.rule_name);
  return all;
}

TileSource InsertedTables::load(const ir::Module& module, const ImagePlane& plane) const {
  const auto find_input = [&](const std::string& name) -> std::optional<std::size_t> {
    for (std::size_t i = 0; i < module.inputs.size(); ++i)
      if (module.inputs[i].rate == ir::Rate::sample && module.inputs[i].name == name) return i;
    return std::nullopt;
  };
  auto feeds = std::make_shared<std::vector<TableFeed>>();
  for (const Table& table : tables_) {
    // The columns that the program reads.
    std::vector<image::SplatColumn> columns;
    std::vector<std::size_t> inputs;
    for (const image::Layer& layer : table.layers) {
      const std::string name = prefix(table.name) + layer.name;
      for (int c = 0; c < layer.components(); ++c) {
        const auto input =
            find_input(layer.components() == 1 ? name : fmt::format("{}.{}", name, c));
        if (!input) continue;
        inputs.push_back(*input);
        const auto channel = static_cast<std::size_t>(layer.channels[static_cast<std::size_t>(c)]);
        columns.push_back({table.rows.planes[channel], rule_of(table, layer.name)});
      }
    }
    const auto coverage = find_input(prefix(table.name) + "coverage");
    if (columns.empty() && !coverage) continue;
    const auto splatted = std::make_shared<const image::Splatted>(
        image::splat(places_of(table.rows, plane), columns, plane.width, plane.height));
    for (std::size_t i = 0; i < inputs.size(); ++i)
      feeds->push_back({inputs[i], splatted, &splatted->planes[i]});
    if (coverage) feeds->push_back({*coverage, splatted, &splatted->coverage});
  }
  return [feeds, width = plane.width, height = plane.height](const TileView& tile) {
    for (const TableFeed& feed : *feeds) fill(feed, width, height, tile);
  };
}

}  // namespace pse::app
