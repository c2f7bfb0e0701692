// SIGINT and SIGTERM stop a job within 50 ms, SIGUSR1 asks for a snapshot. A thread of its own
// waits for them, so nothing happens inside a signal handler.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "stream/program.h"

namespace pse::app {

class Signals {
 public:
  // Blocks the signals for this thread and those it starts from now on; create it before any other
  // thread.
  Signals();
  ~Signals();
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;

  // While a run is watched, SIGINT and SIGTERM cancel it. It polls them everywhere, but a library
  // that packs a band of pixels or waits for the disk does not: where the process has not ended in
  // time, and at a second signal, it is ended as it stands. While no run is watched, they end it at
  // once. What is being written has no name yet then, so nothing half written remains.
  void watch(RunStatus* run);
  // What is said of a run that was stopped, once, whoever is first; empty: nothing.
  void set_last_words(std::string words);
  void say_last_words();
  // The signal that asked to stop, or 0.
  int stop_signal() const { return stop_signal_; }
  // Whether a snapshot was asked for since the last call.
  bool take_snapshot_request() { return snapshot_.exchange(false); }

 private:
  void wait(const std::stop_token& stop);
  void stop_run(int signal);
  [[noreturn]] void end(int signal);

  std::mutex mutex_;  // of run_ and last_words_
  RunStatus* run_ = nullptr;
  std::string last_words_;
  std::atomic<int> stop_signal_{0};
  std::atomic<bool> snapshot_{false};
  std::jthread thread_;
};

// The run that the signals may stop, for as long as this lives.
class SignalWatch {
 public:
  SignalWatch(Signals& signals, RunStatus& run) : signals_(signals) { signals_.watch(&run); }
  ~SignalWatch() { signals_.watch(nullptr); }
  SignalWatch(const SignalWatch&) = delete;
  SignalWatch& operator=(const SignalWatch&) = delete;

 private:
  Signals& signals_;
};

}  // namespace pse::app
