#include "tests/tools/lab/soak/invariants.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/tools/lab/soak/ledger_in_long_double.hpp"

namespace forcebound::lab {
namespace {

using testing::HasSubstr;

/// A case whose ledger can be recomputed, and a tick of it that breaks no invariant.
class InvariantsTest : public testing::Test {
 protected:
  InvariantsTest() {
    while (case_.settings.device.facts.damping.rows() != 1 || !case_.settings.device.facts.actuator_step.isZero(0) ||
           !LedgerInLongDouble::make(case_.settings)) {
      case_ = draw_soak_case(case_.seed + 1, "fba-less");
    }
    tick_.tick = 1;
    tick_.position = tick_.joint = control::Vector::Zero(1);
    tick_.request = control::Vector::Constant(1, 0.5);
    tick_.applied = control::Vector::Zero(1);
  }

  std::string broken_by(const std::function<void(record::TickRecord&)>& change, bool passive = true) {
    case_.passive = passive;
    Invariants invariants(case_);
    record::TickRecord tick = tick_;
    change(tick);
    invariants.on_tick(tick);
    return invariants.broken();
  }

  SoakCase case_ = draw_soak_case(1, "fba-less");
  record::TickRecord tick_;
};

TEST_F(InvariantsTest, HoldForATickAtRest) {
  EXPECT_EQ(broken_by([](record::TickRecord&) {}), "");
}

TEST_F(InvariantsTest, FindWhateverIsNotFinite) {
  EXPECT_THAT(broken_by([](auto& tick) { tick.applied[0] = std::nan(""); }), HasSubstr("not finite"));
  EXPECT_THAT(broken_by([](auto& tick) { tick.energy_J = INFINITY; }), HasSubstr("not finite"));
  EXPECT_THAT(broken_by([](auto& tick) { tick.audit_J = std::nan(""); }), HasSubstr("not finite"));
}

TEST_F(InvariantsTest, FindAForceBeyondTheDeviceOrTheRequest) {
  const double most = case_.settings.device.facts.force_N_max;
  EXPECT_THAT(broken_by([&](auto& tick) { tick.applied[0] = tick.request[0] = 1.01 * most; }),
              HasSubstr("above the device's largest"));
  EXPECT_THAT(broken_by([](auto& tick) { tick.applied[0] = 0.6; }), HasSubstr("shortened"));
  EXPECT_THAT(broken_by([](auto& tick) { tick.applied[0] = -0.1; }), HasSubstr("shortened"));
  EXPECT_EQ(broken_by([](auto& tick) { tick.applied[0] = 0.4; }), "");
}

TEST_F(InvariantsTest, FindReturnedEnergyOfALawThatGuaranteesPassivity) {
  const auto leak = [](auto& tick) { tick.audit_minimum_J = -1e-3; };
  EXPECT_THAT(broken_by(leak), HasSubstr("P fell to -0.001"));
  EXPECT_EQ(broken_by(leak, false), "") << "a law without guarantees";
}

TEST_F(InvariantsTest, FindALedgerAboveTheAudit) {
  const auto invented = [](auto& tick) { tick.energy_J = 1e-3; };
  EXPECT_THAT(broken_by(invented), HasSubstr("the ledger has"));
  EXPECT_THAT(broken_by(invented, false), HasSubstr("its recomputation 0 J"));
}

TEST_F(InvariantsTest, FindCountsThatDoNotAddUp) {
  const auto broken = [&](const record::RunTotals& totals, const server::ServerCounters& server, bool active = true) {
    case_.passive = true;
    Invariants invariants(case_);
    record::TickRecord tick = tick_;
    tick.motion_sequence = 1;
    invariants.on_tick(tick);
    invariants.on_force({});
    invariants.finish(totals, active, server);
    return invariants.broken();
  };
  record::RunTotals totals;
  totals.sent = 1;
  totals.received = 1;
  server::ServerCounters server;
  server.motions_received = 1;
  server.forces_sent = 1;
  EXPECT_EQ(broken(totals, server), "");
  EXPECT_THAT(broken(totals, server, false), HasSubstr("did not come back"));
  totals.lost_up = 1;
  EXPECT_THAT(broken(totals, server), HasSubstr("do not add up: 1 sent = 1 answered + 0 unanswered + 1 lost up"));
  totals.lost_up = 0;
  server.motions_received = 0;
  EXPECT_THAT(broken(totals, server), HasSubstr("counted as lost"));
  server.motions_received = 1;
  server.motions_superseded = 1;
  EXPECT_THAT(broken(totals, server), HasSubstr("1 not answered by the server"));
  server.motions_superseded = 0;
  totals.sent = 2;
  EXPECT_THAT(broken(totals, server), HasSubstr("2 motions sent, ticks sent 1"));
}

}  // namespace
}  // namespace forcebound::lab
