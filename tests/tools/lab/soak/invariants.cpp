#include "tests/tools/lab/soak/invariants.hpp"

#include <cmath>
#include <variant>

#include "forcebound/control/classic_text.hpp"
#include "forcebound/control/translation.hpp"
#include "forcebound/control/wrench.hpp"
#include "tests/tools/lab/soak/ledger_in_long_double.hpp"

namespace forcebound::lab {
namespace {

// Rounding error of energies over a run.
constexpr double kEnergyTolerance_J = 1e-9;
constexpr double kForceRounding = 1e-12;
constexpr double kDirectionRounding = 1e-9;

/// Bursts are counted in datagrams: the few of a handshake may all be lost in one for long.
bool loses_in_bursts(const sim::SimulatedNetworkSettings& network) {
  const auto in_bursts = [](const netem::Loss& loss) {
    return std::holds_alternative<netem::GilbertElliottLoss>(loss);
  };
  return in_bursts(network.up.loss) || in_bursts(network.down.loss);
}

}  // namespace

Invariants::Invariants(const SoakCase& drawn) : case_(drawn), ledger_(LedgerInLongDouble::make(drawn.settings)) {}

Invariants::~Invariants() = default;

template <typename... Parts>
void Invariants::fail(const record::TickRecord& tick, const Parts&... parts) {
  if (!broken_.empty()) return;
  control::ClassicText text;
  text.precision(17);
  text << "tick " << tick.tick << " at " << time::to_seconds(tick.time) << " s: ";
  (text << ... << parts);
  broken_ = text.str();
}

void Invariants::on_tick(const record::TickRecord& tick) noexcept {
  ++ticks_;
  motions_ += tick.motion_sequence > 0;
  if (!tick.applied.allFinite() || !tick.applied_torque_N_m.allFinite() || !tick.position.allFinite() ||
      !std::isfinite(tick.energy_J) || !std::isfinite(tick.audit_J) || !std::isfinite(tick.xi)) {
    fail(tick, "not finite: force [", tick.applied.transpose(), "] N, torque [", tick.applied_torque_N_m.transpose(),
         "] N m, position [", tick.position.transpose(), "] m, energy ", tick.energy_J, " J, P ", tick.audit_J, " J");
  }
  check_force(tick);
  check_energy(tick);
}

void Invariants::check_force(const record::TickRecord& tick) {
  const control::DeviceFacts& facts = case_.settings.device.facts;
  if (const double size_N = tick.applied.norm(); size_N > facts.force_N_max * (1 + kForceRounding)) {
    fail(tick, "force of ", size_N, " N, above the device's largest of ", facts.force_N_max, " N");
  }
  if (const double size_N_m = tick.applied_torque_N_m.norm(); size_N_m > facts.torque_N_m_max * (1 + kForceRounding)) {
    fail(tick, "torque of ", size_N_m, " N m, above the device's largest of ", facts.torque_N_m_max, " N m");
  }
  const auto wrench = [&](const control::Vector& force_N, const control::Vector& torque_N_m) {
    return control::wrench_of(force_N, control::translation_of(torque_N_m), facts.rotations);
  };
  const control::Vector applied = wrench(tick.applied, tick.applied_torque_N_m);
  const control::Vector request = wrench(tick.request, tick.request_torque_N_m);
  const double size = applied.norm();
  if (!case_.shortens || size == 0 || !request.allFinite() || !facts.actuator_step.isZero(0)) return;
  const double asked = request.norm();
  const control::Vector aside = applied - request / asked * (applied.dot(request) / asked);
  if (size > asked * (1 + kForceRounding) || applied.dot(request) < 0 || aside.norm() > kDirectionRounding * size) {
    fail(tick, "force [", applied.transpose(), "] N is not the request [", request.transpose(), "] N shortened");
  }
}

void Invariants::check_energy(const record::TickRecord& tick) {
  least_P_J_ = std::min(least_P_J_, tick.audit_minimum_J);
  if (case_.passive && tick.audit_minimum_J < -kEnergyTolerance_J) {
    fail(tick, "P fell to ", tick.audit_minimum_J, " J");
  }
  if (case_.passive && tick.energy_J > tick.audit_J + kEnergyTolerance_J) {
    fail(tick, "the ledger has ", tick.energy_J, " J, the device dissipated ", tick.audit_J, " J");
  }
  if (!ledger_) return;
  const auto expected_J = static_cast<double>(ledger_->energy_J(tick));
  ++recomputed_;
  if (std::abs(tick.energy_J - expected_J) > kEnergyTolerance_J * (1 + std::abs(expected_J))) {
    fail(tick, "the ledger says ", tick.energy_J, " J, its recomputation ", expected_J, " J");
  }
}

void Invariants::finish(const record::RunTotals& totals, bool active, const server::ServerCounters& server) {
  record::TickRecord end;
  end.tick = ticks_;
  end.time = case_.duration;
  if (!active && !loses_in_bursts(case_.settings.network)) {
    fail(end, "the session did not come back after the last fault, at ", time::to_seconds(case_.last_fault));
  }
  if (totals.sent != motions_) fail(end, "counted ", totals.sent, " motions sent, ticks sent ", motions_);
  if (totals.received != forces_) fail(end, "counted ", totals.received, " forces, sinks saw ", forces_);
  const record::MotionFates fates = record::fates_of(totals);
  if (fates.sent != fates.answered + fates.unanswered + fates.lost_up + fates.lost_down + fates.in_flight) {
    fail(end, "the motions do not add up: ", record::words_of(fates));
  }
  if (totals.reconnects > 0 || !active) return;  // datagrams in flight to a dead server are not counted
  if (totals.sent != server.motions_received + totals.lost_up) {
    fail(end, totals.sent, " motions sent, but ", server.motions_received, " received by the server and ",
         totals.lost_up, " counted as lost");
  }
  if (server.forces_sent != totals.received + totals.lost_down) {
    fail(end, server.forces_sent, " forces sent by the server, but ", totals.received, " received and ",
         totals.lost_down, " counted as lost");
  }
  if (fates.unanswered != server.motions_unanswered()) {
    fail(end, fates.unanswered, " motions counted as unanswered, but ", server.motions_unanswered(),
         " not answered by the server");
  }
}

}  // namespace forcebound::lab
