// The thread that waits for signals.
#include "app/signals.h"

#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <time.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace pse::app {
namespace {

// From the signal to _exit(), at most. The system then takes 15 ms and more to tear down a process
// that writes a picture 16384 pixels wide.
constexpr long patience_ns = 25'000'000;

sigset_t watched_signals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : {SIGINT, SIGTERM, SIGUSR1}) sigaddset(&set, signal);
  return set;
}

}  // namespace

Signals::Signals() {
  const sigset_t set = watched_signals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  thread_ = std::jthread([this](const std::stop_token& stop) { wait(stop); });
}

Signals::~Signals() {
  thread_.request_stop();
  pthread_kill(thread_.native_handle(), SIGUSR1);  // wakes it
  thread_.join();
  const sigset_t set = watched_signals();
  pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
}

void Signals::watch(RunStatus* run) {
  const std::lock_guard lock(mutex_);
  run_ = run;
  if (run_ != nullptr && stop_signal_ != 0) run_->cancel = true;
}

void Signals::wait(const std::stop_token& stop) {
  const sigset_t set = watched_signals();
  const timespec patience{0, patience_ns};
  while (!stop.stop_requested()) {
    const int asked = stop_signal_;
    const int signal = asked != 0 ? sigtimedwait(&set, nullptr, &patience)
                                  : sigwaitinfo(&set, nullptr);
    if (stop.stop_requested()) return;
    if (asked != 0 && signal < 0 && errno == EAGAIN) end(asked);
    if (signal < 0) continue;
    if (signal == SIGUSR1)
      snapshot_ = true;
    else
      stop_run(signal);
  }
}

void Signals::stop_run(int signal) {
  {
    const std::lock_guard lock(mutex_);
    if (run_ != nullptr && stop_signal_ == 0) {
      stop_signal_ = signal;
      run_->cancel = true;
      return;
    }
  }
  end(signal);
}

void Signals::end(int signal) {
  say_last_words();
  _exit(128 + signal);
}

void Signals::set_last_words(std::string words) {
  const std::lock_guard lock(mutex_);
  last_words_ = std::move(words);
}

// Not through stdio, whose lock another thread may hold, and not where it would have to wait.
void Signals::say_last_words() {
  std::string words;
  {
    const std::lock_guard lock(mutex_);
    words = std::exchange(last_words_, {});
  }
  pollfd err{STDERR_FILENO, POLLOUT, 0};
  if (words.empty() || poll(&err, 1, 0) != 1 || (err.revents & POLLOUT) == 0) return;
  [[maybe_unused]] const auto written = write(STDERR_FILENO, words.data(), words.size());
}

}  // namespace pse::app
