#pragma once

#include <array>
#include <cstdint>
#include <limits>

namespace forcebound::wire {

/// The sequence numbers that have arrived: tells duplicates from late datagrams.
///
/// Numbers are compared modulo 2^64 (RFC 1982), so that wrapping around needs no special case. Numbers further back
/// than `kNumbers` (give or take a word of 64) count as duplicates: at 1 kHz that is 16 s, more than the longest round
/// trip we know of.
///
/// A number further ahead of the newest than the caller says is not noted: one forged datagram must not make copies of
/// all that follow.
///
/// Real time: noexcept, no allocation, at most kNumbers/64 steps.
class SequenceWindow {
 public:
  enum class Arrival : std::uint8_t {
    newest,
    late,
    duplicate,
    too_far_ahead,  ///< nothing has changed
  };

  static constexpr std::uint64_t kNumbers = 16384;
  /// Half of the circle: what is further ahead is behind.
  static constexpr std::uint64_t kAnyAhead = std::numeric_limits<std::int64_t>::max();

  /// @param ahead_most further ahead of the newest is too far; of the first number that ever comes, nothing is
  [[nodiscard]] Arrival note(std::uint64_t sequence, std::uint64_t ahead_most = kAnyAhead) noexcept;

  /// The newest number noted.
  [[nodiscard]] std::uint64_t newest() const noexcept { return newest_; }

 private:
  static constexpr std::uint64_t kWordBits = 64;
  static constexpr std::uint64_t kWords = kNumbers / kWordBits;

  [[nodiscard]] std::uint64_t& word(std::uint64_t sequence) noexcept { return arrived_[sequence / kWordBits % kWords]; }
  void advance_to(std::uint64_t sequence) noexcept;

  std::array<std::uint64_t, kWords> arrived_{};
  std::uint64_t newest_ = 0;
  bool any_ = false;
};

}  // namespace forcebound::wire
