// A part of this program in a process of its own, for libraries that trust what files say of
// themselves: the means to talk to it and the limits it lives under. Both ends are the same
// program, so values go as they lie in memory.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>

namespace pse::side {

// All of it; false when the other end is gone.
inline bool put(int to, const void* data, std::size_t bytes) {
  const char* at = static_cast<const char*>(data);
  while (bytes > 0) {
    const ssize_t done = ::write(to, at, bytes);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return false;
    at += done, bytes -= static_cast<std::size_t>(done);
  }
  return true;
}

inline bool get(int from, void* data, std::size_t bytes) {
  char* at = static_cast<char*>(data);
  while (bytes > 0) {
    const ssize_t done = ::read(from, at, bytes);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return false;
    at += done, bytes -= static_cast<std::size_t>(done);
  }
  return true;
}

// A string or a vector of plain values.
template <class Values>
bool put_all(int to, const Values& values) {
  const std::uint64_t count = values.size();
  return put(to, &count, sizeof count) &&
         put(to, values.data(), count * sizeof(typename Values::value_type));
}

template <class Values>
bool get_all(int from, Values& values) {
  constexpr std::uint64_t most = std::uint64_t{1} << 30;
  std::uint64_t count = 0;
  if (!get(from, &count, sizeof count) || count > most) return false;
  values.resize(count);
  return get(from, values.data(), count * sizeof(typename Values::value_type));
}

// Called first in the new process. Of addresses: what is mapped already counts. It says nothing,
// and a signal to the whole group is for the process that it serves, with which it ends.
inline void settle(rlim_t most_memory, rlim_t most_seconds) {
  const auto limit = [](__rlimit_resource which, rlim_t most) {
    const rlimit value{most, most};
    ::setrlimit(which, &value);
  };
  limit(RLIMIT_AS, most_memory), limit(RLIMIT_CORE, 0), limit(RLIMIT_CPU, most_seconds);
  for (const int signal : {SIGABRT, SIGSEGV, SIGXCPU, SIGBUS, SIGFPE, SIGPIPE})
    ::signal(signal, SIG_DFL);
  for (const int signal : {SIGINT, SIGTERM, SIGUSR1}) ::signal(signal, SIG_IGN);
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  const int nowhere = ::open("/dev/null", O_RDWR);
  ::dup2(nowhere, STDIN_FILENO), ::dup2(nowhere, STDOUT_FILENO), ::dup2(nowhere, STDERR_FILENO);
}

}  // namespace pse::side
