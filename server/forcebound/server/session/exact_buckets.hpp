#pragma once

#include <cstddef>
#include <cstdint>
#include <new>
#include <unordered_map>

#include "forcebound/time/token_bucket.hpp"

namespace forcebound::server {

/// A token bucket for each of those who have shown who they are or where they receive: nobody shares one, whatever
/// others do. Who takes nothing for as long as a bucket takes to fill is forgotten where room is needed, and loses
/// nothing by that.
///
/// `take` is noexcept, and allocates for somebody new. O(1), but for a look at all at most eight times in the time in
/// which a bucket fills. Not thread-safe.
class ExactBuckets {
 public:
  /// @param most of whom it knows at once; while all of them have taken lately, nobody new may
  ExactBuckets(time::Nanoseconds interval, int burst, std::size_t most = 4096) noexcept
      : interval_(interval), burst_(burst), most_(most) {}

  /// @param who a number that is of nobody else
  [[nodiscard]] bool take(std::uint64_t who, time::Nanoseconds now) noexcept {
    auto found = known_.find(who);
    if (found == known_.end()) {
      if (known_.size() >= most_) forget_unused(now);
      if (known_.size() >= most_) return false;
      try {
        found = known_.emplace(who, Known{time::TokenBucket(interval_, burst_, now), now}).first;
      } catch (const std::bad_alloc&) {
        return false;
      }
    }
    found->second.used = now;
    return found->second.bucket.take(now);
  }

  [[nodiscard]] std::size_t known() const noexcept { return known_.size(); }

 private:
  struct Known {
    time::TokenBucket bucket;
    time::Nanoseconds used;
  };

  void forget_unused(time::Nanoseconds now) noexcept {
    const time::Nanoseconds fills_in = interval_ * burst_;
    constexpr int kChecks = 8;
    if (now - looked_ < fills_in / kChecks) return;
    looked_ = now;
    std::erase_if(known_, [&](const auto& entry) { return now - entry.second.used >= fills_in; });
  }

  time::Nanoseconds interval_;
  int burst_;
  std::size_t most_;
  std::unordered_map<std::uint64_t, Known> known_;
  time::Nanoseconds looked_ = time::Nanoseconds::min() / 2;
};

}  // namespace forcebound::server
