// Where text goes: results to standard output, everything said to a person to standard error.
#pragma once

#include <atomic>
#include <cstdio>
#include <mutex>
#include <set>
#include <string>
#include <string_view>

#include "app/warnings.h"

namespace pse::app {

class Console {
 public:
  Console(std::FILE* out, std::FILE* err);

  // A result, as it is.
  void print(std::string_view text);
  // Said to a person, a line each. `note` is silent when quiet.
  void note(std::string_view line);
  // The one door of warnings that are no diagnostics: hidden where -W hides `code`, else counted,
  // and the same line said once.
  void warning(std::string_view code, std::string_view line);
  void error(std::string_view line, std::string_view hint = {});
  // Text that already has its lines and colours, such as diagnostics.
  void raw_error(std::string_view text);
  // Replaces the terminal's current line; an empty text clears it.
  void status_line(std::string_view text);

  void set_quiet(bool quiet) { quiet_ = quiet; }
  void set_warnings(WarningPolicy policy) { warnings_ = std::move(policy); }
  const WarningPolicy& warnings() const { return warnings_; }
  // Remembers that a warning was shown, so that -Werror ends the command with exit 6.
  void count_warning() { warned_ = true; }
  bool strict_failure() const { return warned_ && warnings_.are_errors; }
  bool error_is_terminal() const { return error_is_terminal_; }
  bool colour() const { return colour_; }
  // Writes out what is buffered; false where standard output did not take everything.
  bool flush();

 private:
  void say(std::string_view head, std::string_view colour, std::string_view line);

  std::FILE* out_;
  std::FILE* err_;
  bool error_is_terminal_;
  bool colour_;
  bool quiet_ = false;
  WarningPolicy warnings_;
  std::atomic<bool> warned_ = false;
  std::set<std::string> said_;  // warnings
  bool status_shown_ = false;
  std::mutex mutex_;
};

// Bytes for a person: "1.5 MiB".
std::string human_bytes(double bytes);
// Seconds for a person: "0.12 s", "3 min 20 s".
std::string human_seconds(double seconds);

}  // namespace pse::app
