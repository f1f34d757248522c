#include "forcebound/server/app/processor_quota.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <string>

#include "forcebound/text/file.hpp"
#include "tests/tools/temporary_folder.hpp"

namespace forcebound::server {
namespace {

class ProcessorQuota : public testing::Test {
 protected:
  void write(const std::string& path, const std::string& content) {
    const std::filesystem::path file = folder_.file(path);
    std::filesystem::create_directories(file.parent_path());
    text::write_file(file, content + "\n");
  }
  [[nodiscard]] std::optional<double> quota(const std::string& own) {
    write("own", own);
    return processor_quota(folder_.file("own"), folder_.file("groups"));
  }

  test::TemporaryFolder folder_;
};

TEST_F(ProcessorQuota, IsNoneWhereThereAreNoGroups) {
  EXPECT_EQ(quota(""), std::nullopt);
  EXPECT_EQ(quota("0::/service"), std::nullopt);
  EXPECT_EQ(quota("nonsense\n0:\n::"), std::nullopt);
  EXPECT_EQ(processor_quota(folder_.file("missing"), folder_.file("groups")), std::nullopt);
}

TEST_F(ProcessorQuota, IsThatOfTheGroup) {
  write("groups/pod/server/cpu.max", "150000 100000");
  EXPECT_EQ(quota("0::/pod/server"), 1.5);
}

TEST_F(ProcessorQuota, IsNoneWhereItIsMax) {
  write("groups/pod/cpu.max", "max 100000");
  EXPECT_EQ(quota("0::/pod"), std::nullopt);
}

TEST_F(ProcessorQuota, IsTheLeastOfThoseAbove) {
  write("groups/cpu.max", "800000 100000");
  write("groups/pod/cpu.max", "200000 100000");
  write("groups/pod/server/cpu.max", "max 100000");
  EXPECT_EQ(quota("0::/pod/server"), 2);
}

TEST_F(ProcessorQuota, IsThatOfAContainerThatSeesItsOwnGroupAlone) {
  write("groups/cpu.max", "300000 100000");
  EXPECT_EQ(quota("0::/"), 3);
  EXPECT_EQ(quota("0::/docker/0123"), 3);
}

TEST_F(ProcessorQuota, IsReadFromTheOlderHierarchy) {
  write("groups/cpu,cpuacct/pod/cpu.cfs_quota_us", "50000");
  write("groups/cpu,cpuacct/pod/cpu.cfs_period_us", "20000");
  write("groups/cpu,cpuacct/cpu.cfs_quota_us", "-1");
  write("groups/cpu,cpuacct/cpu.cfs_period_us", "100000");
  EXPECT_EQ(quota("4:memory:/pod\n3:cpuset:/pod\n2:cpu,cpuacct:/pod\n0::/"), 2.5);
}

TEST_F(ProcessorQuota, IsLookedForElsewhereWhereAHierarchyCannotBeRead) {
  write("groups/cpu/cpu.cfs_quota_us", "300000");
  write("groups/cpu/cpu.cfs_period_us", "100000");
  const std::string too_long_for_a_file(300, 'x');
  EXPECT_EQ(quota("1:cpu," + too_long_for_a_file + ":/pod"), 3);
}

TEST_F(ProcessorQuota, IsFoundWhereBothHierarchiesAreMounted) {
  write("groups/cpu/pod/cpu.cfs_quota_us", "400000");
  write("groups/cpu/pod/cpu.cfs_period_us", "100000");
  write("groups/unified/pod/cgroup.procs", "");
  EXPECT_EQ(quota("1:cpu:/pod\n2:cpuacct:/\n0::/pod"), 4);
}

}  // namespace
}  // namespace forcebound::server
