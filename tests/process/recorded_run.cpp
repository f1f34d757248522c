#include "tests/process/recorded_run.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "forcebound/client/session/late_force_policy.hpp"
#include "forcebound/control/law_registry.hpp"
#include "tests/process/passive.hpp"
#include "tests/support/becomes_true.hpp"

namespace forcebound::test {
namespace {

constexpr double kRounding = 1e-9;

/// Whether a recording has a tick for which the condition holds.
struct FirstTick final : record::RecordingSink {
  explicit FirstTick(const std::function<bool(const record::TickRecord&)>& wanted) : condition(wanted) {}

  void on_start(const record::RunInfo&) override {}
  void on_end(const record::RunTotals&) override {}
  void on_tick(const record::TickRecord& tick) noexcept override { found = found || condition(tick); }

  const std::function<bool(const record::TickRecord&)>& condition;
  bool found = false;
};

Words and_recording(Words words, const std::string& file) {
  words.insert(words.end(), {"--record", file});
  return words;
}

}  // namespace

void expect_late_force_policy(const RecordedRun& run) {
  const client::LateForcePolicy policy{.hold = run.info.hold, .drop = run.info.drop};
  for (const record::TickRecord& tick : run.ticks) {
    if (tick.force_sequence == 0) {
      EXPECT_TRUE(tick.applied.isZero(0)) << "tick " << tick.tick;
      continue;
    }
    const auto force = run.forces.find(tick.force_sequence);
    ASSERT_NE(force, run.forces.end()) << "tick " << tick.tick;
    const double scale = policy.scale(tick.force_age);
    EXPECT_LE((tick.request - scale * force->second).norm(), kRounding) << "tick " << tick.tick;
    EXPECT_LE(tick.applied.norm(), std::min(tick.request.norm(), run.info.force_N_max) + kRounding)
        << "tick " << tick.tick;
    EXPECT_EQ(static_cast<int>(tick.policy), static_cast<int>(policy.verdict(tick.force_age))) << "tick " << tick.tick;
    if (tick.policy == record::ForcePolicy::dropped) {
      EXPECT_TRUE(tick.applied.isZero(0)) << "tick " << tick.tick;
    }
    if (testing::Test::HasFailure()) return;
  }
}

void expect_passive(const RecordedRun& run) {
  ASSERT_FALSE(run.ticks.empty());
  // If the machine wakes the loop 50 ms late, a published law is not passive, as its proof assumes punctual ticks.
  if (run.info.law != "fba-exact") return;
  EXPECT_GE(run.ticks.back().audit_minimum_J, kPassive_J);
}

std::vector<std::string> shipped_among(const std::vector<std::string>& laws) {
  const std::vector<std::string> shipped = control::force_bounding_laws().names();
  std::vector<std::string> found;
  std::copy_if(laws.begin(), laws.end(), std::back_inserter(found),
               [&](const std::string& law) { return std::find(shipped.begin(), shipped.end(), law) != shipped.end(); });
  return found;
}

RecordedClient::RecordedClient(const std::string& server, const Words& arguments)
    : Client(server, and_recording(arguments, TemporaryFolder::file("run.mcap"))) {}

RecordedRun RecordedClient::run() const {
  RecordedRun run;
  EXPECT_TRUE(record::read_recording(recording(), run)) << "the recording is incomplete";
  return run;
}

bool RecordedClient::wait_for_tick(const std::function<bool(const record::TickRecord&)>& condition) const {
  using Clock = std::chrono::steady_clock;
  std::uintmax_t bytes = 0;
  Clock::time_point next{};
  return becomes_true([&] {
    const Clock::time_point begin = Clock::now();
    if (begin < next) return false;
    std::error_code not_there;
    const std::uintmax_t now = std::filesystem::file_size(recording(), not_there);
    if (not_there || std::exchange(bytes, now) == now) return false;
    FirstTick sink{condition};
    try {
      record::read_recording(recording(), sink);
    } catch (const std::runtime_error&) {  // its beginning is not written yet
    }
    // The programs need the processors more than this, which reads a longer file each time.
    const Clock::time_point end = Clock::now();
    next = end + 4 * (end - begin);
    return sink.found;
  });
}

}  // namespace forcebound::test
