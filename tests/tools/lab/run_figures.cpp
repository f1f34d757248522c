#include "tests/tools/lab/run_figures.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

namespace forcebound::lab {
namespace {

constexpr double kNothingDrawn = std::numeric_limits<double>::quiet_NaN();

}  // namespace

double RunFigures::seconds(record::Nanoseconds at) noexcept {
  if (!started_) start_ = at;
  started_ = true;
  return time::to_seconds(at - start_);
}

void RunFigures::on_tick(const record::TickRecord& tick) noexcept {
  const bool first = !started_;
  const double t = seconds(tick.time);
  for (Eigen::Index axis = 0; axis < tick.position.size(); ++axis) {
    position_mm_[static_cast<std::size_t>(axis)].add(t, 1e3 * tick.position[axis]);
  }
  penetration_mm_.add(t, 1e3 * std::max(tick.penetration_m, 0.0));
  request_N_.add(t, tick.request.norm());
  applied_N_.add(t, tick.applied.norm());
  const auto stiffness = displayed_.on_tick(tick);
  stiffness_N_per_mm_.add(t, stiffness ? 1e-3 * *stiffness : kNothingDrawn);
  if (stiffness) stiffness_mN_per_mm_.add(time::from_seconds(1e-9 * *stiffness).count());  // thousandths, saturating
  ledger_mJ_.add(t, 1e3 * tick.energy_J);
  audit_mJ_.add(t, 1e3 * tick.audit_J);
  age_ms_.add(t, tick.force_sequence != 0 ? 1e3 * time::to_seconds(tick.force_age) : kNothingDrawn);
  if (!first) period_ms_.add(t, 1e3 * time::to_seconds(tick.interval));
  latency_ms_.add(t, 1e3 * time::to_seconds(tick.latency));
}

void RunFigures::on_force(const record::ForceRecord& force) noexcept {
  const double t = seconds(force.receive_time);
  if (force.receive_time - arrival_ > info_.hold)
    round_trip_ms_.add(t, kNothingDrawn);  // a blackout is a gap, not a line
  arrival_ = force.receive_time;
  round_trip_ms_.add(t, 1e3 * time::to_seconds(force.round_trip));
}

Figure RunFigures::motion() const {
  constexpr const char* kNames[] = {"x", "y", "z", "x rotation", "y rotation", "z rotation"};
  Panel position{"Position", "position [mm]", {}, {}, {}, {}};
  for (std::size_t axis = 0; axis < position_mm_.size(); ++axis) {
    if (position_mm_[axis].empty()) continue;
    position.series.push_back(position_mm_[axis].series(kNames[axis], colour::kAxes[axis]));
  }
  Panel penetration{"Penetration, where the surface is known", "depth [mm]", {}, {}, 0.0, {}};
  penetration.series = {penetration_mm_.series("below the surface", colour::kApplied)};
  return {{}, {}, "time [s]", {std::move(position), std::move(penetration)}};
}

Figure RunFigures::force() const {
  Panel force{"Force", "magnitude [N]", {}, {}, 0.0, {}};
  force.series = {request_N_.series("asked for", colour::kRequest), applied_N_.series("applied", colour::kApplied)};
  Panel stiffness{
      "Displayed stiffness at rest (depth changes by less than 5 mm/s)", "stiffness [N/mm]", {}, {}, 0.0, {}};
  cut_spikes(stiffness, 1e-3 * stiffness_mN_per_mm_.percentile(0.95), 1e-3 * stiffness_mN_per_mm_.max());
  stiffness.series = {stiffness_N_per_mm_.series("displayed", colour::kApplied)};
  return {{}, {}, "time [s]", {std::move(force), std::move(stiffness)}};
}

Figure RunFigures::energy() const {
  Panel audit{"Passivity: energy the device dissipated less energy its motors returned", "P [mJ]", {}, {}, {}, {}};
  audit.series = {audit_mJ_.series("audit P", colour::kAudit)};
  audit.references = {{0, "passive above"}};
  Panel ledger{"Ledger: energy the law may spend", "E [mJ]", {}, {}, {}, {}};
  ledger.series = {ledger_mJ_.series("ledger", colour::kLedger)};
  return {{}, {}, "time [s]", {std::move(audit), std::move(ledger)}};
}

Figure RunFigures::timing() const {
  Panel network{"Age of the force at the device, and round trip", "time [ms]", {}, {}, 0.0, {}};
  network.series = {round_trip_ms_.series("round trip", colour::kRoundTrip),
                    age_ms_.series("force age", colour::kNetwork)};
  Panel period{"Tick", "time [ms]", {}, {}, 0.0, {}};
  period.series = {period_ms_.series("period", colour::kApplied),
                   latency_ms_.series("reading to command", colour::kLedger)};
  return {{}, {}, "time [s]", {std::move(network), std::move(period)}};
}

std::vector<std::filesystem::path> RunFigures::draw_into(const std::filesystem::path& directory) const {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (!std::filesystem::is_directory(directory)) {
    throw std::runtime_error("cannot create the directory '" + directory.string() +
                             "' for figures: " + (error ? error.message() : "a file has that name"));
  }
  std::vector<std::filesystem::path> files;
  for (auto& [name, figure] : {std::pair{"motion.png", motion()}, std::pair{"force.png", force()},
                               std::pair{"energy.png", energy()}, std::pair{"timing.png", timing()}}) {
    Figure titled = figure;
    titled.title = info_.law + (info_.scene.empty() ? "" : " on " + info_.scene);
    titled.subtitle =
        info_.device + ", " + info_.operator_name + (info_.network.empty() ? "" : ", network: " + info_.network);
    draw(titled, directory / name);
    files.push_back(directory / name);
  }
  return files;
}

}  // namespace forcebound::lab
