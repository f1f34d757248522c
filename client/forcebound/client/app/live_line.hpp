#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>

#include "forcebound/record/tick_record.hpp"

namespace forcebound::client {

/// The run's state in one line on a terminal. The tick stores a few numbers, another thread prints them.
///
/// Real time: `on_tick` and `on_force` are noexcept, allocate nothing and never wait.
class LiveLine final : public record::TickSink {
 public:
  void on_tick(const record::TickRecord& tick) noexcept override;
  void on_force(const record::ForceRecord& force) noexcept override;

  [[nodiscard]] record::SessionState state() const noexcept { return state_; }

  /// The present line, without line ending; fields that do not fit into `columns` are left out.
  [[nodiscard]] std::string text(std::size_t columns) const;

 private:
  // Each number is atomic by itself; a line may mix two neighbouring ticks.
  std::atomic<std::uint64_t> ticks_{0};
  std::atomic<record::SessionState> state_{record::SessionState::connecting};
  std::atomic<control::FollowerState> follower_{control::FollowerState::none};
  std::atomic<bool> has_force_{false};
  std::atomic<std::int64_t> age_ns_{0};
  std::atomic<std::int64_t> round_trip_ns_{0};
  std::atomic<double> force_N_{0};
  std::atomic<double> energy_J_{0};
  std::atomic<double> audit_J_{0};
};

}  // namespace forcebound::client
