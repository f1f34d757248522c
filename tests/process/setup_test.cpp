#include <gmock/gmock.h>
#include <stdlib.h>

#include <sstream>
#include <string>
#include <vector>

#include "tests/process/programs.hpp"
#include "tests/support/source_folder.hpp"

namespace forcebound::test {
namespace {

using testing::Contains;
using testing::Each;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

struct Listed {
  std::vector<std::string> packages;
  std::string warning;
};

/// What deploy/setup would install on a system that /etc/os-release describes so.
Listed listed_on(const std::string& os_release) {
  const TemporaryFolder folder;
  const std::string file = folder.file("os-release");
  write_file(file, os_release);
  setenv("FORCEBOUND_OS_RELEASE", file.c_str(), 1);
  const std::string setup = (source_folder() / "deploy/setup").string();
  const Ran ran = run(setup.c_str(), {"--tests", "--gate", "--list"});
  unsetenv("FORCEBOUND_OS_RELEASE");
  EXPECT_EQ(ran.exit_code, 0) << ran.err;
  Listed listed{.packages = {}, .warning = ran.err};
  std::istringstream lines(ran.out);
  for (std::string line; std::getline(lines, line);) listed.packages.push_back(line);
  return listed;
}

TEST(Setup, NamesDebiansPackagesAndIsSilentThere) {
  const Listed listed = listed_on("ID=debian\nVERSION_ID=\"12\"\nPRETTY_NAME=\"Debian GNU/Linux 12\"\n");
  EXPECT_THAT(listed.packages, Contains("libeigen3-dev"));
  EXPECT_THAT(listed.packages, Contains("ninja-build"));
  EXPECT_THAT(listed.warning, IsEmpty());
}

TEST(Setup, SaysThatNobodyTriedUbuntu) {
  const Listed listed =
      listed_on("ID=ubuntu\nID_LIKE=debian\nVERSION_ID=\"24.04\"\nPRETTY_NAME=\"Ubuntu 24.04 LTS\"\n");
  EXPECT_THAT(listed.packages, Contains("libeigen3-dev"));
  EXPECT_THAT(listed.warning, HasSubstr("on Ubuntu 24.04 LTS nobody has tried it"));
}

TEST(Setup, NamesFedorasPackagesAndSaysThatNobodyTriedIt) {
  const Listed listed = listed_on("ID=fedora\nVERSION_ID=41\nPRETTY_NAME=\"Fedora Linux 41\"\n");
  for (const char* const name : {"eigen3-devel", "gcc-c++", "json-devel", "gtest-devel", "clang-tools-extra"}) {
    EXPECT_THAT(listed.packages, Contains(name));
  }
  EXPECT_THAT(listed.packages, Each(Not(testing::EndsWith("-dev")))) << "a name of Debian's";
  EXPECT_THAT(listed.packages, Each(Not(HasSubstr("mujoco"))));
  EXPECT_THAT(listed.warning, HasSubstr("on Fedora Linux 41 nobody has tried it"));
  EXPECT_THAT(listed.warning, HasSubstr("no MuJoCo in Fedora"));
}

}  // namespace
}  // namespace forcebound::test
