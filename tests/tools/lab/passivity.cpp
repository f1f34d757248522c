#include "tests/tools/lab/passivity.hpp"

#include <algorithm>
#include <array>

#include "forcebound/control/law_registry.hpp"
#include "forcebound/device/load_device.hpp"
#include "forcebound/results/summary_cells.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/table.hpp"
#include "tests/tools/sim/closed_loop.hpp"
#include "tests/tools/sim/draw.hpp"
#include "tests/tools/sim/restless_hand.hpp"

namespace forcebound::lab {
namespace {

constexpr std::array kEncoders_m{0.0, 15e-6, 55e-6};
constexpr std::array kLatencies_s{0.0, 20e-6, 100e-6, 300e-6};
constexpr double kLateShare = 0.2;
constexpr double kGuarantee_J = 1e-9;

sim::ClosedLoop::Settings settings_of(const PassivityCondition& condition, std::uint64_t seed, double duration_s) {
  sim::Draw draw(seed);
  sim::ClosedLoop::Settings settings;
  settings.law = condition.law;
  settings.seed = draw.seed();
  settings.device = device::load_device("wall-1dof");
  settings.device.facts.encoder_step.setConstant(condition.encoder_m);
  settings.device.facts.latency_s = condition.latency_s;
  if (condition.late_ticks) {
    settings.timing = {.late_share = kLateShare, .late_max = time::from_seconds(settings.device.facts.period_s)};
  }
  settings.make_hand = [seed = draw.seed(), duration_s] {
    return std::make_unique<sim::RestlessHand>(
        sim::RestlessHand::Settings{.seed = seed,
                                    .degrees_of_freedom = 1,
                                    .hand = {.mass_kg = 0.05, .stiffness_N_per_m = 200, .damping_N_s_per_m = 1},
                                    .duration_s = duration_s});
  };
  settings.scene = server::parse_scene(
      "scene = { name = 'nothing', description = 'free space', degrees_of_freedom = 'any' }\n", "passivity");
  settings.environment = sim::EnvironmentSetting{
      .name = condition.adversary, .seed = draw.seed(), .force_N_max = settings.device.facts.force_N_max};
  return settings;
}

/// The worst over all adversaries.
double worst_J(const std::vector<PassivityResult>& results, const PassivityCondition& condition) {
  double worst = 0;
  for (const PassivityResult& result : results) {
    const PassivityCondition& c = result.condition;
    const bool same = c.law == condition.law && c.encoder_m == condition.encoder_m &&
                      c.late_ticks == condition.late_ticks && c.latency_s == condition.latency_s;
    if (same) worst = std::min(worst, result.least_P_J);
  }
  return worst;
}

text::Table::Cell leak(double least_P_J) {
  return {results::millijoules(least_P_J),
          least_P_J < -kGuarantee_J ? text::Table::Mark::alarm : text::Table::Mark::none};
}

}  // namespace

std::vector<PassivityCondition> passivity_conditions() {
  std::vector<PassivityCondition> conditions;
  for (const std::string& law : control::force_bounding_laws().names()) {
    for (const double encoder_m : kEncoders_m) {
      for (const bool late_ticks : {false, true}) {
        for (const double latency_s : kLatencies_s) {
          for (const std::string& adversary : sim::environment_names()) {
            if (adversary == "honest" || adversary == "replayed") continue;
            conditions.push_back({law, encoder_m, late_ticks, latency_s, adversary});
          }
        }
      }
    }
  }
  return conditions;
}

PassivityResult worst_passivity(const PassivityCondition& condition, const PassivitySettings& settings) {
  PassivityResult result{.condition = condition};
  for (std::uint64_t seed = settings.from; seed < settings.from + settings.seeds; ++seed) {
    sim::ClosedLoop loop(settings_of(condition, seed, settings.duration_s));
    loop.run(time::from_seconds(settings.duration_s));
    const double least_J = loop.device().audit()->minimum_J;
    if (least_J >= result.least_P_J) continue;
    result.least_P_J = least_J;
    result.seed = seed;
  }
  return result;
}

std::string passivity_table(const std::vector<PassivityResult>& results, text::Colour colour) {
  std::vector<text::Table::Column> columns{{"law"}, {"latency", "us"}};
  for (const char* const ticks : {"exact", "late"}) {
    for (const double encoder_m : kEncoders_m) columns.push_back({text::fixed(encoder_m * 1e6, 0) + " um", ticks});
  }
  text::Table table(std::move(columns));
  for (const std::string& law : control::force_bounding_laws().names()) {
    for (const double latency_s : kLatencies_s) {
      std::vector<text::Table::Cell> row{latency_s == kLatencies_s[0] ? law : "", text::fixed(latency_s * 1e6, 0)};
      for (const bool late_ticks : {false, true}) {
        for (const double encoder_m : kEncoders_m)
          row.push_back(leak(worst_J(results, {law, encoder_m, late_ticks, latency_s, {}})));
      }
      table.add(std::move(row));
    }
  }
  return "Least P [mJ] over all adversaries; 0: passive. Across: the encoder's step,\n"
         "with exact ticks and with " +
         text::rounded(100 * kLateShare) + " % of them late.\n\n" + table.to_text(colour);
}

std::string passivity_csv(const std::vector<PassivityResult>& results) {
  text::Table table({{"law"}, {"encoder_m"}, {"late_share"}, {"latency_s"}, {"adversary"}, {"least_P_J"}, {"seed"}});
  for (const auto& [condition, least_P_J, seed] : results) {
    table.add({condition.law, text::to_text(condition.encoder_m), text::to_text(condition.late_ticks ? kLateShare : 0),
               text::to_text(condition.latency_s), condition.adversary, text::to_text(least_P_J),
               std::to_string(seed)});
  }
  return table.to_csv();
}

}  // namespace forcebound::lab
