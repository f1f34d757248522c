#pragma once

#include <array>
#include <cstdint>

namespace forcebound::wire {

/// Which sequence numbers have arrived, so that a copy is known from a latecomer.
///
/// Numbers are compared as a circle is (RFC 1982), so that wrapping around is nothing special. What lies further back
/// than `kNumbers` (give or take a word of 64) cannot be told apart any more and counts as a duplicate: at 1 kHz that
/// is 16 s, more than the longest round trip we know of.
///
/// Real time: noexcept, no allocation, at most kNumbers/64 steps.
class SequenceWindow {
 public:
  enum class Arrival : std::uint8_t { newest, late, duplicate };

  static constexpr std::uint64_t kNumbers = 16384;

  [[nodiscard]] Arrival note(std::uint64_t sequence) noexcept;

  /// Of those noted.
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
