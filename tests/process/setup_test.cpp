#include <gmock/gmock.h>
#include <stdlib.h>

#include <chrono>
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
  for (const std::string version : {"12", "13"}) {
    const Listed listed = listed_on("ID=debian\nVERSION_ID=\"" + version + "\"\nPRETTY_NAME=\"Debian\"\n");
    EXPECT_THAT(listed.packages, Contains("libeigen3-dev"));
    EXPECT_THAT(listed.packages, Contains("ninja-build"));
    EXPECT_THAT(listed.packages, Contains("npm")) << "or the live page that the README shows is not there";
    EXPECT_THAT(listed.warning, IsEmpty()) << version;
  }
}

TEST(Setup, SaysThatNobodyTriedTheNextDebian) {
  const Listed listed = listed_on("ID=debian\nVERSION_ID=\"14\"\nPRETTY_NAME=\"Debian GNU/Linux 14\"\n");
  EXPECT_THAT(listed.warning, HasSubstr("on Debian GNU/Linux 14 nobody has tried it"));
}

TEST(Setup, ALibraryThatTestsUseAndThatIsMissingLeavesOutTheirSourcesAlone) {
  const TemporaryFolder folder;
  const std::string build = folder.file("build");
  const Ran configured =
      run("/usr/bin/env",
          {"cmake", "-G", "Ninja", "-S", source_folder().string(), "-B", build, "-DFORCEBOUND_PAGE=OFF",
           "-DCMAKE_DISABLE_FIND_PACKAGE_rapidcheck=ON", "-DCMAKE_DISABLE_FIND_PACKAGE_embree=ON"},
          std::chrono::minutes{5});
  ASSERT_EQ(configured.exit_code, 0) << configured.err;
  const Ran left_out = run("/usr/bin/env", {"ctest", "--test-dir", build, "-V", "-R", "[.]without_"});
  EXPECT_THAT(left_out.out,
              HasSubstr("SKIPPED: embree is not installed (Debian: libembree-dev): without bvh_test.cpp\n"));
  EXPECT_THAT(left_out.out, HasSubstr("SKIPPED: rapidcheck is not installed (Debian: librapidcheck-dev): without "
                                      "codec_abuse_test.cpp codec_size_test.cpp codec_test.cpp\n"));
  const Ran listed = run("/usr/bin/env", {"ctest", "--test-dir", build, "-N"});
  for (const char* const there : {": wire_test\n", ": scene_test.1\n", ": control_test.1\n", ": http_test\n"}) {
    EXPECT_THAT(listed.out, HasSubstr(there));
  }
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
