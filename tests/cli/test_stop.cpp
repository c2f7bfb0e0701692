// Signals reach a job wherever it is: what polls stops by itself, and what does not is ended. How
// soon is measured in bench/stream.
#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "run_pse.h"

namespace pse::test {
namespace {

class Stop : public CommandLine {
 protected:
  // Sends the signal once the job has said that it computes, and waits for its end.
  Ended stop_while_computing(const std::vector<std::string>& words, int signal) {
    file(".in", "");
    const pid_t process = start(words);
    for (int i = 0; i < 2000 && read(".err").find("{") == std::string::npos; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    kill(process, signal);
    return finish(process);
  }
};

// A pipe that nobody empties: the process waits in a call of the system that no flag can end.
TEST_F(Stop, AJobThatWaitsForItsOutputEnds) {
  file("a.pse", "color = [x y u]\n");
  ASSERT_EQ(mkfifo((folder() / "out.exr").c_str(), 0600), 0);
  const int nobody = open((folder() / "out.exr").c_str(), O_RDWR);
  ASSERT_GE(nobody, 0);
  const Ended ended = stop_while_computing({"render", "a.pse", "-o", "out.exr", "--float",
                                            "--compression", "none", "--progress", "json"},
                                           SIGTERM);
  close(nobody);
  EXPECT_EQ(ended.status, 143);
  EXPECT_TRUE(contains(ended.err, "stopped at frame 0"));
}

TEST_F(Stop, AFilmLeavesTheOldFile) {
  if (std::system("command -v ffmpeg > /dev/null") != 0) GTEST_SKIP() << "no ffmpeg here";
  file("a.mp4", "the old film");
  file("slow.pse",
       "i = 0\nif frame > 2\n    while i < 1e30\n        i = i + u\ncolor = white * i\n");
  const Ended ended = stop_while_computing(
      {"render", "slow.pse", "-f", "1-5", "-o", "a.mp4", "--res", "64x64", "--progress", "json"},
      SIGINT);
  EXPECT_EQ(ended.status, 130) << ended.err;
  EXPECT_EQ(read("a.mp4"), "the old film");
}

}  // namespace
}  // namespace pse::test
