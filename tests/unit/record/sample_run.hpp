#pragma once

#include <unistd.h>
#include <cmath>
#include <cstdint>

#include <algorithm>
#include <filesystem>
#include <string>

#include "forcebound/record/recording_reader.hpp"
#include "forcebound/record/recording_writer.hpp"
#include "forcebound/record/run_info.hpp"
#include "forcebound/record/tick_record.hpp"

namespace forcebound::record::test {

inline control::Vector vector_of(std::initializer_list<double> rows) {
  control::Vector vector(static_cast<Eigen::Index>(rows.size()));
  std::copy(rows.begin(), rows.end(), vector.data());
  return vector;
}

inline RunInfo sample_info() {
  RunInfo info;
  info.program = "forcebound-test 0.1.0";
  info.law = "fba-more";
  info.device = "wall-1dof";
  info.operator_name = "press";
  info.audited = true;
  info.device_simulated = true;
  info.hand = "0.08 kg, 150 N/m, 0.3 N s/m";
  info.scene = "sphere";
  info.simulated = "a sphere of radius 20 mm, 10 N/mm";
  info.encryption = "IKpsk2";
  info.seed = 18446744073709551615U;
  info.epoch = Nanoseconds{1'700'000'000'000'000'000};
  return info;
}

inline RunTotals sample_totals() {
  RunTotals totals;
  totals.sent = 5000;
  totals.received = 4700;
  totals.lost_up = 120;
  totals.lost_down = 150;
  totals.in_flight = 5;
  totals.unanswered = 30;
  totals.duplicated = 3;
  totals.reordered = 27;
  totals.malformed[wire::Malformed::corrupt] = 2;
  totals.longest_blackout = {.duration = std::chrono::milliseconds{399},
                             .over = true,
                             .counted = true,
                             .motions = 399,
                             .lost_up = 1,
                             .answers = 398,
                             .lost_down = 397};
  totals.notes = {"server restarted at 1.234 s", "second note"};
  return totals;
}

inline constexpr Nanoseconds kSampleStart{77'000'000'123};

/// A run as a client might write it down: three axes, contact from half of it on, one blackout, a fading force.
inline void play_sample_run(TickSink& sink, std::uint64_t ticks) {
  constexpr std::int64_t kStart = kSampleStart.count();
  for (std::uint64_t n = 1; n <= ticks; ++n) {
    const double t = static_cast<double>(n) * 1e-3;
    TickRecord tick;
    tick.tick = n;
    tick.time = Nanoseconds{kStart + static_cast<std::int64_t>(n) * 1'000'000 + static_cast<std::int64_t>(n % 7) * 911};
    tick.interval = Nanoseconds{1'000'000 + static_cast<std::int64_t>(n % 13) * 1003 + (n % 100 == 0 ? 700'000 : 0)};
    tick.latency = Nanoseconds{15'000 + static_cast<std::int64_t>(n % 31) * 57};
    tick.state = n < 10 ? SessionState::connecting : SessionState::active;
    tick.policy = n < 10 ? ForcePolicy::none : (n % 500 > 490 ? ForcePolicy::fading : ForcePolicy::fresh);
    tick.motion_sequence = n;
    tick.force_sequence = n < 10 ? 0 : n - 5;
    tick.force_age = Nanoseconds{5'000'000 + static_cast<std::int64_t>(n % 5) * 100'003};
    tick.position = vector_of({0.01 * std::sin(t), 0.02 * std::cos(3 * t), -0.003});
    tick.joint = tick.position;
    tick.penetration_m = n > ticks / 2 ? 1e-3 + 1e-4 * std::sin(20 * t) : -1e-3;
    tick.contact = tick.penetration_m > 0;
    tick.request = vector_of({0, 0, n > ticks / 2 ? 3.0 + 0.1 * std::sin(50 * t) : 0.0});
    tick.applied = n % 3 == 0 ? control::Vector(0.5 * tick.request) : tick.request;
    tick.displayed_N = tick.applied[2];
    tick.energy_J = 1e-3 * std::abs(std::sin(t)) / 3;
    tick.xi = 0.25;
    tick.audit_J = 1e-4 * t;
    tick.audit_minimum_J = 0;
    if (n > ticks / 2) {
      tick.rendering = n % 4 == 0 ? ForceOrigin::both : ForceOrigin::at_client;
      tick.remote = vector_of({0, 0, 2.5});
      tick.local = vector_of({0, 0.5, 1});
      tick.local_scene = 3;
      tick.local_scene_age = Nanoseconds{static_cast<std::int64_t>(n) * 1'000'000};
      tick.model = vector_of({0, 0, 1.5});
      tick.model_deviation_m = 1e-4;
      tick.model_trust = 0.75;
      tick.request_torque_N_m = vector_of({0.1, -0.2, 0.3});
      tick.applied_torque_N_m = vector_of({0.01, -0.02, 0.03});
      tick.handle = {.buttons = n % 2 == 0 ? 1U : 0U, .gripper = 0.25, .orientation = {{0.6, 0, -0.8, 0}}};
    }
    const bool blackout = n > 1000 && n < 1400;
    if (n >= 10 && !blackout) {
      ForceRecord force;
      force.receive_time = tick.time;
      force.round_trip = Nanoseconds{5'000'000 + static_cast<std::int64_t>(n % 11) * 12'345};
      force.force.session = 0xfedcba9876543210U;
      force.force.sequence = n - 9;
      force.force.motion_sequence = n - 5;
      force.force.motion_device_time = tick.time - force.round_trip;
      force.force.answer.force = tick.request;
      force.force.position = tick.position;
      force.force.answer.contact_normal = vector_of({0, 0, 1});
      force.force.answer.penetration_m = tick.penetration_m;
      force.force.server_receive_time = Nanoseconds{static_cast<std::int64_t>(n) * 1'000'000};
      force.force.server_send_time = force.force.server_receive_time + Nanoseconds{23'000};
      force.force.compute_time = Nanoseconds{4'000 + static_cast<std::int64_t>(n % 17) * 10};
      force.force.motions_received = n;
      sink.on_force(force);
    }
    sink.on_tick(tick);
  }
}

/// Writes directly, without a queue in between.
class DirectSink final : public TickSink {
 public:
  explicit DirectSink(RecordingWriter& writer) : writer_(writer) {}
  void on_tick(const TickRecord& tick) noexcept override { writer_.write(tick); }
  void on_force(const ForceRecord& force) noexcept override { writer_.write(force); }

 private:
  RecordingWriter& writer_;
};

/// A file that is removed after the test.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& name)
      : path_(std::filesystem::temp_directory_path() / ("forcebound-" + std::to_string(::getpid()) + "-" + name)) {}
  ~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace forcebound::record::test
