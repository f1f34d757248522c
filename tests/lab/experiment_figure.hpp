#pragma once

#include <deque>
#include <filesystem>
#include <string>

#include "forcebound/record/tick_record.hpp"
#include "tests/lab/figure.hpp"

namespace forcebound::lab {

/// The laws side by side in one experiment: penetration, force, energy and displayed stiffness over time.
class ExperimentFigure {
 public:
  explicit ExperimentFigure(std::string title) : title_(std::move(title)) {}

  /// A curve in each panel; the sink stays valid as long as the figure.
  record::TickSink& add_law(const std::string& law);

  /// Draws one PNG, named after the title, into a directory that is created if need be.
  [[nodiscard]] std::filesystem::path draw_into(const std::filesystem::path& directory) const;

 private:
  struct Curves final : record::TickSink {
    explicit Curves(std::string name) : law(std::move(name)) {}
    void on_tick(const record::TickRecord& tick) noexcept override;
    void on_force(const record::ForceRecord&) noexcept override {}

    std::string law;
    Envelope penetration_mm, force_N, audit_mJ, stiffness_N_per_mm;
  };

  std::string title_;
  std::deque<Curves> laws_;
};

}  // namespace forcebound::lab
