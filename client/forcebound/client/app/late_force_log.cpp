#include "forcebound/client/app/late_force_log.hpp"

#include <utility>

namespace forcebound::client {

void LateForceLog::store(const Event& event) noexcept {
  waiting_ = {event.kind, event.duration, waiting_ ? waiting_->left_out + 1 : 0};
}

std::optional<LateForceLog::Line> LateForceLog::take(time::Nanoseconds now) noexcept {
  if (!waiting_ || !lines_.take(now)) return std::nullopt;
  return take_rest();
}

std::optional<LateForceLog::Line> LateForceLog::take_rest() noexcept { return std::exchange(waiting_, std::nullopt); }

}  // namespace forcebound::client
