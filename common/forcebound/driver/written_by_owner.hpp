#pragma once

#include <string>

namespace forcebound::driver {

/// Refuses a driver that others than its owner, and the owner of its folder, may replace: it would be their code that
/// runs in this process, and moves the device.
///
/// Looked at are the file and its folder, both as named and where links lead, for who else may write them; and the
/// folders above, for everybody who may rename what is in them. A group that is its owner's own (of the same number, as
/// pam_umask(8) has it) is no other.
///
/// @param file its path; one that is not there is not refused
/// @throws std::runtime_error in one line without the driver's name: who may write what, and what would be accepted
void expect_written_by_owner(const std::string& file);

}  // namespace forcebound::driver
