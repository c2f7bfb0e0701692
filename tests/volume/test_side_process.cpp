// Work in a process of its own: what it sends arrives whole, and whatever it does, this process
// goes on and learns how it ended.
#include <gtest/gtest.h>
#include <poll.h>

#include <cstdlib>
#include <numeric>
#include <vector>

#include "base/side_process.h"

namespace pse::side {
namespace {

constexpr rlim_t gibibyte = rlim_t{1} << 30;

// Runs `work` and receives numbers.
template <class Work>
Ended numbers_of(Work work, std::vector<int>& numbers, rlim_t seconds = 10) {
  return run(mapped() + gibibyte, seconds, work, [&](int pipe) { return get_all(pipe, numbers); });
}

TEST(SideProcess, SendsMoreThanAPipeHolds) {
  std::vector<int> sent(3'000'001), came;
  std::iota(sent.begin(), sent.end(), 7);
  EXPECT_EQ(numbers_of([&](int pipe) { return put_all(pipe, sent); }, came), Ended::whole);
  EXPECT_EQ(came, sent);
}

TEST(SideProcess, MayBreakDown) {
  std::vector<int> came;
  EXPECT_EQ(numbers_of([](int) -> bool { std::abort(); }, came), Ended::broke_down);
  EXPECT_EQ(numbers_of([](int) -> bool { throw std::bad_alloc(); }, came), Ended::broke_down);
}

// A count without the values: memory grows with what comes, so nothing is taken for what does not.
TEST(SideProcess, AnnouncedValuesThatDoNotComeTakeNoMemory) {
  std::vector<int> came;
  const auto work = [](int pipe) {
    const std::uint64_t count = std::uint64_t{1} << 29;
    return put(pipe, &count, sizeof count);
  };
  EXPECT_EQ(numbers_of(work, came), Ended::broke_down);
  EXPECT_LE(came.capacity(), std::size_t{1} << 20);
}

TEST(SideProcess, EndsWithItsTime) {
  std::vector<int> came;
  const auto work = [](int) {
    volatile bool goes_on = true;
    while (goes_on) {
    }
    return true;
  };
  EXPECT_EQ(numbers_of(work, came, 1), Ended::took_too_long);
}

// Who waits for a long read is killed: the reader ends at once, not when it has something to send.
TEST(SideProcess, EndsWithTheProcessThatItServes) {
  int alive[2];
  ASSERT_EQ(::pipe(alive), 0);
  const pid_t waiting = ::fork();
  if (waiting == 0) {
    ::close(alive[0]);
    std::vector<int> came;
    const auto work = [&](int) {
      const char started = 1;
      put(alive[1], &started, 1);
      while (true) ::pause();
      return true;
    };
    numbers_of(work, came);
    ::_exit(0);
  }
  ::close(alive[1]);
  char started = 0;
  ASSERT_TRUE(get(alive[0], &started, 1));
  ::kill(waiting, SIGKILL);
  ::waitpid(waiting, nullptr, 0);
  pollfd line{alive[0], POLLIN, 0};
  ASSERT_EQ(::poll(&line, 1, 10'000), 1) << "still there after ten seconds";
  EXPECT_FALSE(get(alive[0], &started, 1));
  ::close(alive[0]);
}

#if !defined(__SANITIZE_ADDRESS__)
TEST(SideProcess, HasOnlySoMuchMemory) {
  std::vector<int> came;
  const auto work = [](int pipe) {
    const std::vector<char> block(std::size_t{2} << 30);
    return put_all(pipe, std::vector<int>{block[0]});
  };
  EXPECT_EQ(numbers_of(work, came), Ended::broke_down);
}
#endif

}  // namespace
}  // namespace pse::side
