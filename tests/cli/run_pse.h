// Runs the built `pse` in a fresh folder with an environment of its own, and gives back all that it
// said.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "image/reader.h"

namespace pse::test {

struct Ended {
  int status = -1;  // exit status; 128 + signal where one killed it
  std::string out, err;
};

// A test with a folder to work in. Nothing of the user's configuration or cache is seen.
class CommandLine : public ::testing::Test {
 protected:
  void SetUp() override;
  void TearDown() override;

  // Runs pse with these arguments in the folder.
  Ended pse(const std::vector<std::string>& arguments, const std::string& input = "");
  // Starts it without waiting; finish() waits.
  pid_t start(const std::vector<std::string>& arguments);
  Ended finish(pid_t process);

  // Writes a file in the folder and returns its name.
  std::string file(const std::string& name, const std::string& text);
  std::string read(const std::string& name) const;
  bool exists(const std::string& name) const;
  // Writes an EXR of 4x2 pixels with color = [u v 0.25] and Z = px.
  void make_input(const std::string& name);
  // An image of the folder.
  image::Image picture(const std::string& name) const;
  std::filesystem::path folder() const { return folder_; }

  std::map<std::string, std::string> environment;  // added to a minimal one

 private:
  std::vector<std::string> whole_environment() const;
  std::filesystem::path folder_;
};

// Passes when `text` contains `part`.
::testing::AssertionResult contains(const std::string& text, const std::string& part);

}  // namespace pse::test
