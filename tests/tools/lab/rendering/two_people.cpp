#include "tests/tools/lab/rendering/two_people.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "forcebound/device/simulated/smooth_step.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "forcebound/text/numbers.hpp"
#include "tests/tools/lab/accuracy/harmonic_hand.hpp"
#include "tests/tools/lab/trials/task.hpp"
#include "tests/tools/sim/firm_device.hpp"
#include "tests/tools/sim/shared_loop.hpp"

namespace forcebound::lab {
namespace {

using namespace std::chrono_literals;

constexpr std::chrono::seconds kWholeRun = 10s;
constexpr std::size_t kPeople = 2;
constexpr std::array<double, kPeople> kRoundTrips_ms{10, 80};
constexpr std::array<HandleMotion, kPeople> kMotions{{{.at_m = -0.02, .amplitude_m = 0.01, .frequency_Hz = 2},
                                                      {.at_m = 0.02, .amplitude_m = 0.01, .frequency_Hz = 1.3}}};

class HandleHand final : public device::Operator {
 public:
  explicit HandleHand(const HandleMotion& motion) : motion_(motion) {}

  std::string_view name() const noexcept override { return "handle"; }
  const device::Hand& hand() const noexcept override { return kFollowingHand; }
  int degrees_of_freedom() const noexcept override { return 3; }
  std::string description() const override { return "holds a handle and moves it along x"; }

  Target target(double time_s) const noexcept override {
    constexpr double kBegin_s = 3;
    constexpr double kTakes_s = 0.5;
    const device::SmoothStep step = device::smooth_step((time_s - kBegin_s) / kTakes_s);
    const double turn_rad_per_s = 2 * std::numbers::pi * motion_.frequency_Hz;
    const double angle = turn_rad_per_s * kTakes_s * step.integral;
    Target to{.position = control::Vector::Zero(3), .velocity = control::Vector::Zero(3)};
    to.position[0] = motion_.at_m + motion_.by_m * step.value + motion_.amplitude_m * std::sin(angle);
    to.velocity[0] =
        motion_.by_m * step.slope / kTakes_s + motion_.amplitude_m * turn_rad_per_s * step.value * std::cos(angle);
    return to;
  }

 private:
  HandleMotion motion_;
};

/// Forces along x, a tick each.
class ForceLog final : public record::TickSink {
 public:
  void on_tick(const record::TickRecord& tick) noexcept override {
    forces_N.push_back(tick.applied.rows() > 0 ? tick.applied[0] : 0);
    deviation_m = std::max(deviation_m, tick.model_deviation_m);
  }

  std::vector<double> forces_N;
  double deviation_m = 0;
};

struct HandleRun {
  std::array<ForceLog, kPeople> people{};
  std::array<double, kPeople> minimum_J{};
};

HandleRun play_handles(const TwoPeopleSettings& settings, bool through_networks, bool local, std::uint64_t seed) {
  HandleRun run;
  sim::SharedLoop::Settings loop_settings{
      .scene = block_with_two_handles(), .law = settings.law, .people = {}, .seed = seed};
  for (std::size_t i = 0; i < kPeople; ++i) {
    sim::SharedLoop::Person person{.device = sim::firm_device(), .make_hand = handle_hand(kMotions.at(i))};
    if (through_networks) {
      person.network = network_of("delay " + text::to_text(kRoundTrips_ms.at(i) / 2) + "ms " +
                                  text::to_text(kRoundTrips_ms.at(i) / 20) + "ms loss 5%")
                           .settings;
    }
    person.network.seed = kPeople * seed + i;
    person.renders_locally = local;
    person.sink = &run.people.at(i);
    loop_settings.people.push_back(std::move(person));
  }
  sim::SharedLoop loop(loop_settings);
  loop.run(kWholeRun);
  for (std::size_t i = 0; i < kPeople; ++i) run.minimum_J.at(i) = loop.device(i).audit().value().minimum_J;
  return run;
}

double rms_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, values.size())));
}

double rms_between(const std::vector<double>& values, const std::vector<double>& others) {
  std::vector<double> apart;
  for (std::size_t i = 0; i < std::min(values.size(), others.size()); ++i) apart.push_back(values[i] - others[i]);
  return rms_of(apart);
}

double impulse_left(const HandleRun& run) {
  double sum = 0;
  double magnitudes = 0;
  for (const ForceLog& person : run.people) {
    for (const double force_N : person.forces_N) {
      sum += force_N;
      magnitudes += std::abs(force_N);
    }
  }
  return magnitudes > 0 ? std::abs(sum) / magnitudes : 0;
}

void add_run(TwoPeopleRow& row, const HandleRun& run, const HandleRun& without_network, double share) {
  row.impulse += share * impulse_left(run);
  for (std::size_t i = 0; i < kPeople; ++i) {
    const ForceLog& felt = run.people.at(i);
    const ForceLog& reference = without_network.people.at(i);
    HandleFigures& figures = row.people.at(i);
    figures.force_N += share * rms_of(felt.forces_N);
    figures.error += share * rms_between(felt.forces_N, reference.forces_N) / rms_of(reference.forces_N);
    figures.minimum_J = std::min(figures.minimum_J, run.minimum_J.at(i));
    figures.deviation_m = std::max(figures.deviation_m, felt.deviation_m);
  }
}

}  // namespace

std::shared_ptr<const scene::Scene> block_with_two_handles() {
  return server::parse_scene(R"(
[scene]
name = 'block'
description = ''
degrees_of_freedom = 3
shared = true
clients_max = 2
[[body]]
name = 'block'
probes = ['left', 'right']
stiffness_N_per_m = 600
damping_N_s_per_m = 4
mjcf_text = '''
<mujoco>
  <option timestep="0.001" gravity="0 0 0"/>
  <worldbody>
    <body name="block">
      <joint type="slide" axis="1 0 0"/>
      <joint type="slide" axis="0 1 0"/>
      <joint type="slide" axis="0 0 1"/>
      <geom type="box" size="0.01 0.01 0.01" mass="0.2"/>
      <body name="left" pos="-0.02 0 0">
        <geom type="sphere" size="0.005" mass="0.01"/>
      </body>
      <body name="right" pos="0.02 0 0">
        <geom type="sphere" size="0.005" mass="0.01"/>
      </body>
    </body>
  </worldbody>
</mujoco>
'''
)",
                             "block.toml");
}

std::function<std::unique_ptr<const device::Operator>()> handle_hand(const HandleMotion& motion) {
  return [motion] { return std::make_unique<const HandleHand>(motion); };
}

std::vector<TwoPeopleRow> study_two_people(const TwoPeopleSettings& settings) {
  std::vector<TwoPeopleRow> rows{{.local = false}, {.local = true}};
  const double share = 1 / static_cast<double>(settings.seeds);
  for (std::uint64_t seed = 1; seed <= settings.seeds; ++seed) {
    const HandleRun without_network = play_handles(settings, false, false, seed);
    for (TwoPeopleRow& row : rows) add_run(row, play_handles(settings, true, row.local, seed), without_network, share);
  }
  return rows;
}

std::string two_people_table(const TwoPeopleSettings& settings, const std::vector<TwoPeopleRow>& rows) {
  std::string table = "Two people on one block, law " + settings.law + ", " + std::to_string(settings.seeds) +
                      " seeds, virtual time:\n\n"
                      "                       force  error    least deviates  impulse\n"
                      "                         [N]          P [nJ]     [mm]     left\n";
  for (const TwoPeopleRow& row : rows) {
    for (std::size_t i = 0; i < kPeople; ++i) {
      const HandleFigures& one = row.people.at(i);
      table += fmt::format("  {:6} at {:2.0f} ms {:9.3f} {:6.3f} {:8.2f} {:8.2f}", row.local ? "local" : "remote",
                           kRoundTrips_ms.at(i), one.force_N, one.error, 1e9 * one.minimum_J, 1e3 * one.deviation_m);
      if (i == 0) table += fmt::format(" {:8.3f}", row.impulse);
      table += "\n";
    }
  }
  return table +
         "\n  force    RMS of what was applied along x\n"
         "  error    RMS of the difference from the run without networks, over the RMS there\n"
         "  deviates the farthest that the block at the client was from where the server had it then\n"
         "  impulse  both people's together over the sum of their magnitudes: what a block leaves that is at rest\n";
}

}  // namespace forcebound::lab
