#include "tests/tools/lab/comparison/rate_study.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/make_operator.hpp"
#include "forcebound/results/draw.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/table.hpp"
#include "tests/tools/lab/comparison/trial.hpp"
#include "tests/tools/lab/comparison/workers.hpp"
#include "tests/tools/lab/trials/task.hpp"

namespace forcebound::lab {
namespace {

// Of 2b/T. A law that bounds displays less of a very stiff wall than of one that it just bounds.
constexpr std::array<double, 8> kMultiples{0.5, 0.9, 1.4, 2, 3, 4, 8, 16};

/// `press`, which suits a device of 30 N; on others its stiffness and damping are scaled with the force.
std::string hand_of(const std::string& device) {
  constexpr double kForce_N = 30;
  const control::DeviceFacts facts = device::load_device(device).facts;
  const device::Hand usual = device::make_operator("press", facts)->hand();
  const double share = facts.force_N_max / kForce_N;
  return "press:stiffness_N_per_m=" + text::rounded(share * usual.stiffness_N_per_m) +
         ",damping_N_s_per_m=" + text::rounded(share * usual.damping_N_s_per_m);
}

/// Asks for a wall and keeps it if it is displayed as the stiffest yet.
void press(const AtRate& at, double asked_N_per_m, Conditions conditions, ShownWall& stiffest) {
  Task task = task_of("wall", at.device);
  task.hand = hand_of(at.device);
  const Trial trial = run_trial({.task = std::move(task),
                                 .stiffness_N_per_m = asked_N_per_m,
                                 .network = network_of("none"),
                                 .conditions = conditions,
                                 .law = at.law,
                                 .rate_Hz = at.rate_Hz});
  stiffest.least_P_J = std::min(stiffest.least_P_J, trial.passivity_minimum_J);
  if (!trial.calm || !(trial.shown_N_per_m > stiffest.shown_N_per_m)) return;
  stiffest.shown_N_per_m = trial.shown_N_per_m;
  stiffest.asked_N_per_m = asked_N_per_m;
}

StableStiffness stable_to(const AtRate& at) {
  const std::string hand = hand_of(at.device);
  return largest_stable({.least_N_per_m = 10}, [&](double stiffness) {
    return is_stable({.law = at.law, .hand = hand, .device = at.device, .rate_Hz = at.rate_Hz}, stiffness);
  });
}

}  // namespace

std::vector<AtRate> run_rate_study(const RateSettings& settings,
                                   const std::function<void(std::size_t, std::size_t)>& progress) {
  std::vector<AtRate> results;
  for (const std::string& device : settings.devices) {
    for (const double rate_Hz : settings.rates_Hz) {
      // Half of the latency each way.
      const TheoryLimits theory = theory_limits(device, kRealLatency_s / 2, rate_Hz);
      for (const std::string& law : settings.laws) {
        results.push_back({.device = device,
                           .law = law,
                           .rate_Hz = rate_Hz,
                           .passive_N_per_m = theory.passive_N_per_m,
                           .late_N_per_m = theory.delayed_N_per_m});
      }
    }
  }
  Work work;
  for (AtRate& at : results) {
    work.emplace_back([&] { at.stable = stable_to(at); });
    work.emplace_back([&] {
      for (const double multiple : kMultiples) press(at, multiple * at.passive_N_per_m, Conditions::ideal, at.ideal);
    });
    work.emplace_back([&] {
      for (const double multiple : kMultiples) press(at, multiple * at.passive_N_per_m, Conditions::punctual, at.own);
    });
  }
  Workers workers(progress);
  workers.expect(work.size());
  workers.work_off(work);
  return results;
}

std::string rate_csv(const std::vector<AtRate>& results) {
  text::Table table({{"device"},
                     {"law"},
                     {"rate_Hz"},
                     {"passive_N_per_mm"},
                     {"late_N_per_mm"},
                     {"stable_N_per_mm"},
                     {"ideal_N_per_mm"},
                     {"own_N_per_mm"}});
  const auto cell = [](double stiffness_N_per_m) { return results::figure_number(1e-3 * stiffness_N_per_m); };
  for (const AtRate& at : results) {
    table.add({at.device, at.law, results::figure_number(at.rate_Hz), cell(at.passive_N_per_m), cell(at.late_N_per_m),
               cell(at.stable.N_per_m), cell(at.ideal.shown_N_per_m), cell(at.own.shown_N_per_m)});
  }
  return table.to_csv();
}

}  // namespace forcebound::lab
