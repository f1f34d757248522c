#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace forcebound::time {

/// The numbers of the datagrams or records that have arrived: tells copies from latecomers (RFC 4303, appendix A2).
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
  Arrival add(std::uint64_t sequence, std::uint64_t ahead_most = kAnyAhead) noexcept;

  /// Whether `add` would find it to be the newest or late. Changes nothing: a number that must be authentic first is
  /// asked about before that is checked, and noted after, so that a forged one far ahead moves nothing.
  [[nodiscard]] bool is_fresh(std::uint64_t sequence) const noexcept;

  /// The newest number noted.
  [[nodiscard]] std::uint64_t newest() const noexcept { return newest_; }

 private:
  static constexpr std::uint64_t kWordBits = 64;
  static constexpr std::uint64_t kWords = kNumbers / kWordBits;

  [[nodiscard]] static constexpr std::size_t index_of(std::uint64_t sequence) noexcept {
    return sequence / kWordBits % kWords;
  }
  /// On the circle of numbers; negative: behind.
  [[nodiscard]] std::int64_t ahead_of_newest(std::uint64_t sequence) const noexcept {
    return static_cast<std::int64_t>(sequence - newest_);
  }
  void advance_to(std::uint64_t sequence) noexcept;

  std::array<std::uint64_t, kWords> arrived_{};
  std::uint64_t newest_ = 0;
  bool any_ = false;
};

}  // namespace forcebound::time
