#include <unistd.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "forcebound/control/classic_text.hpp"
#include "forcebound/control/exact_law.hpp"
#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/make_operator.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/table.hpp"
#include "forcebound/text/terminal.hpp"
#include "tests/tools/lab/commands.hpp"
#include "tests/tools/lab/measures/experiment.hpp"
#include "tests/tools/lab/measures/measures.hpp"
#include "tests/tools/lab/measures/summary_cells.hpp"
#include "tests/tools/lab/progress.hpp"

namespace forcebound::lab {
namespace {

using namespace std::chrono_literals;

struct SpendingOptions {
  std::vector<double> memories{1, 2, 3};
  std::vector<double> rises{1e9, 300, 100, 30};
  std::vector<double> shares{0, 0.3};
  double delay_ms = 0;
  bool grid = false;
};

/// How energy is spent, and how the device releases a force.
struct Variant {
  control::Spending spending;
  double release_share = 0;

  [[nodiscard]] std::string name() const {
    std::string words = "memory " + text::rounded(spending.memory_reserves) + ", rise ";
    words += spending.rise_per_s >= 1e6 ? "any" : text::rounded(spending.rise_per_s) + " /s";
    return release_share > 0 ? words + ", then " + text::rounded(release_share) : words;
  }
};

/// Without spending rules: memory as large as one reserve, and any rise.
constexpr Variant kPlainSpending{{.memory_reserves = 1, .rise_per_s = 1e9}};

struct Case {
  Experiment experiment;
  bool measured = false;      ///< ticks as late as measured
  time::Nanoseconds late{0};  ///< one tick more, 2.5 s after the start
  double damping = 1;         ///< times the device's
  double hand = 1;            ///< times the hand's stiffness
};

/// Mean force over mean depth from one time to another.
class Window final : public record::TickSink {
 public:
  Window(double from_s, double to_s) : from_s_(from_s), to_s_(to_s) {}
  void on_tick(const record::TickRecord& tick) noexcept override {
    const double now_s = time::to_seconds(tick.time);
    if (now_s < from_s_ || now_s > to_s_ || !tick.contact) return;
    force_N_ += tick.displayed_N;
    depth_m_ += tick.penetration_m;
  }
  void on_force(const record::ForceRecord&) noexcept override {}
  [[nodiscard]] double stiffness_N_per_m() const { return depth_m_ > 0 ? force_N_ / depth_m_ : 0; }

 private:
  double from_s_;
  double to_s_;
  double force_N_ = 0;
  double depth_m_ = 0;
};

struct Shown {
  double stiffness_N_per_m = 0;
  double ringing_s = 0;
  double variance_N2 = 0;
  double half_a_second_later_N_per_m = 0;
};

Shown run_case(const Case& drawn, const Variant& variant) {
  auto laws = std::make_shared<control::LawRegistry>();
  laws->add({.name = "exact",
             .summary = "fba-exact with other constants",
             .claim = control::LawClaim::passive,
             .shortens = true,
             .make = [&](const control::DeviceFacts& facts, const control::LawOptions& options) {
               return std::make_unique<control::ExactLaw>(facts, options.memory, variant.spending);
             }});
  sim::ClosedLoop::Settings settings = drawn.experiment.settings("exact");
  settings.laws = laws;
  settings.timing.measured = drawn.measured;
  settings.device.facts.damping *= drawn.damping;
  settings.device.facts.release_share = variant.release_share;
  settings.device.facts.release_s = variant.release_share > 0 ? settings.device.facts.hold_s_max : 0;
  const auto hand = device::make_operator(settings.hand, settings.device.facts);
  const double hand_N_per_m = hand->hand().stiffness_N_per_m * drawn.hand;
  settings.hand += ":stiffness_N_per_m=" + text::rounded(hand_N_per_m);
  if (drawn.late > 0ns) settings.faults.push_back({.at = 2500ms, .length = drawn.late});
  RingingMeter ringing;
  Window later(2.9, 3.1);
  sim::ClosedLoop loop(settings, {&ringing, &later});
  loop.run(time::from_seconds(drawn.experiment.duration_s));
  const auto summary = nlohmann::ordered_json::parse(loop.close().to_json());
  const double median_N_per_m = number_at(summary, "/displayed_stiffness_N_per_m/median");
  return {.stiffness_N_per_m = std::isfinite(median_N_per_m) ? median_N_per_m : 0,
          .ringing_s = ringing.ringing_s().value_or(0),
          .variance_N2 = number_at(summary, "/force_N/variance"),
          .half_a_second_later_N_per_m = later.stiffness_N_per_m()};
}

/// What one variant shows in the paper's experiments.
struct Found {
  Variant variant;
  Shown wall{};
  std::vector<text::Table::Cell> cells{};
};

/// Whether none with the same release shows as stiff a wall for less ringing, or a stiffer one for no more.
bool on_front(const Found& found, const std::vector<Found>& all) {
  return std::none_of(all.begin(), all.end(), [&](const Found& other) {
    if (other.variant.release_share != found.variant.release_share) return false;
    const double stiffer = other.wall.stiffness_N_per_m - found.wall.stiffness_N_per_m;
    const double sooner = found.wall.ringing_s - other.wall.ringing_s;
    return stiffer >= 0 && sooner >= 0 && (stiffer > 0 || sooner > 0);
  });
}

/// The paper's experiments, with punctual and with late ticks.
void search(const SpendingOptions& options) {
  text::Table table({{"spending"},
                     {"wall", "N/mm"},
                     {"rings", "s"},
                     {"front"},
                     {"wall, late", "N/mm"},
                     {"one 5 ms late", "N/mm"},
                     {"circle", "N/mm"},
                     {"variance", "N^2"},
                     {"circle, late", "N/mm"},
                     {"variance ", "N^2"},
                     {"sphere", "N/mm"},
                     {"sphere, late", "N/mm"}});
  const auto delayed = [&](Experiment experiment) {
    experiment.one_way_delay_s = options.delay_ms * 1e-3;
    return experiment;
  };
  const Experiment wall = delayed(experiments("wall").back());
  const Experiment circle = delayed(experiments("circle").front());
  const Experiment sphere = delayed(experiments("sphere").front());
  Progress progress;
  std::vector<Variant> variants;
  for (const double memory : options.memories) {
    for (const double rise : options.rises) {
      for (const double share : options.shares) variants.push_back({{memory, rise}, share});
    }
  }
  double done = 0;
  std::vector<Found> all;
  for (const Variant& variant : variants) {
    progress.tell(done++ / static_cast<double>(variants.size()), variant.name());
    const Shown a = run_case({wall}, variant);
    const Shown b = run_case({wall, true}, variant);
    const Shown c = run_case({wall, false, 5ms}, variant);
    const Shown d = run_case({circle}, variant);
    const Shown e = run_case({circle, true}, variant);
    const Shown f = run_case({sphere}, variant);
    const Shown g = run_case({sphere, true}, variant);
    all.push_back(
        {variant,
         a,
         {newtons_per_mm(b.stiffness_N_per_m), newtons_per_mm(c.half_a_second_later_N_per_m),
          newtons_per_mm(d.stiffness_N_per_m), text::fixed(d.variance_N2, 3), newtons_per_mm(e.stiffness_N_per_m),
          text::fixed(e.variance_N2, 3), newtons_per_mm(f.stiffness_N_per_m), newtons_per_mm(g.stiffness_N_per_m)}});
  }
  for (const Found& found : all) {
    std::vector<text::Table::Cell> row{found.variant.name(), newtons_per_mm(found.wall.stiffness_N_per_m),
                                       text::fixed(found.wall.ringing_s, 2), on_front(found, all) ? "yes" : ""};
    row.insert(row.end(), found.cells.begin(), found.cells.end());
    table.add(row);
  }
  progress.clear();
  std::cout << table.to_text(text::colour_for(STDOUT_FILENO));
}

/// Four scenes and devices, three stiffnesses and hands and two dampings for each, with punctual and late ticks,
/// through three networks.
std::vector<std::pair<std::string, Case>> grid() {
  const Experiment sphere = experiments("sphere").front();
  Experiment arm = sphere;
  arm.device = "omni";
  arm.encoder_m = device::load_device(arm.device).facts.encoder_step[0];  // [rad]
  std::vector<std::pair<std::string, Case>> all;
  for (Experiment experiment : {experiments("wall").back(), experiments("circle").front(), sphere, arm}) {
    experiment.duration_s = 4;
    experiment.settle_s = 1;
    const double paper_N_per_m = experiment.stiffness_N_per_m;
    for (const double stiffness : {0.2, 1.0, 5.0}) {
      for (const double hand : {0.3, 1.0, 3.0}) {
        for (const double damping : {0.5, 2.0}) {
          for (const bool measured : {false, true}) {
            for (const double delay_s : {0.0, 5e-3, 50e-3}) {
              experiment.stiffness_N_per_m = stiffness * paper_N_per_m;
              experiment.one_way_delay_s = delay_s;
              control::ClassicText name;
              name << experiment.device << ", K " << newtons_per_mm(experiment.stiffness_N_per_m)
                   << " N/mm, hand times " << hand << ", damping times " << damping << ", delay " << delay_s * 1e3
                   << " ms" << (measured ? ", late ticks" : "");
              all.emplace_back(name.str(),
                               Case{.experiment = experiment, .measured = measured, .damping = damping, .hand = hand});
            }
          }
        }
      }
    }
  }
  return all;
}

/// Where the law shows less with its spending rules than without.
void compare_with_before() {
  constexpr double kWorse = 0.95;
  const auto all = grid();
  const Variant now{};
  text::Table table({{"shown less by more than 5 %"}, {"before", "N/mm"}, {"now", "N/mm"}});
  std::size_t worse = 0;
  std::size_t stiffer = 0;
  double sum = 0;
  std::size_t shown = 0;
  double done = 0;
  Progress progress;
  for (const auto& [name, drawn] : all) {
    progress.tell(done++ / static_cast<double>(all.size()), name);
    const double before = run_case(drawn, kPlainSpending).stiffness_N_per_m;
    const double after = run_case(drawn, now).stiffness_N_per_m;
    if (!(before > 0) || !(after > 0)) continue;
    ++shown;
    sum += std::log(after / before);
    stiffer += after * kWorse > before;
    if (after >= kWorse * before) continue;
    ++worse;
    table.add({name, newtons_per_mm(before), newtons_per_mm(after)});
  }
  progress.clear();
  std::cout << all.size() << " runs, " << shown << " of them with a contact that rests: " << stiffer
            << " stiffer by more than 5 %, " << worse << " softer by more than 5 %, the mean ratio "
            << text::rounded(std::exp(sum / static_cast<double>(std::max<std::size_t>(shown, 1)))) << "\n\n";
  if (worse > 0) std::cout << table.to_text(text::colour_for(STDOUT_FILENO));
}

}  // namespace

void add_spending(CLI::App& app) {
  auto options = std::make_shared<SpendingOptions>();
  CLI::App* command = app.add_subcommand(
      "spending",
      "Displayed stiffness of walls, circle and sphere over the constants by which fba-exact spends energy; 'front': "
      "none listed with the same release shows as stiff a wall for less ringing, or a stiffer one for no more");
  auto* const grid_only =
      command->add_flag("--grid", options->grid,
                        "instead: 432 runs over scenes, devices, stiffnesses, hands, damping, late ticks and networks, "
                        "with the law's own constants and without spending rules");
  command->add_option("--memory", options->memories, "energy kept, in multiples of what the largest force needs")
      ->check(program::number_above_zero())
      ->type_name("MULTIPLES")
      ->delimiter(',')
      ->excludes(grid_only)
      ->capture_default_str();
  command->add_option("--rise", options->rises, "largest rise of the share of the request that is shown [1/s]")
      ->check(program::number_above_zero())
      ->type_name("RATES")
      ->delimiter(',')
      ->excludes(grid_only)
      ->capture_default_str();
  command->add_option("--release-share", options->shares, "share of the force that the device holds as it releases it")
      ->check(program::number_within(0, 1))
      ->type_name("SHARES")
      ->delimiter(',')
      ->excludes(grid_only)
      ->capture_default_str();
  command->add_option("--delay", options->delay_ms, "one-way delay of the network [ms]")
      ->check(program::number_within(0, 1000))
      ->type_name("MS")
      ->excludes(grid_only)
      ->capture_default_str();
  command->footer("Example:\n  forcebound-lab spending --memory 1,2 --rise 100 --release-share 0,0.3");
  command->callback([options] { options->grid ? compare_with_before() : search(*options); });
}

}  // namespace forcebound::lab
