#include "tests/tools/lab/comparison/trial.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <unordered_map>
#include <utility>
#include <vector>

#include "forcebound/control/damping.hpp"
#include "forcebound/control/force_bounder.hpp"
#include "forcebound/law_plugin/known_laws.hpp"
#include "forcebound/record/running_statistics.hpp"
#include "tests/tools/lab/accuracy/device_run.hpp"
#include "tests/tools/lab/accuracy/reference_model.hpp"
#include "tests/tools/lab/trials/measures.hpp"
#include "tests/tools/lab/trials/percentile.hpp"

namespace forcebound::lab {
namespace {

// A contact that has not come to rest in this share of its time never does; one that shows less than this share of the
// wall's stiffness is no contact: zero force does not count as rest.
constexpr double kTrialRingingMost = 0.75;
constexpr double kShownLeast = 0.01;

/// Distance between the device and the position at which the environment is asked.
class DriftMeter final : public record::TickSink {
 public:
  void on_tick(const record::TickRecord& tick) noexcept override {
    if (tick.motion_sequence != 0) add(tick.motion_sequence, tick.position);
  }
  void on_force(const record::ForceRecord& record) noexcept override {
    add(record.force.motion_sequence, record.force.position);
  }

  double most_m = 0;

 private:
  void add(std::uint64_t motion, const control::Vector& place) noexcept {
    const control::Vector& before = places_.try_emplace(motion, place).first->second;
    if (before.rows() == place.rows()) most_m = std::max(most_m, (place - before).norm());
  }

  // For each motion, the device's position and the requested one, whichever came first: an answer without delay comes
  // before its own tick ends.
  std::unordered_map<std::uint64_t, control::Vector> places_;
};

/// Variation of the force on the device from some time after the first contact on, in contact or not: a device that
/// bounces off the wall again and again is not at rest.
class RestMeter final : public record::TickSink {
 public:
  explicit RestMeter(double settle_s) : settle_(time::from_seconds(settle_s)) {}
  void on_tick(const record::TickRecord& tick) noexcept override {
    if (!contact_ && tick.contact) contact_ = tick.time;
    if (contact_ && tick.time >= *contact_ + settle_) force_N_.add(tick.applied.norm());
  }

  [[nodiscard]] double restlessness() const { return std::sqrt(force_N_.variance()) / force_N_.mean(); }

 private:
  time::Nanoseconds settle_;
  std::optional<time::Nanoseconds> contact_;
  record::RunningStatistics force_N_;
};

/// Records a law's inputs, to replay them.
class Questions final : public record::TickSink {
 public:
  void on_tick(const record::TickRecord& tick) noexcept override { ticks.push_back(tick); }
  std::vector<record::TickRecord> ticks;
};

double number(const nlohmann::json& summary, const char* path) {
  const auto& value = summary.at(nlohmann::json::json_pointer(path));
  return value.is_number() ? value.get<double>() : std::nan("");
}

}  // namespace

Trial run_trial(const TrialSetup& setup) {
  Trial trial;
  sim::ClosedLoop::Settings settings = settings_of(setup);
  trial.refused = law_plugin::known_laws().refusal(setup.law, settings.device.facts, settings.law_options);
  if (!trial.refused.empty()) return trial;
  RingingMeter ringing;
  DirectionMeter direction;
  DriftMeter drift;
  RestMeter rest(settings.settle_s);
  const ReferenceModel reference(settings.scene, 0, "closed form");
  DeviceRun run = run_device(std::move(settings), setup.task.duration_s, {&ringing, &direction, &drift, &rest});
  reference.fill_in(run);

  trial.passivity_minimum_J = run.passivity_minimum_J;
  trial.ringing_s = ringing.ringing_s();
  // Without contact the displayed stiffness is 0; without rest it is undefined.
  const bool touched = number(run.summary, "/contact_ticks") > 0;
  trial.shown_N_per_m = touched ? number(run.summary, "/displayed_stiffness_N_per_m/median") : 0;
  trial.calm = trial.ringing_s && *trial.ringing_s < kTrialRingingMost * ringing.contact_s() &&
               trial.shown_N_per_m >= kShownLeast * setup.stiffness_N_per_m;
  trial.force_N_mean = number(run.summary, "/force_N/mean");
  trial.force_N2_variance = number(run.summary, "/force_N/variance");
  trial.restlessness = rest.restlessness();
  trial.error = device_error(run.ticks).total;
  trial.direction_error_rad = direction.error_rad_max();
  trial.law_faults = run.law_faults;
  trial.drift_m = drift.most_m;
  return trial;
}

double work_ns(const TrialSetup& setup, const time::Clock& clock) {
  sim::ClosedLoop::Settings settings = settings_of(setup);
  const control::DeviceFacts facts = settings.device.facts;
  const control::LawRegistry laws = law_plugin::known_laws();
  if (!facts.cartesian || laws.find(setup.law).make_server_side) return std::nan("");
  auto law = laws.make(setup.law, facts, settings.law_options);
  const auto damping = control::Damping::from_matrix(facts.damping);
  Questions questions;
  sim::ClosedLoop loop(std::move(settings), {&questions});
  loop.run(time::from_seconds(setup.task.duration_s));

  control::Motion motion;
  motion.latency_s_max = facts.latency_s;
  motion.jacobian = control::Matrix::Identity(facts.damping.rows(), facts.damping.rows());
  motion.damping = &damping;
  // Many ticks at once, so that reading the clock does not count.
  constexpr std::size_t kBatch = 200;
  std::vector<double> each_ns;
  for (std::size_t begin = 0; begin + kBatch <= questions.ticks.size(); begin += kBatch) {
    const time::Nanoseconds start = clock.now();
    for (std::size_t i = begin; i < begin + kBatch; ++i) {
      const record::TickRecord& tick = questions.ticks[i];
      motion.interval_s = time::to_seconds(tick.interval);
      motion.position = tick.position;
      motion.joint = tick.joint;
      law->credit(motion);
      law->commit(law->bound(tick.request));
    }
    each_ns.push_back(static_cast<double>((clock.now() - start).count()) / kBatch);
  }
  return percentile(std::move(each_ns), 0.5);
}

}  // namespace forcebound::lab
