// The program `pse`. Everything it does is in the library beside it; see command_line.cpp.
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "app/session.h"
#include "codegen/kernel.h"

int main(int argc, char** argv) {
  // A reader that has gone away is an error of writing, not a reason to die.
  std::signal(SIGPIPE, SIG_IGN);
  pse::app::Console console(stdout, stderr);
  const int status =
      pse::app::run_command_line(std::vector<std::string>(argv + 1, argv + argc), console);
  // A picture that is done does not wait for a kernel that would have drawn it faster.
  if (pse::compiles_behind()) {
    std::fflush(nullptr);
    std::_Exit(status);
  }
  return status;
}
