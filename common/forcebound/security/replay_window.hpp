#pragma once

#include <array>
#include <cstdint>

namespace forcebound::security {

/// The counters of the records that were opened: refuses a second one with the same counter, in whatever order they
/// come (RFC 4303, appendix A2).
///
/// Asked before a record is authenticated, changed only after: a forged counter far ahead moves nothing. Counters
/// further back than `kRecords` (give or take a word of 64) count as replayed: at 1 kHz that is 16 s, as in
/// wire::SequenceWindow.
///
/// Real time: noexcept, no allocation, at most kRecords/64 steps.
class ReplayWindow {
 public:
  static constexpr std::uint64_t kRecords = 16384;

  /// Whether no record with this counter was noted, as far as is remembered.
  [[nodiscard]] bool is_fresh(std::uint64_t counter) const noexcept {
    if (!any_ || counter > newest_) return true;
    if (newest_ / kWordBits - counter / kWordBits >= kWords) return false;
    return (opened_[counter / kWordBits % kWords] & bit(counter)) == 0;
  }

  /// Notes a fresh one, after its record was authenticated.
  void note(std::uint64_t counter) noexcept {
    if (!any_ || counter > newest_) advance_to(counter);
    opened_[counter / kWordBits % kWords] |= bit(counter);
  }

 private:
  static constexpr std::uint64_t kWordBits = 64;
  static constexpr std::uint64_t kWords = kRecords / kWordBits;

  [[nodiscard]] static constexpr std::uint64_t bit(std::uint64_t counter) noexcept {
    return std::uint64_t{1} << counter % kWordBits;
  }

  void advance_to(std::uint64_t counter) noexcept {
    const std::uint64_t from = newest_ / kWordBits;
    const std::uint64_t to = counter / kWordBits;
    if (!any_ || to - from >= kWords) {
      opened_.fill(0);
    } else {
      for (std::uint64_t word = from + 1; word <= to; ++word) opened_[word % kWords] = 0;
    }
    newest_ = counter;
    any_ = true;
  }

  std::array<std::uint64_t, kWords> opened_{};
  std::uint64_t newest_ = 0;
  bool any_ = false;
};

}  // namespace forcebound::security
