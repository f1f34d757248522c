#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include "forcebound/time/clock.hpp"

/// When pictures are due.
namespace forcebound::record {

using time::Nanoseconds;

/// Lets 60 pictures a second through.
class PictureRate {
 public:
  bool take(Nanoseconds now) noexcept {
    constexpr std::int64_t kPeriod_ns = 1'000'000'000 / 60;
    const std::int64_t slot = now.count() / kPeriod_ns;
    return std::exchange(slot_, slot) != slot;
  }

 private:
  std::int64_t slot_ = std::numeric_limits<std::int64_t>::min();
};

/// What a server's recording shows of a session.
struct ShownSession {
  std::string device{};
  Nanoseconds seen{0};  ///< when it had a motion or force last
  PictureRate motions{};
  PictureRate forces{};
};

}  // namespace forcebound::record
