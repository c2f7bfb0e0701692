// The only place that knows toml++.
#include "app/toml_entries.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include "app/failure.h"

namespace pse::app {
namespace {

// The value as an option or a knob would be written on the command line; false where it is a table
// or a date.
bool add_element(const toml::node& node, TomlEntry& entry) {
  if (const auto* text = node.as_string()) {
    entry.is_text = true;
    entry.elements.push_back(text->get());
  } else if (const auto* flag = node.as_boolean()) {
    entry.is_boolean = true;
    entry.elements.emplace_back(flag->get() ? "true" : "false");
  } else if (const auto* whole = node.as_integer()) {
    entry.elements.push_back(fmt::format("{}", whole->get()));
  } else if (const auto* number = node.as_floating_point()) {
    entry.elements.push_back(fmt::format("{}", number->get()));
  } else {
    return false;
  }
  return true;
}

void add_entry(const std::string& table, std::string_view key, const toml::node& node,
               const std::string& name, std::vector<TomlEntry>& entries) {
  TomlEntry entry{
      .table = table, .key = std::string(key), .line = static_cast<int>(node.source().begin.line)};
  bool good = true;
  if (const auto* array = node.as_array()) {
    entry.is_array = true;
    for (const toml::node& element : *array) good = good && add_element(element, entry);
  } else {
    good = add_element(node, entry);
  }
  if (!good)
    throw usage_error(
        fmt::format("{}:{}: `{}` must be a number, a truth value, a text or a list of these", name,
                    entry.line, entry.key));
  entries.push_back(std::move(entry));
}

}  // namespace

std::vector<TomlEntry> read_toml(std::string_view text, const std::string& name) {
  std::vector<TomlEntry> entries;
  try {
    const toml::table root = toml::parse(text, name);
    for (const auto& [key, node] : root) {
      if (const auto* table = node.as_table()) {
        for (const auto& [inner, value] : *table)
          add_entry(std::string(key.str()), inner.str(), value, name, entries);
      } else {
        add_entry("", key.str(), node, name, entries);
      }
    }
  } catch (const toml::parse_error& error) {
    throw usage_error(fmt::format("{}:{}:{}: {}", name, error.source().begin.line,
                                  error.source().begin.column, error.description()));
  }
  return entries;
}

}  // namespace pse::app
