#pragma once

#include <string>

namespace forcebound::server {

/// Asks the system to schedule this process before ordinary ones and to keep its memory in place. Below the priority of
/// a client on the same machine, whose deadline is the hard one.
///
/// @return what was granted and what not, in one line.
std::string ask_for_realtime();

}  // namespace forcebound::server
