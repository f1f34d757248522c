#pragma once

#include <filesystem>
#include <optional>

namespace forcebound::server {

/// How many processors this process may use by the quota of its control group, or of one above it, such as a
/// container's: the least of them, as a number that need not be whole. Reads cpu.max, or cpu.cfs_quota_us where the
/// older hierarchy of control groups is mounted.
///
/// @param own the process's file `cgroup`
/// @param groups where control groups are mounted
/// @returns nothing where there is no quota, or none that can be read
[[nodiscard]] std::optional<double> processor_quota(const std::filesystem::path& own = "/proc/self/cgroup",
                                                    const std::filesystem::path& groups = "/sys/fs/cgroup");

}  // namespace forcebound::server
