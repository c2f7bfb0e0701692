// One thread for each piece of work; a lock lets one of them work at a time.
#include "codegen/behind.h"

#include <condition_variable>
#include <cstdlib>
#include <mutex>
#include <thread>

#include "codegen/backend.h"
#include "codegen/kernel.h"

namespace pse {
namespace {

struct Behind {
  std::mutex turn;   // held by the one that works
  std::mutex mutex;  // of the rest
  std::condition_variable changed;
  int threads = 0;
  bool leaving = false;
};

// Never destroyed: threads may outlive whatever is.
Behind& behind() {
  static auto* const only = new Behind;
  return *only;
}

// What has not begun does not begin any more, the rest is waited for.
void finish() {
  Behind& b = behind();
  std::unique_lock lock(b.mutex);
  b.leaving = true;
  b.changed.wait(lock, [&] { return b.threads == 0; });
}

bool leaving() {
  const std::lock_guard lock(behind().mutex);
  return behind().leaving;
}

}  // namespace

void run_behind(std::function<void()> work) {
  Behind& b = behind();
  [[maybe_unused]] static const int registered = std::atexit(&finish);
  {
    const std::lock_guard lock(b.mutex);
    ++b.threads;
  }
  std::thread([&b, work = std::move(work)]() mutable {
    {
      const std::lock_guard turn(b.turn);
      // LLVM's own last deeds are done after this is finished: they were registered before.
      if (!leaving()) open_backend();
      [[maybe_unused]] static const int again = std::atexit(&finish);
      if (!leaving()) work();
      work = nullptr;
    }
    const std::lock_guard lock(b.mutex);
    --b.threads;
    b.changed.notify_all();
  }).detach();
}

bool compiles_behind() {
  Behind& b = behind();
  const std::lock_guard lock(b.mutex);
  return b.threads > 0;
}

}  // namespace pse
