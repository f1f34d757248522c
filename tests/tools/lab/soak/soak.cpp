#include "tests/tools/lab/soak/soak.hpp"

#include <array>
#include <bit>
#include <vector>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/control/law_registry.hpp"
#include "tests/tools/lab/soak/invariants.hpp"
#include "tests/tools/lab/soak/soak_case.hpp"
#include "tests/tools/sim/draw.hpp"

namespace forcebound::lab {
namespace {

/// Counts late ticks, and hashes all ticks (FNV-1a).
class Witness final : public record::TickSink {
 public:
  explicit Witness(time::Nanoseconds period) : limit_(period + record::kLateBy) {}
  void on_tick(const record::TickRecord& tick) noexcept override {
    late += tick.interval > limit_;
    note(tick.time.count());
    for (const double value : tick.applied) note(value);
    for (const double value : tick.joint) note(value);
    note(tick.energy_J);
    note(tick.audit_J);
  }
  void on_force(const record::ForceRecord& force) noexcept override { note(force.receive_time.count()); }

  std::uint64_t late = 0;
  std::uint64_t digest = 0xcbf29ce484222325;

 private:
  template <typename Value>
  void note(const Value& value) noexcept {
    for (const unsigned char byte : std::bit_cast<std::array<unsigned char, sizeof(Value)>>(value)) {
      digest = (digest ^ byte) * 0x100000001b3;
    }
  }

  time::Nanoseconds limit_;
};

}  // namespace

std::string law_of(std::uint64_t seed) {
  const std::vector<std::string> laws = baselines::shipped_laws().names();
  // Another stream than the case's own, so that the case does not depend on the law.
  return laws[sim::Draw(~seed).index(laws.size())];
}

SoakResult soak(std::uint64_t seed, const std::string& law) {
  const SoakCase drawn = draw_soak_case(seed, law);
  Invariants invariants(drawn);
  Witness witness(time::from_seconds(drawn.settings.device.facts.period_s));
  sim::ClosedLoop loop(drawn.settings, {&invariants, &witness});
  loop.run(drawn.duration);
  const bool active = loop.session().state() == client::SessionState::active;
  (void)loop.close();
  const record::RunTotals totals = loop.totals();
  invariants.finish(totals, active, loop.server()->counters());
  return {.broken = invariants.broken(),
          .environment = drawn.environment,
          .passive = drawn.passive,
          .beyond_bounds = drawn.beyond_bounds,
          .least_P_J = invariants.least_P_J(),
          .digest = witness.digest,
          .virtual_s = time::to_seconds(drawn.duration),
          .ticks = invariants.ticks(),
          .recomputed = invariants.recomputed(),
          .late_ticks = witness.late,
          .released = totals.released_by_device,
          .withdrawn = totals.withdrawn_forces,
          .reconnects = totals.reconnects,
          .lost = totals.lost_up + totals.lost_down};
}

}  // namespace forcebound::lab
