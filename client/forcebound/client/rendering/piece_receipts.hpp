#pragma once

#include <cstdint>

#include "forcebound/wire/messages.hpp"

namespace forcebound::client {

/// Which transmissions of pieces came: the newest, and the 64 before it.
///
/// Real time: noexcept, no allocation.
class PieceReceipts {
 public:
  void add(std::uint64_t transmission) noexcept {
    if (transmission > newest_) {
      const std::uint64_t further = transmission - newest_;
      before_ = further >= 64 ? 0 : before_ << further;
      if (newest_ != 0 && further <= 64) before_ |= std::uint64_t{1} << (further - 1);
      newest_ = transmission;
    } else if (newest_ - transmission >= 1 && newest_ - transmission <= 64) {
      before_ |= std::uint64_t{1} << (newest_ - transmission - 1);
    }
  }

  [[nodiscard]] wire::PieceReceipt receipt(bool wanted) const noexcept {
    return {.wanted = wanted, .newest = newest_, .before = before_};
  }

 private:
  std::uint64_t newest_ = 0;
  std::uint64_t before_ = 0;
};

}  // namespace forcebound::client
