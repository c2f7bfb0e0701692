// A part of this program in a process of its own, for libraries that trust what files say of
// themselves: the means to talk to it and the limits it lives under. Both ends are the same
// program, so values go as they lie in memory.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <fstream>

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

// `most`: values that are taken. Room for all that are announced is made when some of them have
// come; memory is used as they come.
template <class Values>
bool get_all(int from, Values& values, std::uint64_t most = std::uint64_t{1} << 30) {
  constexpr std::uint64_t some = std::uint64_t{1} << 20, piece = some / 16;
  std::uint64_t count = 0;
  if (!get(from, &count, sizeof count) || count > most) return false;
  values.clear();
  values.reserve(std::min(count, some));
  while (values.size() < count) {
    if (values.size() == some) values.reserve(count);
    const std::uint64_t have = values.size(), next = std::min(count, have + piece);
    values.resize(next);
    if (!get(from, values.data() + have, (next - have) * sizeof(typename Values::value_type)))
      return false;
  }
  return true;
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

// Bytes of addresses that this process has mapped: those that a limit of settle() counts from.
inline rlim_t mapped() {
  unsigned long long pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return static_cast<rlim_t>(pages) * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE));
}

// How a piece of work in a process of its own ended.
enum class Ended { whole, not_started, took_too_long, broke_down };

// Runs `work(pipe)` in a new process under these limits; true where it has sent all that it had to.
// `take(pipe)` receives it here and is true where all of it came; what it throws is thrown on.
template <class Work, class Take>
Ended run(rlim_t most_memory, rlim_t most_seconds, Work work, Take take) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return Ended::not_started;
  ::fcntl(ends[1], F_SETPIPE_SZ, 1 << 20);  // fewer turns; more of them where it is refused
  const pid_t served = ::getpid(), child = ::fork();
  if (child < 0) {
    ::close(ends[0]), ::close(ends[1]);
    return Ended::not_started;
  }
  if (child == 0) {
    // It ends with the thread that waits for it, and cannot wait for itself to read.
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != served) ::_exit(1);
    ::close(ends[0]);
    settle(most_memory, most_seconds);
    bool sent = false;
    try {
      sent = work(ends[1]);
    } catch (const std::exception&) {
    }
    ::_exit(sent ? 0 : 1);
  }
  ::close(ends[1]);
  const auto wait = [&] {
    ::close(ends[0]);
    int status = 0;
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    return status;
  };
  bool whole = false;
  try {
    whole = take(ends[0]);
  } catch (...) {
    wait();
    throw;
  }
  const int status = wait();
  if (whole) return Ended::whole;
  const bool stopped =
      WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL);
  return stopped ? Ended::took_too_long : Ended::broke_down;
}

}  // namespace pse::side
