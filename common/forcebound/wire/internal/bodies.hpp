#pragma once

#include "forcebound/v1/session.pb.h"

namespace forcebound::wire {

/// The Protocol Buffers body of each kind of message, with memory for the most that a datagram can hold: reading and
/// filling them again allocates nothing. Private to wire.
struct Bodies {
  Bodies();

  v1::Hello hello;
  v1::Welcome welcome;
  v1::Refusal refusal;
  v1::MotionSample motion;
  v1::EnvironmentForce force;
  v1::Bye bye;
  v1::ScenePiece piece;
  v1::ViewPiece view;
};

}  // namespace forcebound::wire
