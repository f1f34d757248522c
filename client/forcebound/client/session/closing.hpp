#pragma once

#include <chrono>
#include <utility>

#include "forcebound/time/clock.hpp"

namespace forcebound::client {

using time::Nanoseconds;

/// The end of a session: Bye is repeated until the server's counts are final. They are once an answer still brings the
/// same counts at the longest delay of the session after the last that changed them: a network that has held a datagram
/// up for so long may hold up the last ones as long. Silence is not such an answer.
///
/// Real time: noexcept, no allocation, O(1).
class Closing {
 public:
  /// From now on a Bye answers ours.
  void begin(Nanoseconds now) noexcept {
    if (!std::exchange(begun_, true)) on_news(now);
  }
  [[nodiscard]] bool begun() const noexcept { return begun_; }

  /// A count of the server's, or of what came from it, has changed.
  void on_news(Nanoseconds now) noexcept {
    answers_without_news_ = 0;
    last_news_ = now;
  }

  /// An answer to Bye with the counts as they were.
  void on_answer_without_news(Nanoseconds now) noexcept {
    ++answers_without_news_;
    last_answer_ = now;
  }

  [[nodiscard]] bool has_final_counts(Nanoseconds longest_delay) const noexcept {
    return answers_without_news_ >= kAnswersWithoutNews && last_answer_ - last_news_ >= longest_delay;
  }

  /// Whether Bye is sent now.
  [[nodiscard]] bool bye_due(Nanoseconds now) noexcept {
    if (now < next_bye_) return false;
    next_bye_ = now + kByePause;
    return true;
  }

 private:
  static constexpr Nanoseconds kByePause = std::chrono::milliseconds{50};
  static constexpr int kAnswersWithoutNews = 5;

  bool begun_ = false;
  Nanoseconds last_news_{0};
  Nanoseconds last_answer_{0};
  int answers_without_news_ = 0;
  Nanoseconds next_bye_{Nanoseconds::min()};
};

}  // namespace forcebound::client
