#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>

namespace forcebound::time {

/// The newest value that one thread tells another; older ones are dropped. Wait-free, no allocation, one writer and one
/// reader: three places of which each side owns one, and the third changes hands.
template <class Value>
class Latest {
 public:
  /// By the writer.
  void store(const Value& value) noexcept {
    places_[writes_] = value;
    writes_ = between_.exchange(writes_ | kNew, std::memory_order_acq_rel) & kPlace;
  }

  /// By the reader: what was told since it last asked; null: nothing. Valid until it asks again.
  [[nodiscard]] const Value* take() noexcept {
    if ((between_.load(std::memory_order_relaxed) & kNew) == 0) return nullptr;
    reads_ = between_.exchange(reads_, std::memory_order_acq_rel) & kPlace;
    return &places_[reads_];
  }

 private:
  static constexpr std::uint8_t kPlace = 3;
  static constexpr std::uint8_t kNew = 4;

  std::array<Value, 3> places_{};
  std::uint8_t writes_ = 0;
  std::atomic<std::uint8_t> between_{1};
  std::uint8_t reads_ = 2;
};

}  // namespace forcebound::time
