#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>

namespace forcebound::lab {

/// By how much a tool that stayed behind, as its law withheld torque, is faster than it may be until it has caught up:
///
///     v <= min(2 v_leader + 20 mm/s, largest v_leader since the law withheld)
///
/// v_leader is the leader's largest speed within the time that its motion needs to reach the tool.
class LurchMeter {
 public:
  /// @param ticks that the leader's motion needs to reach the tool
  explicit LurchMeter(std::size_t ticks) : ticks_(ticks) {}

  struct Tick {
    double leader_m_per_s = 0;
    double tool_m_per_s = 0;
    double lag_m = 0;  ///< of the tool behind where its leader wants it, as heard
    bool withheld = false;
  };

  void add(const Tick& tick) {
    recent_.push_back(tick.leader_m_per_s);
    if (recent_.size() > ticks_) recent_.pop_front();
    if (tick.withheld && !behind_) {
      behind_ = true;
      fastest_ = 0;
    }
    if (!behind_) return;
    const double leader = *std::ranges::max_element(recent_);
    fastest_ = std::max(fastest_, leader);
    excess_ = std::max(excess_, tick.tool_m_per_s - std::min(2 * leader + kCreep_m_per_s, fastest_));
    behind_ = tick.withheld || tick.lag_m > kCaughtUp_m;
  }

  /// The largest so far; 0: it was never faster.
  [[nodiscard]] double excess_m_per_s() const noexcept { return excess_; }

 private:
  static constexpr double kCreep_m_per_s = 0.02;
  static constexpr double kCaughtUp_m = 1e-3;

  std::size_t ticks_;
  std::deque<double> recent_;
  bool behind_ = false;
  double fastest_ = 0;  // of the leader, since the law withheld
  double excess_ = 0;
};

}  // namespace forcebound::lab
