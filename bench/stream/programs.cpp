// fork, exec and wait4, which tells the peak of the child alone.
#include "programs.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>

namespace pse::bench {

pid_t start_pse(const std::vector<std::string>& arguments, const std::filesystem::path& folder) {
  std::vector<std::string> words = {PSE_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  // Standard output is a pipe where somebody would read it, if anybody did.
  int ends[2] = {-1, -1};
  if (!folder.empty() && pipe2(ends, O_CLOEXEC) != 0) return -1;
  const pid_t child = vfork();
  if (child == 0) {
    const int nothing = open("/dev/null", O_RDWR);
    if (dup2(nothing, 0) < 0 || dup2(folder.empty() ? nothing : ends[1], 1) < 0 ||
        dup2(nothing, 2) < 0 || (!folder.empty() && chdir(folder.c_str()) != 0))
      _exit(99);
    execv(argv[0], argv.data());
    _exit(98);
  }
  if (ends[1] >= 0) close(ends[1]);  // the other stays, as the reader that does not read
  return child;
}

Measured run_pse(const std::vector<std::string>& arguments) {
  const auto start = std::chrono::steady_clock::now();
  const pid_t child = start_pse(arguments);
  int status = 0;
  rusage usage{};
  wait4(child, &status, 0, &usage);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
          std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
          static_cast<double>(usage.ru_maxrss) / 1024};
}

}  // namespace pse::bench
