#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "forcebound/record/displayed_stiffness.hpp"
#include "forcebound/record/histogram.hpp"
#include "forcebound/record/run_info.hpp"
#include "forcebound/record/tick_record.hpp"
#include "tests/tools/lab/figure.hpp"

namespace forcebound::lab {

/// Collects the data of a run's figures, in bounded memory, and draws them.
class RunFigures final : public record::TickSink {
 public:
  explicit RunFigures(const record::RunInfo& info) : info_(info), displayed_(info.stiffness_depth_m_min) {}

  void on_tick(const record::TickRecord& tick) noexcept override;
  void on_force(const record::ForceRecord& force) noexcept override;

  /// Draws motion.png, force.png, energy.png and timing.png into a directory, which is created if need be.
  /// @returns the files drawn.
  /// @throws std::runtime_error as `draw` does.
  [[nodiscard]] std::vector<std::filesystem::path> draw_into(const std::filesystem::path& directory) const;

 private:
  [[nodiscard]] double seconds(record::Nanoseconds at) noexcept;
  [[nodiscard]] Figure motion() const;
  [[nodiscard]] Figure force() const;
  [[nodiscard]] Figure energy() const;
  [[nodiscard]] Figure timing() const;

  record::RunInfo info_;
  bool started_ = false;
  record::Nanoseconds start_{0};
  record::Nanoseconds arrival_{0};  ///< of the last force
  std::array<Envelope, control::kDofMax> position_mm_;
  Envelope penetration_mm_, request_N_, applied_N_, stiffness_N_per_mm_, ledger_mJ_, audit_mJ_;
  record::DisplayedStiffness displayed_;
  record::Histogram stiffness_mN_per_mm_;
  Envelope age_ms_, round_trip_ms_, period_ms_, latency_ms_;
};

}  // namespace forcebound::lab
