// How a command ends: the exit statuses that users rely on, and the exception that carries one to
// the top.
#pragma once

#include <stdexcept>
#include <string>

namespace pse::app {

enum class Exit : int {
  ok = 0,
  running = 1,        // failed while running
  usage = 2,          // wrong arguments
  program = 3,        // the program has errors
  input = 4,          // an input could not be read
  output = 5,         // an output could not be written
  strict = 6,         // a strict check failed
  interrupted = 130,  // SIGINT
  terminated = 143,   // SIGTERM
};

// Ends the command with a message for the user. An empty message: everything has been said.
class Failure : public std::runtime_error {
 public:
  Failure(Exit exit, const std::string& message, std::string hint = {})
      : std::runtime_error(message), exit_(exit), hint_(std::move(hint)) {}
  Exit exit() const { return exit_; }
  const std::string& hint() const { return hint_; }  // what to do instead; may be empty

 private:
  Exit exit_;
  std::string hint_;
};

inline Failure usage_error(const std::string& message, std::string hint = {}) {
  return {Exit::usage, message, std::move(hint)};
}

}  // namespace pse::app
