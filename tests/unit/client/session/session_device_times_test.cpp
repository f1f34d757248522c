// What a session makes of the times that a device reports.

#include <gtest/gtest.h>

#include "forcebound/client/session/session.hpp"
#include "forcebound/control/transparent_law.hpp"
#include "tests/unit/client/session/session_fixture.hpp"

namespace forcebound::client {
namespace {

struct WithNotedMotion {
  control::Motion noted;
};

/// No bound; notes what it is told.
class NotingLaw final : public control::PassivityLaw {
 public:
  NotingLaw(const control::DeviceFacts& facts, control::Motion& noted)
      : none_(facts.degrees_of_freedom(), facts.period_s), noted_(noted) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "noting"; }
  void credit(const control::Motion& motion) noexcept override { noted_ = motion; }
  void lose(const control::Motion& motion) noexcept override { noted_ = motion; }
  [[nodiscard]] Vector bound(const Vector& request_N) noexcept override { return request_N; }
  void commit(const Vector& force_N) noexcept override { none_.commit(force_N); }
  [[nodiscard]] double energy_J() const noexcept override { return 0; }

 private:
  control::TransparentLaw none_;
  control::Motion& noted_;
};

control::LawRegistry laws_with_noting(control::Motion& noted) {
  control::LawRegistry laws = baselines::shipped_laws();
  laws.add({.name = "noting",
            .summary = "notes the motion",
            .make = [&noted](const control::DeviceFacts& facts, const control::LawOptions&) {
              return std::make_unique<NotingLaw>(facts, noted);
            }});
  return laws;
}

class SessionOfADeviceThatReports : private WithNotedMotion, public SessionTest {
 protected:
  SessionOfADeviceThatReports() : SessionTest("noting", laws_with_noting(noted)) { tick(); }

  /// What the law is told on the tick after, by a device that reports these times after the command.
  const control::Motion& told(std::optional<Nanoseconds> effective, std::optional<Nanoseconds> released = {}) {
    const Nanoseconds commanded = device.applied_at;
    if (effective) device.effective = commanded + *effective;
    if (released) device.released = commanded + *released;
    tick();
    return noted;
  }
};

TEST_F(SessionOfADeviceThatReports, TellsTheLawWhenAForceTookEffect) {
  const control::Motion& motion = told(200us);
  EXPECT_NEAR(motion.effect_s, 200e-6, 1e-12);
  EXPECT_EQ(motion.latency_s, device.facts().latency_s) << "of the file";
}

TEST_F(SessionOfADeviceThatReports, CountsTheTimeHeldFromTheEffectThatTheFactsExpect) {
  const control::Motion& motion = told(200us, 700us);
  EXPECT_NEAR(motion.held_s, 700e-6, 1e-12);
}

TEST_F(SessionOfADeviceThatReports, CountsAnEffectBeforeItsCommand) {
  told(0us);
  EXPECT_EQ(session.totals().effects_outside_facts, 0U);
  told(-1us);
  EXPECT_EQ(session.totals().effects_outside_facts, 1U);
}

TEST_F(SessionOfADeviceThatReports, CountsWhatItsFileDoesNotAllow) {
  told(200us, 700us);
  EXPECT_EQ(session.totals().effects_outside_facts, 1U) << "the file has no latency";
  EXPECT_EQ(session.totals().releases_outside_facts, 1U) << "and holds for 1 s";
}

}  // namespace
}  // namespace forcebound::client
