#pragma once

#include "forcebound/record/tick_record.hpp"

namespace forcebound::lab {

/// Keeps the last tick.
class LastTick final : public record::TickSink {
 public:
  void on_tick(const record::TickRecord& tick) noexcept override { tick_ = tick; }
  [[nodiscard]] const record::TickRecord& tick() const noexcept { return tick_; }

 private:
  record::TickRecord tick_;
};

}  // namespace forcebound::lab
