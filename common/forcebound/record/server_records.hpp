#pragma once

#include "forcebound/time/clock.hpp"
#include "forcebound/wire/messages.hpp"

namespace forcebound::record {

using time::Nanoseconds;

/// One motion as a server received it.
struct MotionRecord {
  Nanoseconds receive_time{0};  ///< server's clock
  wire::MotionSample motion;
};

/// One environment force as a server sent it, at its `server_send_time`.
struct SentForceRecord {
  wire::EnvironmentForce force;
};

}  // namespace forcebound::record
