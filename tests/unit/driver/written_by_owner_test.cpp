#include "forcebound/driver/written_by_owner.hpp"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <stdexcept>
#include <string>

#include "forcebound/driver/driver_library.hpp"
#include "tests/tools/temporary_folder.hpp"

namespace forcebound::driver {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::ThrowsMessage;

/// A driver in a folder within another.
class WrittenByOwner : public testing::Test {
 protected:
  WrittenByOwner() {
    fs::create_directory(folder_);
    fs::copy_file(std::string(FORCEBOUND_TEST_DRIVERS) + "/forcebound-device-slider.so", file_);
    set(folder_, 0755);
    set(file_, 0644);
  }

  static void set(const std::string& path, ::mode_t mode) { ASSERT_EQ(::chmod(path.c_str(), mode), 0); }

  void expect_refused(const std::string& who, const std::string& what) const {
    EXPECT_THAT([this] { const DriverLibrary library(file_, "slider"); },
                ThrowsMessage<std::runtime_error>(
                    AllOf(HasSubstr("driver " + file_ + ": " + who + " may write to " + what + ","),
                          HasSubstr("-w " + what), Not(HasSubstr("\n")))));
  }
  void expect_loaded() const { EXPECT_NO_THROW(DriverLibrary(file_, "slider")); }

  test::TemporaryFolder above_;
  std::string folder_ = (fs::canonical(above_.path()) / "drivers").string();
  std::string file_ = folder_ + "/forcebound-device-slider.so";
};

TEST_F(WrittenByOwner, IsRefusedWhereEverybodyMayWriteItOrItsFolder) {
  expect_loaded();
  set(file_, 0646);
  expect_refused("everybody", file_);
  set(file_, 0644);
  for (const ::mode_t mode : {0777U, 0757U, 01777U}) {
    set(folder_, mode);
    expect_refused("everybody", folder_);
  }
  set(folder_, 0755);
  expect_loaded();
}

TEST_F(WrittenByOwner, IsRefusedWhereEverybodyMayRenameItsFolder) {
  const std::string above = fs::canonical(above_.path()).string();
  set(above, 0777);
  expect_refused("everybody", above);
  set(above, 01777);
  expect_loaded();
}

TEST_F(WrittenByOwner, IsRefusedWhereAGroupOfOthersMayWriteItOrItsFolder) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can make files of other groups";
  constexpr ::gid_t kGroup = 54321;
  for (const std::string& path : {file_, folder_}) {
    set(path, 0775);
    expect_loaded();
    ASSERT_EQ(::chown(path.c_str(), 0, kGroup), 0);
    set(path, 0775);
    expect_refused("group 54321", path);
    set(path, 0755);
    expect_loaded();
  }
}

TEST_F(WrittenByOwner, IsRefusedWhereEverybodyMayReplaceTheLinkToIt) {
  const std::string open_to_all = (fs::canonical(above_.path()) / "open").string();
  fs::create_directory(open_to_all);
  const std::string link = open_to_all + "/forcebound-device-slider.so";
  fs::create_symlink(file_, link);
  set(open_to_all, 0777);
  EXPECT_THAT([&] { const DriverLibrary library(link, "slider"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("everybody may write to " + open_to_all)));
  set(open_to_all, 0755);
  EXPECT_NO_THROW(DriverLibrary(link, "slider"));
}

}  // namespace
}  // namespace forcebound::driver
