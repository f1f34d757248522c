#include "tests/tools/lab/teleoperation/impedance_study.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "forcebound/results/summary_cells.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/table.hpp"

namespace forcebound::lab {
namespace {

constexpr double kPressed_m = 1e-3;
constexpr double kGo_s = 1;     // at rest until then
constexpr double kThere_s = 4;  // at the place to swing about, in contact
constexpr double kGrow_s = 1;   // until it swings all the way

/// At rest, then to a place, then a sine about it.
class SwingingHand final : public device::Operator {
 public:
  SwingingHand(const Eigen::Vector3d& place_m, const Eigen::Vector3d& swing_m, double frequency_Hz)
      : place_m_(place_m), swing_m_(swing_m), rad_per_s_(2 * std::numbers::pi * frequency_Hz) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "swinging"; }
  [[nodiscard]] const device::Hand& hand() const noexcept override { return hand_; }
  [[nodiscard]] int degrees_of_freedom() const noexcept override { return 3; }
  [[nodiscard]] Target target(double time_s) const noexcept override {
    const double way = std::clamp((time_s - kGo_s) / (kThere_s - kGo_s), 0.0, 1.0);
    const double swing_s = std::max(0.0, time_s - kThere_s);
    const double grown = std::min(1.0, swing_s / kGrow_s);
    const double angle = rad_per_s_ * swing_s;
    Target target;
    target.position = way * way * (3 - 2 * way) * place_m_ + grown * std::sin(angle) * swing_m_;
    target.velocity =
        6 * way * (1 - way) / (kThere_s - kGo_s) * place_m_ +
        (grown * rad_per_s_ * std::cos(angle) + (swing_s < kGrow_s ? std::sin(angle) / kGrow_s : 0)) * swing_m_;
    return target;
  }
  [[nodiscard]] std::string description() const override { return "swinging"; }

 private:
  device::Hand hand_ = ScriptOperator::Settings{}.hand;
  Eigen::Vector3d place_m_;
  Eigen::Vector3d swing_m_;
  double rad_per_s_;
};

/// Force against the hand over velocity, from whole periods since it is settled.
std::complex<double> impedance_of(const std::vector<TeleoperationMoment>& moments, double settled_s,
                                  const Eigen::Vector3d& way, double frequency_Hz) {
  const double rad_per_s = 2 * std::numbers::pi * frequency_Hz;
  std::complex<double> force{};
  std::complex<double> place{};
  const double periods = std::floor((moments.back().time_s - settled_s) * frequency_Hz);
  for (const TeleoperationMoment& now : moments) {
    if (now.time_s < settled_s || now.time_s >= settled_s + periods / frequency_Hz) continue;
    const auto turn = std::polar(1.0, -rad_per_s * now.time_s);
    force += turn * -now.shown_in_world_N.dot(way);
    place += turn * now.leader_m.dot(way);
  }
  return force / (place * std::complex<double>(0, rad_per_s));
}

ImpedanceRow row_of(const TeleoperationStudy& study, const std::string& architecture, const NamedNetwork& network,
                    bool in_contact) {
  ImpedanceRow row{.architecture = architecture, .network = network.name, .in_contact = in_contact};
  for (const double frequency_Hz : kSwings_Hz) {
    TeleoperationSetup setup = setup_of(study, "stiff-wall", architecture, study.laws.front(), network, 1);
    Swing swing{.frequency_Hz = frequency_Hz};
    if (in_contact) {
      // The script knows where the wall is pressed.
      const Eigen::Vector3d normal = setup.task.normal;
      const auto deepest = std::ranges::min_element(
          setup.task.script, {}, [&](const server::ToolWaypoint& waypoint) { return waypoint.position.dot(normal); });
      swing.place_m = deepest->position - setup.task.target(0).position;
      swing.way = normal;
      swing.size_m = kPressed_m;
    }
    const SwingOutcome outcome = swing_hand(std::move(setup), swing);
    row.at.push_back(outcome.met);
    row.least_P_J = std::min({row.least_P_J, outcome.measures.leader_minimum_J, outcome.measures.follower_minimum_J});
  }
  return row;
}

}  // namespace

SwingOutcome swing_hand(TeleoperationSetup setup, const Swing& swing) {
  const Eigen::Matrix3d into = setup.follower.workspace.rotation.transpose() / setup.follower.workspace.motion_scale;
  setup.make_hand = [=] {
    return std::make_unique<SwingingHand>(into * swing.place_m, into * swing.way * swing.size_m, swing.frequency_Hz);
  };
  const sim::SimulatedNetworkSettings& network = setup.network.settings;
  const double settled_s = kThere_s + kGrow_s + time::to_seconds(network.up.delay.mean + network.down.delay.mean);
  constexpr double kPeriods = 6;
  setup.duration_s = settled_s + std::max(2.0, kPeriods / swing.frequency_Hz) + 0.01;
  std::vector<TeleoperationMoment> moments;
  SwingOutcome outcome{.measures = run_teleoperation(setup, &moments)};
  outcome.met = {.frequency_Hz = swing.frequency_Hz,
                 .N_s_per_m = impedance_of(moments, settled_s, swing.way, swing.frequency_Hz)};
  return outcome;
}

std::vector<ImpedanceRow> study_impedance(const TeleoperationStudy& study) {
  std::vector<ImpedanceRow> rows;
  for (const bool in_contact : {false, true}) {
    for (const NamedNetwork& network : study.networks) {
      for (const std::string& architecture : study.architectures) {
        rows.push_back(row_of(study, architecture, network, in_contact));
      }
    }
  }
  return rows;
}

std::string impedance_text(const std::vector<ImpedanceRow>& rows, double wall_N_per_m) {
  std::vector<text::Table::Column> columns{{"architecture"}};
  for (const double frequency_Hz : kSwings_Hz) columns.push_back({text::rounded(frequency_Hz) + " Hz"});
  columns.push_back({"least P", "mJ"});
  text::Table table(columns);
  std::string heading;
  for (const ImpedanceRow& row : rows) {
    const std::string now =
        std::string(row.in_contact ? "in contact, " : "free space, ") + results::network_in_words(row.network);
    if (now != heading) {
      table.add_heading(heading = now);
      std::vector<text::Table::Cell> ideal{row.in_contact ? "the wall itself" : "free space itself"};
      for (const double frequency_Hz : kSwings_Hz) {
        ideal.emplace_back(row.in_contact ? text::rounded(wall_N_per_m / (2 * std::numbers::pi * frequency_Hz)) + " -90"
                                          : "0");
      }
      ideal.emplace_back("");
      table.add(ideal);
    }
    std::vector<text::Table::Cell> cells{row.architecture};
    for (const TransmittedImpedance& at : row.at) {
      cells.emplace_back(text::rounded(std::abs(at.N_s_per_m)) + " " +
                         text::fixed(std::arg(at.N_s_per_m) * 180 / std::numbers::pi, 0));
    }
    cells.emplace_back(results::millijoules(row.least_P_J));
    table.add(cells);
  }
  return table.to_text() +
         "\n  Force against the hand over its velocity [N s/m], and its phase [degrees]: 0 a\n"
         "  damper, -90 a spring, 90 a mass; beyond +-90 it gives energy, which the law\n"
         "  allows as far as the device's own damping takes it.\n";
}

}  // namespace forcebound::lab
