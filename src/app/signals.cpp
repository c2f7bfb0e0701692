// The thread that waits for signals.
#include "app/signals.h"

#include <pthread.h>
#include <signal.h>
#include <time.h>
#include <unistd.h>

namespace pse::app {
namespace {

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
  while (!stop.stop_requested()) {
    const int signal = sigwaitinfo(&set, nullptr);
    if (stop.stop_requested() || signal < 0) continue;
    if (signal == SIGUSR1)
      snapshot_ = true;
    else
      stop_run(signal);
  }
}

void Signals::stop_run(int signal) {
  const std::lock_guard lock(mutex_);
  if (run_ == nullptr || stop_signal_ != 0) _exit(128 + signal);
  stop_signal_ = signal;
  run_->cancel = true;
}

}  // namespace pse::app
