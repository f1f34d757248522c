#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace forcebound::wire {

/// Tells the first arrival of a sequence number from its copies, over the last `kWindow` numbers.
///
/// A number older than the window cannot be told apart from a copy any more and counts as one.
/// Real time: noexcept, no allocation, O(1) but when numbers jump.
class SequenceWindow {
 public:
  static constexpr std::uint64_t kWindow = 16384;

  enum class Arrival : std::uint8_t {
    newest,     ///< newer than all before
    overtaken,  ///< first arrival, but a newer one came before it
    duplicate,  ///< seen before, too old to know, or 0, which nobody sends
  };

  Arrival note(std::uint64_t sequence) noexcept {
    if (sequence > newest_) {
      const std::uint64_t steps = sequence - newest_;
      if (steps >= kWindow) {
        seen_.fill(0);
      } else {
        for (std::uint64_t s = newest_ + 1; s < sequence; ++s) clear(s);
      }
      newest_ = sequence;
      set(sequence);
      return Arrival::newest;
    }
    if (sequence == 0 || newest_ - sequence >= kWindow || test(sequence)) return Arrival::duplicate;
    set(sequence);
    return Arrival::overtaken;
  }

  /// The highest number so far, 0 before the first. Numbers begin at 1.
  [[nodiscard]] std::uint64_t newest() const noexcept { return newest_; }

 private:
  static constexpr std::uint64_t kBits = 64;
  static std::size_t word(std::uint64_t s) noexcept { return static_cast<std::size_t>(s % kWindow / kBits); }
  static std::uint64_t bit(std::uint64_t s) noexcept { return std::uint64_t{1} << (s % kBits); }

  void set(std::uint64_t s) noexcept { seen_[word(s)] |= bit(s); }
  void clear(std::uint64_t s) noexcept { seen_[word(s)] &= ~bit(s); }
  [[nodiscard]] bool test(std::uint64_t s) const noexcept { return (seen_[word(s)] & bit(s)) != 0; }

  std::array<std::uint64_t, kWindow / kBits> seen_{};
  std::uint64_t newest_ = 0;
};

}  // namespace forcebound::wire
