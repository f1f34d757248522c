#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tests/tools/netem/impairment.hpp"

namespace forcebound::netem::testing_support {

/// What left, as a value.
struct Left {
  std::uint64_t number;
  Nanoseconds time;
  Verdict verdict;
  std::string bytes;
};

inline std::span<const std::byte> bytes_of(std::string_view text) { return std::as_bytes(std::span(text)); }

/// One direction, driven as its users drive it: what is due is popped before the next packet comes.
class Way {
 public:
  explicit Way(std::string_view words, std::uint64_t seed = 1) : Way({.netem = parse_netem(words), .seed = seed}) {}
  explicit Way(const ImpairmentSettings& settings) : impairment_(settings) {}

  Verdicts send(Nanoseconds now, std::string_view text = "x", std::uint64_t tag = 0) {
    run_until(now);
    return impairment_.push(now, bytes_of(text), tag);
  }

  void run_until(Nanoseconds now) {
    for (auto next = impairment_.next_departure(); next && *next <= now; next = impairment_.next_departure()) {
      const auto departure = impairment_.pop(*next);
      if (!departure) continue;
      const auto* text = reinterpret_cast<const char*>(departure->bytes.data());
      left_.push_back(
          {departure->verdict.number, departure->time(), departure->verdict, {text, departure->bytes.size()}});
    }
  }

  /// All that still waits.
  const std::vector<Left>& finish() {
    run_until(Nanoseconds::max());
    return left_;
  }

  [[nodiscard]] std::vector<std::uint64_t> numbers() const {
    std::vector<std::uint64_t> result;
    for (const Left& left : left_) result.push_back(left.number);
    return result;
  }

  Impairment& impairment() { return impairment_; }
  [[nodiscard]] const ImpairmentCounters& counters() const { return impairment_.counters(); }

 private:
  Impairment impairment_;
  std::vector<Left> left_;
};

}  // namespace forcebound::netem::testing_support
