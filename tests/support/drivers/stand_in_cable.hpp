#pragma once

#include <memory>
#include <string>

#include "tests/support/drivers/stand_in.hpp"

namespace forcebound::test {

/// A device in another process, so that it outlives the process of a library that drives it, as real ones do: a Unix
/// socket in place of the cable. Where the other process is gone, the device is unplugged.
/// @throws std::runtime_error in one line if nothing listens at `socket`
[[nodiscard]] std::unique_ptr<StandIn> plug_into(const std::string& socket);

/// The other end: answers any number of libraries, until a byte can be read from the file descriptor `until`.
/// @throws std::runtime_error in one line if there can be no such socket
void serve(StandIn& device, const std::string& socket, int until);

}  // namespace forcebound::test
