// A program run without a shell, fed through a pipe; what it says on its standard error is kept for
// messages.
#pragma once

#include <sys/types.h>

#include <span>
#include <string>
#include <vector>

#include "image/error.h"

namespace pse::image {

class Child {
 public:
  // Starts a program found on the PATH. The error names it when it does not exist.
  static Result<Child> start(const std::vector<std::string>& words);

  Child(Child&& other) noexcept;
  Child& operator=(Child&&) = delete;
  ~Child();  // ends the child when it was not waited for

  // False when the child has ended or closed its input.
  bool feed(std::span<const unsigned char> bytes);
  // Ends its input, waits for it, and tells whether it succeeded.
  bool finish();
  // The last lines that it said.
  std::string complaint() const;

 private:
  Child() = default;
  pid_t id_ = -1;
  int input_ = -1;
  int said_ = -1;
};

}  // namespace pse::image
