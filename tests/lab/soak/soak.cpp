#include "tests/lab/soak/soak.hpp"

#include "tests/lab/soak/invariants.hpp"
#include "tests/lab/soak/soak_case.hpp"

namespace forcebound::lab {
namespace {

/// Counts late ticks, and stops nothing.
class LateTicks final : public record::TickSink {
 public:
  explicit LateTicks(time::Nanoseconds period) : limit_(period + record::kLateBy) {}
  void on_tick(const record::TickRecord& tick) noexcept override { count += tick.interval > limit_; }
  void on_force(const record::ForceRecord&) noexcept override {}
  std::uint64_t count = 0;

 private:
  time::Nanoseconds limit_;
};

}  // namespace

SoakResult soak(std::uint64_t seed, const std::string& law) {
  const SoakCase drawn = draw_soak_case(seed, law);
  Invariants invariants(drawn, law == "fba-exact");
  LateTicks late(time::from_seconds(drawn.settings.device.facts.period_s));
  sim::ClosedLoop loop(drawn.settings, {&invariants, &late});
  loop.run(drawn.duration);
  const bool active = loop.session().state() == record::SessionState::active;
  (void)loop.close();
  const record::RunTotals totals = loop.totals();
  invariants.finish(totals, active, loop.server()->counters());
  return {.broken = invariants.broken(),
          .environment = drawn.environment,
          .worst_P_J = invariants.worst_P_J(),
          .virtual_s = time::to_seconds(drawn.duration),
          .ticks = invariants.ticks(),
          .recomputed = invariants.recomputed(),
          .late_ticks = late.count,
          .released = totals.released_by_device,
          .withdrawn = totals.withdrawn_forces,
          .reconnects = totals.reconnects,
          .lost = totals.lost_up + totals.lost_down};
}

}  // namespace forcebound::lab
