#pragma once

#include <array>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "forcebound/record/displayed_stiffness.hpp"
#include "forcebound/record/run_info.hpp"
#include "forcebound/record/tick_record.hpp"
#include "forcebound/results/draw.hpp"
#include "forcebound/results/envelope.hpp"

namespace forcebound::results {

/// One run: motion, force, energy and timing, a panel each (run.gnuplot), in bounded memory.
class RunFigure final : public record::TickSink {
 public:
  /// @param file the recording's name, for the title
  RunFigure(const record::RunInfo& info, std::string file)
      : info_(info), file_(std::move(file)), displayed_(info.stiffness_depth_m_min) {}

  void on_tick(const record::TickRecord& tick) noexcept override;
  void on_force(const record::ForceRecord& force) noexcept override;

  /// A row for each point: time_s and the columns that run.gnuplot draws. Axes that the device lacks are nan.
  [[nodiscard]] std::string to_csv() const;

  /// Which run this is: file, law, scene and rendering.
  [[nodiscard]] std::string title() const;

  /// @returns and throws as `draw` does.
  std::filesystem::path draw_to(const std::filesystem::path& png, const Formats& formats = {}) const;

 private:
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  static constexpr std::size_t kCurves = 16;

  record::RunInfo info_;
  std::string file_;
  std::optional<record::Nanoseconds> start_;
  record::DisplayedStiffness displayed_;
  record::Nanoseconds arrival_{0};  ///< of the last force
  double round_trip_ms_ = kNone;    ///< longest of the forces since the last tick, or of the last force before
  bool arrived_ = false;            ///< since the last tick
  Envelope envelope_{kCurves};
};

}  // namespace forcebound::results
