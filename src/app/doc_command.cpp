// `pse doc`: what builtins, library functions and the plane's variables are. The texts stand where
// the things are defined: in the table of builtins, above the functions of library/, and in
// doc_entries.cpp for the rest.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "app/doc_entries.h"
#include "app/help.h"
#include "app/session.h"
#include "app/text_file.h"
#include "diag/diagnostics.h"
#include "lower/builtins.h"
#include "lower/library.h"

namespace pse::app {
namespace {

// The comment lines directly above line `end` of a text, joined to one paragraph.
std::string comment_above(std::string_view text, std::size_t end) {
  std::string comment;
  while (end > 0) {
    const std::size_t before = text.rfind('\n', end - 2);
    const std::size_t start = end < 2 || before == std::string_view::npos ? 0 : before + 1;
    std::string_view line = text.substr(start, end - start);
    if (!line.starts_with('#')) break;
    line.remove_prefix(line.starts_with("# ") ? 2 : 1);
    while (!line.empty() && line.back() <= ' ') line.remove_suffix(1);
    comment = comment.empty() ? std::string(line) : std::string(line) + " " + comment;
    end = start;
  }
  return comment;
}

// "name(a, b = 2)" at the start of a text, on one line however it is written.
std::string signature_at(std::string_view text) {
  std::string signature;
  int depth = 0;
  for (const char letter : text) {
    if (letter == '(') ++depth;
    const bool space = letter == ' ' || letter == '\n';
    if (!space) signature += letter;
    if (space && !signature.empty() && signature.back() != ' ' && signature.back() != '(')
      signature += ' ';
    if (letter == ')' && --depth == 0) break;
  }
  if (const std::size_t end = signature.rfind(" )"); end != std::string::npos)
    signature.erase(end, 1);
  return signature;
}

void add_functions(std::string_view text, const std::string& home, std::vector<DocEntry>& entries) {
  constexpr std::string_view word = "function ";
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    std::string_view line = text.substr(at, end - at);
    if (line.starts_with(word)) {
      const std::string signature = signature_at(text.substr(at + word.size()));
      entries.push_back(
          {signature.substr(0, signature.find('(')), signature, comment_above(text, at), home});
    }
    at = end + 1;
  }
}

std::vector<DocEntry> all_entries(const Session& session) {
  std::vector<DocEntry> entries(told_entries().begin(), told_entries().end());
  for (const Builtin& builtin : builtins()) {
    std::string text(builtin.doc);
    if (text.empty() && !builtin.same_as.empty())
      text = fmt::format("the same as {}", builtin.same_as);
    entries.push_back({std::string(builtin.name),
                       fmt::format("{}({})", builtin.name, builtin.parameters), text,
                       fmt::format("builtin, {}", builtin.group)});
  }
  for (const LibraryFile& file : library_files())
    add_functions(file.text, fmt::format("library/{}.pse", file.name), entries);
  // Modules of the user.
  for (const std::filesystem::path& folder : session.search_path()) {
    std::error_code error;
    for (const auto& file : std::filesystem::directory_iterator(folder, error))
      if (file.path().extension() == ".pse")
        add_functions(read_text_file(file.path().string()), file.path().string(), entries);
  }
  return entries;
}

std::string overview(const std::vector<DocEntry>& entries) {
  std::map<std::string, std::vector<std::string>> homes;
  for (const DocEntry& entry : entries) homes[entry.home].push_back(entry.name);
  std::string out;
  for (const auto& [home, names] : homes)
    out += fmt::format("{}\n{}\n", home, wrap(fmt::format("{}", fmt::join(names, " ")), 2));
  return out + "`pse doc NAME` explains one of them.\n";
}

}  // namespace

Exit doc_command(Session& session) {
  const std::vector<DocEntry> entries = all_entries(session);
  const auto& names = session.arguments.positionals;
  const bool json = session.arguments.has("json");

  // The entries asked for.
  std::vector<DocEntry> chosen;
  for (const std::string& name : names) {
    const std::size_t before = chosen.size();
    std::copy_if(entries.begin(), entries.end(), std::back_inserter(chosen),
                 [&](const DocEntry& e) { return e.name == name; });
    if (chosen.size() > before) continue;
    std::vector<std::string> known;
    for (const DocEntry& entry : entries) known.push_back(entry.name);
    const std::string near = nearest_name(name, known);
    throw usage_error(
        fmt::format("there is no function or variable `{}`", name),
        near.empty() ? "`pse doc --list` lists them" : fmt::format("did you mean `{}`?", near));
  }
  const std::vector<DocEntry>& shown = names.empty() ? entries : chosen;

  if (json) {
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const DocEntry& e : shown)
      all.push_back(
          {{"name", e.name}, {"signature", e.signature}, {"text", e.text}, {"home", e.home}});
    session.console.print(all.dump(2) + "\n");
  } else if (session.arguments.has("list")) {
    for (const DocEntry& e : shown) session.console.print(e.name + "\n");
  } else if (names.empty()) {
    session.console.print(overview(entries));
  } else {
    for (const DocEntry& e : shown)
      session.console.print(wrap(fmt::format("{}  ({})", e.signature, e.home), 0) +
                            wrap(e.text, 4));
  }
  return Exit::ok;
}

}  // namespace pse::app
