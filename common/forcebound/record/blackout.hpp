#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "forcebound/time/clock.hpp"

namespace forcebound::record {

using time::Nanoseconds;

/// A time in which no new force came back, and the counts of both ends in it.
///
/// The server's counts come with each of its forces and with its Bye. So the first of them after the blackout tells
/// which motions had reached it and which answers it had sent, and thereby which direction had failed. The message that
/// ended the blackout is not counted.
struct Blackout {
  Nanoseconds duration{0};    ///< 0: there was none
  bool over = false;          ///< a force came after it
  bool counted = false;       ///< the counts below are known
  bool server_left = false;   ///< the server said Bye in it
  std::uint64_t motions = 0;  ///< sampled in it
  std::uint64_t lost_up = 0;  ///< of those, did not reach the server
  std::uint64_t answers = 0;  ///< sent by the server in it
  std::uint64_t lost_down = 0;
};

/// A direction is dead if it lost more than half of what was sent on it.
[[nodiscard]] bool up_died(const Blackout& blackout) noexcept;
[[nodiscard]] bool down_died(const Blackout& blackout) noexcept;

/// In a word: "up", "down", "both", "neither" (datagrams arrived late, or none was sent); "server" if that had ended
/// the session; "unknown" if no counts came.
[[nodiscard]] std::string_view what_died(const Blackout& blackout) noexcept;

/// In one line: "nothing came back from 127.0.0.1:47800 for 60.0 s: 60012 of 60012 motions arrived there (up alive), 0
/// of 60011 answers came back (down dead)".
[[nodiscard]] std::string words_of(const Blackout& blackout, const std::string& server);

}  // namespace forcebound::record
