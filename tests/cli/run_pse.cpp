// Starting a process with its streams in files of the test's folder: no pipe can fill and block it.
#include "run_pse.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

namespace pse::test {
namespace {

std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> all;
  for (std::string& text : texts) all.push_back(text.data());
  all.push_back(nullptr);
  return all;
}

std::string content(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

}  // namespace

void CommandLine::SetUp() {
  std::string name = (std::filesystem::temp_directory_path() / "pse_cli_XXXXXX").string();
  ASSERT_NE(mkdtemp(name.data()), nullptr);
  folder_ = name;
}

void CommandLine::TearDown() { std::filesystem::remove_all(folder_); }

std::vector<std::string> CommandLine::whole_environment() const {
  std::map<std::string, std::string> all = {
      {"HOME", folder_.string()}, {"PATH", std::getenv("PATH") ? std::getenv("PATH") : ""}};
  // Compiled kernels are shared by the tests: compiling is not what they are about.
  all["XDG_CACHE_HOME"] = (std::filesystem::temp_directory_path() / "pse_cli_cache").string();
  for (const auto& [key, value] : environment) all[key] = value;
  std::vector<std::string> list;
  for (const auto& [key, value] : all) list.push_back(key + "=" + value);
  return list;
}

pid_t CommandLine::start(const std::vector<std::string>& arguments) {
  std::vector<std::string> words = {PSE_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<std::string> variables = whole_environment();
  std::vector<char*> argv = pointers(words), envp = pointers(variables);
  const std::string in = (folder_ / ".in").string(), out = (folder_ / ".out").string(),
                    err = (folder_ / ".err").string();
  const std::string where = folder_.string();

  const pid_t process = fork();
  if (process == 0) {
    const int input = open(in.c_str(), O_RDONLY | O_CREAT, 0600);
    const int output = open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    const int error = open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (dup2(input, 0) < 0 || dup2(output, 1) < 0 || dup2(error, 2) < 0 ||
        chdir(where.c_str()) != 0)
      _exit(99);
    execve(argv[0], argv.data(), envp.data());
    _exit(98);
  }
  return process;
}

Ended CommandLine::finish(pid_t process) {
  int status = 0;
  waitpid(process, &status, 0);
  Ended ended;
  ended.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  ended.out = content(folder_ / ".out");
  ended.err = content(folder_ / ".err");
  return ended;
}

Ended CommandLine::pse(const std::vector<std::string>& arguments, const std::string& input) {
  file(".in", input);
  return finish(start(arguments));
}

std::string CommandLine::file(const std::string& name, const std::string& text) {
  std::filesystem::create_directories((folder_ / name).parent_path());
  std::ofstream(folder_ / name, std::ios::binary) << text;
  return name;
}

std::string CommandLine::read(const std::string& name) const { return content(folder_ / name); }

bool CommandLine::exists(const std::string& name) const {
  return std::filesystem::exists(folder_ / name);
}

void CommandLine::make_input(const std::string& name) {
  file("make.pse", "color = [u v 0.25]\nZ = px\n");
  ASSERT_EQ(pse({"render", "make.pse", "-o", name, "--res", "4x2", "--float"}).status, 0);
}

image::Image CommandLine::picture(const std::string& name) const {
  auto read = image::read_image((folder_ / name).string());
  EXPECT_TRUE(read) << read.error().message;
  return read ? std::move(*read) : image::Image();
}

::testing::AssertionResult contains(const std::string& text, const std::string& part) {
  if (text.find(part) != std::string::npos) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "`" << part << "` is not in:\n" << text;
}

}  // namespace pse::test
