#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "forcebound/record/recording_reader.hpp"
#include "tests/process/programs.hpp"

/// A client's recording, with checks of each of its ticks.
namespace forcebound::test {

struct RecordedRun final : record::RecordingSink {
  void on_start(const record::RunInfo& run) override { info = run; }
  void on_end(const record::RunTotals& run) override { totals = run; }
  void on_tick(const record::TickRecord& tick) noexcept override { ticks.push_back(tick); }
  void on_force(const record::ForceRecord& force) noexcept override {
    forces[force.force.motion_sequence] = force.force.answer.force;
  }

  record::RunInfo info;
  record::RunTotals totals;
  std::vector<record::TickRecord> ticks;
  std::map<std::uint64_t, control::Vector> forces;  ///< by the motion they answer
};

/// The applied force never exceeds the request, and the request is the newest force by the late-force policy: in full
/// up to the hold time, then fading linearly, zero from the drop time on.
void expect_late_force_policy(const RecordedRun& run);

/// The audit's minimum over the run is not below rounding, whatever the timing; for the law that guarantees it.
void expect_passive(const RecordedRun& run);

/// Those of the given laws that this build ships.
std::vector<std::string> shipped_among(const std::vector<std::string>& laws);

/// A client that records.
class RecordedClient : private TemporaryFolder, public Client {
 public:
  RecordedClient(const std::string& server, const Words& arguments);

  /// After its end.
  [[nodiscard]] RecordedRun run() const;

  /// Waits until its recording has a tick for which the condition holds.
  [[nodiscard]] bool wait_for_tick(const std::function<bool(const record::TickRecord&)>& condition) const;

  [[nodiscard]] std::string recording() const { return TemporaryFolder::file("run.mcap"); }
};

/// Conditions for a tick: a force is here; the hand is in contact.
inline bool is_answered(const record::TickRecord& tick) { return tick.force_sequence > 0; }
inline bool is_pressed(const record::TickRecord& tick) { return tick.applied.norm() > 0.1; }

/// Now, by the clock of the recordings.
inline time::Nanoseconds steady_now() { return std::chrono::steady_clock::now().time_since_epoch(); }

}  // namespace forcebound::test
