#include "tests/tools/lab/comparison/stable_stiffness.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "forcebound/control/classic_text.hpp"
#include "forcebound/device/load_device.hpp"
#include "forcebound/device/tick_rate.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "tests/tools/lab/trials/measures.hpp"
#include "tests/tools/lab/trials/task.hpp"
#include "tests/tools/sim/closed_loop.hpp"

namespace forcebound::lab {
namespace {

// Length of the run: contact begins after half a second; a contact not at rest 2.5 s later counts as never at rest.
constexpr double kRun_s = 3;
constexpr double kRingingMost = 0.8;

// Stiffness of the hand that holds the device.
constexpr double kUnfelt_N = 0.1;

/// Holds the device beside a position, then releases it.
class LettingGo final : public device::Operator {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "letting-go"; }
  [[nodiscard]] const device::Hand& hand() const noexcept override { return hand_; }
  [[nodiscard]] int degrees_of_freedom() const noexcept override { return 1; }
  [[nodiscard]] Target target(double time_s) const noexcept override {
    constexpr double kHeld_s = 0.2;
    constexpr double kAside_m = 1e-4;
    return {.position = control::Vector::Constant(1, kAside_m),
            .velocity = control::Vector::Zero(1),
            .grip = time_s < kHeld_s ? 1.0 : 0.0};
  }
  [[nodiscard]] std::string description() const override { return "holds, then releases"; }

 private:
  device::Hand hand_{.mass_kg = 0, .stiffness_N_per_m = 2000, .damping_N_s_per_m = 20};
};

/// The largest distance from the middle in each of two intervals.
class Swing final : public record::TickSink {
 public:
  void on_tick(const record::TickRecord& tick) noexcept override {
    const double s = time::to_seconds(tick.time);
    if (s >= 0.5 && s < 1) early_m = std::max(early_m, tick.position.norm());
    if (s >= 2.5 && s < 3) late_m = std::max(late_m, tick.position.norm());
  }

  double early_m = 0;
  double late_m = 0;
};

struct MassAndDamping {
  double mass_kg;
  double damping_N_s_per_m;
  double period_s;
};

MassAndDamping first_axis(const std::string& device, double rate_Hz) {
  const device::DeviceDescription description = device::load_device(device);
  const control::DeviceFacts facts = device::at_tick_rate(description.facts, rate_Hz);
  if (!facts.cartesian || !facts.damping.isDiagonal() || !description.inertia.isDiagonal()) {
    throw std::invalid_argument("device '" + device +
                                "' must be Cartesian, its axes independent of one another, for the comparison with "
                                "theory");
  }
  return {description.inertia(0, 0), facts.damping(0, 0), facts.period_s};
}

}  // namespace

StableStiffness largest_stable(const StiffnessSearch& search, const std::function<bool(double)>& stable) {
  double low = 0;
  double high = search.least_N_per_m;
  while (stable(high)) {
    low = high;
    if (low >= search.most_N_per_m) return {low, true};
    high = std::min(2 * high, search.most_N_per_m);
  }
  if (low == 0) return {};
  while (high > (1 + search.resolution) * low) {
    const double middle = std::sqrt(low * high);
    (stable(middle) ? low : high) = middle;
  }
  return {low, false};
}

const std::vector<PressingHand>& pressing_hands() {
  static const std::vector<PressingHand> kHands{
      {"light", "press:mass_kg=0.02,stiffness_N_per_m=50,damping_N_s_per_m=0.2"},
      {"usual", "press"},
      {"firm", "press:mass_kg=0.3,stiffness_N_per_m=1000,damping_N_s_per_m=5"}};
  return kHands;
}

bool is_stable(const PressedWall& wall, double stiffness_N_per_m) {
  TrialSetup setup{.task = task_of("wall", wall.device),
                   .stiffness_N_per_m = stiffness_N_per_m,
                   .network = network_of("none"),
                   .conditions = Conditions::ideal,
                   .law = wall.law,
                   .parameters = wall.parameters,
                   .rate_Hz = wall.rate_Hz};
  setup.task.hand = wall.hand;
  setup.network.settings.up.delay.mean = setup.network.settings.down.delay.mean = time::from_seconds(wall.delay_s);
  RingingMeter ringing(kUnfelt_N);
  sim::ClosedLoop loop(settings_of(setup), {&ringing});
  loop.run(time::from_seconds(kRun_s));
  const auto rings_s = ringing.ringing_s();
  return rings_s && *rings_s < kRingingMost * ringing.contact_s();
}

bool free_device_is_stable(const std::string& device, double stiffness_N_per_m) {
  TrialSetup setup{
      .task = task_of("wall", device), .network = network_of("none"), .conditions = Conditions::ideal, .law = "none"};
  sim::ClosedLoop::Settings settings = settings_of(setup);
  settings.make_hand = [] { return std::make_unique<LettingGo>(); };
  control::ClassicText toml;
  toml << "scene = { name = 'spring', description = 'a spring to both sides', degrees_of_freedom = 1 }\n"
          "[[field]]\nname = 'spring'\neffects = ['spring_to_point']\n[field.spring_to_point]\ncenter_m = [0]\n"
          "stiffness_N_per_m = "
       << stiffness_N_per_m << "\nforce_N_max = 1e9\n";
  settings.scene = server::parse_scene(toml.str(), "spring");
  Swing swing;
  sim::ClosedLoop loop(std::move(settings), {&swing});
  loop.run(time::from_seconds(kRun_s));
  return swing.late_m < swing.early_m;
}

TheoryLimits theory_limits(const std::string& device, double delay_s, double rate_Hz) {
  const auto [m, b, T] = first_axis(device, rate_Hz);
  const double decay = std::exp(-b * T / m);
  return {.passive_N_per_m = 2 * b / T,
          .delayed_N_per_m = b / (T / 2 + 2 * delay_s),
          .free_N_per_m = (1 - decay) / (m / (b * b) * (1 - decay) - T / b * decay)};
}

}  // namespace forcebound::lab
