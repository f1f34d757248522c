#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "forcebound/time/clock.hpp"

namespace forcebound::netem {

using time::Nanoseconds;

/// Which way: up is from client to server.
enum class Direction : std::uint8_t { up, down };

constexpr std::string_view to_string(Direction direction) noexcept {
  return direction == Direction::up ? "up" : "down";
}

enum class Fate : std::uint8_t {
  forwarded,
  lost,        ///< dropped by the loss model
  over_limit,  ///< the queue was full
  blackout,    ///< sent into a hole of the trace, or a blackhole
};

/// The fate of one packet, or of the copy that `duplicate` made of it.
struct Verdict {
  std::uint64_t number = 0;  ///< of the packet in its direction: 1, 2, 3, ...
  Fate fate = Fate::forwarded;
  bool copy = false;
  bool corrupted = false;
  bool reordered = false;  ///< sent at once, ahead of delayed ones
  Nanoseconds arrival{0};
  Nanoseconds delay{0};  ///< if forwarded, until it leaves; slots and delivery opportunities add to it only then
  bool operator==(const Verdict&) const = default;
};

/// One word for a log: "forwarded", "lost", "over-limit", "blackout", with "duplicate", "corrupted" or "reordered" in
/// front, joined by '+', where they apply: "duplicate+corrupted+forwarded".
std::string verdict_text(const Verdict& verdict);

/// The verdicts on one packet: the copy's first, if there is one.
class Verdicts {
 public:
  void add(const Verdict& verdict) noexcept { verdicts_[count_++] = verdict; }
  [[nodiscard]] const Verdict* begin() const noexcept { return verdicts_.data(); }
  [[nodiscard]] const Verdict* end() const noexcept { return verdicts_.data() + count_; }
  [[nodiscard]] std::size_t size() const noexcept { return count_; }

 private:
  std::array<Verdict, 2> verdicts_{};
  std::size_t count_ = 0;
};

/// What happened in one direction. received + duplicated = forwarded + lost + over_limit + blackout + still waiting.
struct ImpairmentCounters {
  std::uint64_t received = 0;
  std::uint64_t forwarded = 0;
  std::uint64_t lost = 0;
  std::uint64_t duplicated = 0;
  std::uint64_t corrupted = 0;
  std::uint64_t reordered = 0;
  std::uint64_t over_limit = 0;
  std::uint64_t blackout = 0;
  bool operator==(const ImpairmentCounters&) const = default;
};

}  // namespace forcebound::netem
