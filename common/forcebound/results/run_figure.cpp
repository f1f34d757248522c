#include "forcebound/results/run_figure.hpp"

#include <algorithm>
#include <vector>

#include "forcebound/results/figure_scripts.hpp"
#include "forcebound/text/table.hpp"

namespace forcebound::results {

void RunFigure::on_tick(const record::TickRecord& tick) noexcept {
  const bool first = !start_;
  if (first) start_ = tick.time;
  if (tick.time - arrival_ > info_.hold) round_trip_ms_ = kNone;  // a blackout is a gap, not a line
  arrived_ = false;
  const auto stiffness_N_per_m = displayed_.on_tick(tick);
  std::array<double, kCurves> y{};
  const auto axes = std::span(y).first<control::kDofMax>();
  std::ranges::fill(axes, kNone);
  for (Eigen::Index axis = 0; axis < tick.position.size(); ++axis) {
    axes[static_cast<std::size_t>(axis)] = 1e3 * tick.position[axis];
  }
  const std::array others{1e3 * std::max(tick.penetration_m, 0.0),
                          tick.request.norm(),
                          tick.applied.norm(),
                          stiffness_N_per_m ? 1e-3 * *stiffness_N_per_m : kNone,
                          1e3 * tick.audit_J,
                          1e3 * tick.energy_J,
                          round_trip_ms_,
                          tick.force_sequence != 0 ? 1e3 * time::to_seconds(tick.force_age) : kNone,
                          first ? kNone : 1e3 * time::to_seconds(tick.interval),
                          1e3 * time::to_seconds(tick.latency)};
  static_assert(control::kDofMax + others.size() == kCurves);
  std::ranges::copy(others, y.begin() + control::kDofMax);
  envelope_.add(time::to_seconds(tick.time - *start_), y);
}

void RunFigure::on_force(const record::ForceRecord& force) noexcept {
  const double round_trip_ms = 1e3 * time::to_seconds(force.round_trip);
  round_trip_ms_ = arrived_ ? std::max(round_trip_ms_, round_trip_ms) : round_trip_ms;
  arrived_ = true;
  arrival_ = force.receive_time;
}

std::string RunFigure::to_csv() const {
  text::Table table({{"time_s"},
                     {"x_mm"},
                     {"y_mm"},
                     {"z_mm"},
                     {"x_mrad"},
                     {"y_mrad"},
                     {"z_mrad"},
                     {"penetration_mm"},
                     {"requested_N"},
                     {"applied_N"},
                     {"stiffness_N_per_mm"},
                     {"P_mJ"},
                     {"ledger_mJ"},
                     {"round_trip_ms"},
                     {"force_age_ms"},
                     {"period_ms"},
                     {"latency_ms"}});
  for (const auto& [time_s, y] : envelope_.points()) {
    std::vector<text::Table::Cell> row{figure_number(time_s)};
    for (const double value : y) row.emplace_back(figure_number(value));
    table.add(std::move(row));
  }
  return table.to_csv();
}

std::string RunFigure::title() const {
  // What the server simulates begins with its first part's name.
  const std::string scene = info_.scene.empty() ? info_.simulated.substr(0, info_.simulated.find(':')) : info_.scene;
  return file_ + ": " + info_.law + (scene.empty() ? "" : " on " + scene) + ", " + info_.rendering + " rendering";
}

std::filesystem::path RunFigure::draw_to(const std::filesystem::path& png, const Formats& formats) const {
  return draw({.script = text::text_of(figure_scripts(), "run"),
               .csv = to_csv(),
               .title = title(),
               .subtitle = info_.device + ", " + info_.operator_name +
                           (info_.network.empty() ? "" : ", network: " + info_.network)},
              png, formats);
}

}  // namespace forcebound::results
