#pragma once

#include <optional>
#include <string>

#include "forcebound/control/enum_array.hpp"
#include "forcebound/control/follower_state.hpp"
#include "forcebound/record/displayed_stiffness.hpp"
#include "forcebound/record/histogram.hpp"
#include "forcebound/record/run_info.hpp"
#include "forcebound/record/running_statistics.hpp"
#include "forcebound/record/tick_record.hpp"
#include "forcebound/text/terminal.hpp"

namespace forcebound::record {

/// The results of a run, accumulated from its ticks and forces. The live client and a report from its recording use
/// this same class, so they agree.
///
/// The numbers, by their JSON key:
///
/// - `duration_s`: from the first tick's reading to the last one's. `ticks`: how many.
/// - `period_us`: time between readings. `late_ticks`: those more than 0.5 ms above the nominal period.
/// - `idle_timer`: the same for a thread that only sleeps, at the same time on the same machine.
/// - `sent received lost duplicated reordered`: datagrams of motion and force, both directions together, as the session
///   counted them; `lost_up` (motions) and `lost_down` (forces) apart. *Duplicated* are further copies of one that
///   arrived. *Reordered* are those that arrived after a newer one of their direction. When a killed process left no
///   totals (`complete` is false), `sent` and `received` are counted from the records, and the rest is unknown.
/// - `motions`: the outcome of each, by the counts of both ends: `sent` = `answered` + `unanswered` (the server
/// received
///   them, but they were reordered, or a newer one waited when it came to them, or the session ended) + `lost_up` +
///   `lost_down` (their answers) + `in_flight` (still on their way at the end, which the other `lost_up` counts as
///   lost).
/// - `stale_ticks`: ticks on which the late-force policy faded or dropped the force; `late_force` says which, and how
///   often the policy changed.
/// - `rendering`: where the requested force was computed, as shares of the ticks: `at_client` by the scene at the
///   client and by local models of the rest, `both` by these and by the server, `held` by the server alone; `modelled`
///   are those of the ticks on which a local model counted. `model_trust`: mean share of the models that counted, over
///   the ticks whose newest answer had models; null: none had. `asked`, of the server, is "local" or "remote", and
///   "remote" with any law that has a server-side law; `scene_pieces` and `scene_piece_bytes` count what was received
///   of scenes; `scenes_from_cache` came from the cache instead.
/// - `encryption`: of the datagrams, by the handshake's pattern: "IKpsk2", "NNpsk0", or "none"; null: the program that
///   made the recording did not say.
/// - `server_clock_ms`: how far the server's clock is `ahead` of the client's at the end, and by how much that may be
///   `off`, from the least delays of both ways; null: not known.
/// - `force_age_ms`: on each tick that has any force, the time since the reading that the newest force answers.
/// - `blackouts`: times without any new force for longer than the policy's hold time, after the first force.
///   `longest` tells what both ends counted in the longest of them (`motions` made and `lost_up` on the way, `answers`
///   sent and `lost_down`) and so what had `died`: up, down, both, neither (late, not lost), server (it said Bye), or
///   unknown, where the counts are null. The same in words is among the `notes`.
/// - `rtt_us`: from the reading of a motion to the arrival of its answer. `compute_us`: the server's time on the scene.
///   `stages_us` attributes the rest without synchronised clocks: `network` is the round trip less the server's time,
///   both ways together; `server` what the server took beside computing; `wait` from arrival until a tick used the
///   force.
/// - `follower`: of a robot at the far end, null without one: the `state` that the newest answer told, `changes` of it,
///   and for how long it was in which (`seconds`, by the state's name). A state counts until the next answer, for
///   0.1 s at most; the rest is `unknown_s`, as nothing was heard of the robot.
/// - `tick_latency_us`: from the reading to the command.
/// - `contact_ticks`: those on which the device touched the surface, or, where that is not known, the newest answer had
///   touched it. `surface_unknown_ticks`: those on which the surface was not known.
/// - `force_N`: of the applied force's magnitude: `mean` and (population) `variance` over the ticks in contact, and
///   `max` over all ticks. `penetration_m` likewise, over those of them on which it is known: in a simulation it is
///   that of the device's true position in the scene (`run.surface` is "true"); otherwise that below the plane of the
///   newest answer, within 1 mm of where that answer was computed and nowhere else ("plane").
/// - `displayed_stiffness_N_per_m`: see DisplayedStiffness, on ticks at rest or quasi-static only: component of the
///   applied force out of the surface over the penetration. `median` takes negative values as zero and is exact to
///   0.05 %.
/// - `at_rest`: on those ticks: `fraction` of the ticks in contact, `force_N` and `penetration_m` their medians,
///   `speed_m_per_s_max` the limit on the change of depth at rest.
/// - All of these leave out the first `settle_s` after the first contact (but `max` does not).
/// - `bounded_fraction`: share of the ticks on which the law reduced the force: the applied force differs from the
///   request, cut at the device's largest force, by more than 1e-12 of it and by more than the actuator's rounding.
/// - `verdict`: "passive", "not passive", or why there is none: "not audited", "no contact" (the device touched nothing
///   and no force was ever applied), "never connected".
/// - `passivity`: the device's own audit P: `minimum_J`, the least P of the run, and `final_J` at the last tick; both
///   null for a device without audit. `ok`: false if the least P is below -1e-9 J or not a number, true if not; null
///   where there is no verdict. `guarantee`: what the law guarantees without an audit, and under which facts; null:
///   nothing. `ledger.final_J`: energy that the law may still spend.
/// - `faults`: counts of what should not happen, and `notes` in words.
///
/// A number that is unknown or not finite is null.
///
/// Real time: `on_tick` and `on_force` are noexcept and allocate nothing. Not thread-safe.
class Summary final : public TickSink {
 public:
  explicit Summary(RunInfo info) : info_(std::move(info)), displayed_(info_.stiffness_depth_m_min) {}

  void on_tick(const TickRecord& tick) noexcept override;
  void on_force(const ForceRecord& force) noexcept override;

  /// The end of the run; without it the session's counts are missing.
  void finish(RunTotals totals) { totals_ = std::move(totals); }

  /// One JSON object with the keys above, numbers in full.
  [[nodiscard]] std::string to_json() const;

  /// One screen of text, 80 columns wide; the first line has the verdict. Words of the recording are made printable.
  [[nodiscard]] std::string to_text(text::Colour colour = text::Colour::none) const;

  /// Whether its first line says NOT PASSIVE.
  [[nodiscard]] bool not_passive() const;
  [[nodiscard]] bool connected() const noexcept { return connected_; }

  /// Whether its first line says RECORDING INCOMPLETE: records are missing.
  [[nodiscard]] bool recording_incomplete() const;

  [[nodiscard]] const RunInfo& info() const noexcept { return info_; }

 private:
  friend struct SummaryView;  // reads everything, to print it

  void add_period(const TickRecord& tick) noexcept;
  void add_force_stream(const TickRecord& tick) noexcept;
  void add_contact(const TickRecord& tick) noexcept;
  void add_energy(const TickRecord& tick) noexcept;
  void add_follower(const ForceRecord& force) noexcept;

  RunInfo info_;
  std::optional<RunTotals> totals_;
  bool connected_ = false;  ///< once at least

  std::uint64_t ticks_ = 0;
  Nanoseconds first_{0};
  Nanoseconds last_{0};
  Histogram period_ns_;
  Histogram tick_latency_ns_;
  std::uint64_t late_ticks_ = 0;
  std::uint64_t sent_ = 0;

  std::uint64_t forces_ = 0;
  Nanoseconds arrival_{0};  ///< of the last force
  Histogram round_trip_ns_, compute_ns_, network_ns_, server_ns_, wait_ns_, age_ns_;
  std::uint64_t arrived_motion_ = 0;  ///< which motion the last force answers ...
  bool waiting_ = false;              ///< ... and whether a tick has used it yet
  control::FollowerState follower_ = control::FollowerState::none;
  bool has_follower_ = false;
  std::uint64_t follower_changes_ = 0;
  control::EnumArray<control::FollowerState, Nanoseconds, control::kFollowerStates> follower_times_{};
  Nanoseconds follower_unknown_{0};
  std::uint64_t fading_ticks_ = 0;
  std::uint64_t dropped_ticks_ = 0;
  std::uint64_t policy_changes_ = 0;
  ForcePolicy policy_ = ForcePolicy::none;
  std::uint64_t blackouts_ = 0;
  bool blackout_ = false;
  Nanoseconds blackout_longest_{0};

  std::optional<Nanoseconds> contact_;  ///< the first one
  std::uint64_t contact_ticks_ = 0;
  std::uint64_t unknown_ticks_ = 0;
  std::uint64_t settled_ticks_ = 0;  ///< in contact
  std::uint64_t rest_ticks_ = 0;     ///< of them
  DisplayedStiffness displayed_;
  RunningStatistics force_N_, penetration_m_, stiffness_;
  Histogram stiffness_mN_per_m_, rest_uN_, rest_nm_;
  double force_N_max_ = 0;
  double torque_N_m_max_ = 0;
  bool shows_torque_ = false;
  double penetration_m_max_ = 0;
  std::uint64_t bounded_ticks_ = 0;
  std::uint64_t at_client_ticks_ = 0;
  std::uint64_t both_ticks_ = 0;
  std::uint64_t modelled_ticks_ = 0;
  RunningStatistics model_trust_;

  double passivity_minimum_J_ = 0;
  double passivity_final_J_ = 0;
  double ledger_final_J_ = 0;
};

}  // namespace forcebound::record
