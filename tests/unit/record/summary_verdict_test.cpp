#include "forcebound/record/summary.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "tests/unit/record/sample_ticks.hpp"

namespace forcebound::record {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

TEST(Summary, CallsPassiveOnlyWhatNeverFellBelowTheRounding) {
  for (const auto& [minimum, ok] : {std::pair{0.0, true}, {-0.9e-9, true}, {-1.1e-9, false}, {-0.004, false}}) {
    Summary summary(audited());
    TickRecord tick = connected(contact_at(1, 1, 1e-3));
    tick.audit_minimum_J = minimum;
    summary.on_tick(tick);
    tick.audit_minimum_J = 0;  // a later tick does not undo it
    summary.on_tick(tick);
    const json passivity = json_of(summary)["passivity"];
    EXPECT_EQ(passivity["ok"], ok) << minimum;
    EXPECT_EQ(passivity["minimum_J"], minimum);
    EXPECT_THAT(summary.to_text(), StartsWith(ok ? "Summary: passive; " : "Summary: NOT PASSIVE; ")) << minimum;
  }
}

TEST(Summary, NeverTakesAnAuditThatIsNotANumberForPassive) {
  Summary summary(audited());
  TickRecord tick = tick_at(1);
  tick.audit_minimum_J = std::numeric_limits<double>::quiet_NaN();
  summary.on_tick(tick);
  summary.on_tick(tick_at(2));
  const json object = json_of(summary);
  EXPECT_TRUE(object["passivity"]["minimum_J"].is_null());
  EXPECT_EQ(object["passivity"]["ok"], false);
  EXPECT_EQ(object["verdict"], "not passive");
}

TEST(Summary, DoesNotJudgeADeviceWithoutAudit) {
  RunInfo info;
  info.law = "fba-exact";
  info.guarantee = "P >= 0 as long as its damping is as said";
  Summary summary(info);
  summary.on_tick(connected(contact_at(1, 1, 1e-3)));
  const json object = json_of(summary);
  EXPECT_EQ(object["verdict"], "not audited");
  EXPECT_TRUE(object["passivity"]["ok"].is_null());
  EXPECT_TRUE(object["passivity"]["minimum_J"].is_null());
  EXPECT_EQ(object["passivity"]["guarantee"], info.guarantee);
  const std::string text = summary.to_text();
  EXPECT_THAT(text, StartsWith("Summary: not audited; "));
  EXPECT_THAT(text, HasSubstr("not audited: this device does not measure P"));
  EXPECT_THAT(text, Not(HasSubstr("least P")));
  EXPECT_THAT(text, Not(HasSubstr(": passive")));
}

TEST(Summary, HasNoVerdictOfARunThatTouchedNothing) {
  Summary summary(audited());
  for (std::uint64_t n = 1; n <= 10; ++n) summary.on_tick(connected(tick_at(n)));
  const json object = json_of(summary);
  EXPECT_EQ(object["verdict"], "no contact");
  EXPECT_TRUE(object["passivity"]["ok"].is_null());
  EXPECT_THAT(summary.to_text(), StartsWith("Summary: no contact, no verdict; "));
}

TEST(Summary, HasAVerdictForForcesWithoutASurface) {
  Summary summary(audited());
  TickRecord tick = connected(tick_at(1));
  tick.request = tick.applied = vector_of({1});
  summary.on_tick(tick);
  EXPECT_EQ(json_of(summary)["verdict"], "passive");
}

TEST(Summary, HasNoVerdictOfARunThatNeverConnected) {
  Summary summary(audited());
  for (std::uint64_t n = 1; n <= 10; ++n) summary.on_tick(tick_at(n));
  const json object = json_of(summary);
  EXPECT_EQ(object["verdict"], "never connected");
  EXPECT_TRUE(object["passivity"]["ok"].is_null());
  EXPECT_THAT(summary.to_text(), StartsWith("Summary: never connected, no verdict; "));
}

}  // namespace
}  // namespace forcebound::record
