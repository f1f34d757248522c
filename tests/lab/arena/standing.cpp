#include "tests/lab/arena/standing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>

#include "tests/lab/percentile.hpp"

namespace forcebound::lab {
namespace {

using Json = nlohmann::ordered_json;
using Number = double (*)(const PlayedBout&);

/// The half below and above; null of nothing. What is not a number does not count.
Json median(const std::vector<const PlayedBout*>& bouts, Number number) {
  std::vector<double> values;
  for (const PlayedBout* const played : bouts) {
    const double value = number(*played);
    if (std::isfinite(value)) values.push_back(value);
  }
  return values.empty() ? Json(nullptr) : Json(percentile(std::move(values), 0.5));
}

double most(const std::vector<const PlayedBout*>& bouts, Number number) {
  double value = 0;
  for (const PlayedBout* const played : bouts) value = std::max(value, number(*played));
  return value;
}

double worst_J(const std::vector<const PlayedBout*>& bouts) {
  double value = 0;
  for (const PlayedBout* const played : bouts) value = std::min(value, played->bout.passivity_minimum_J);
  return value;
}

double calm_share(const std::vector<const PlayedBout*>& bouts) {
  const auto calm = std::ranges::count_if(bouts, [](const PlayedBout* played) { return played->bout.calm; });
  return bouts.empty() ? 0 : static_cast<double>(calm) / static_cast<double>(bouts.size());
}

double shown(const PlayedBout& played) { return played.bout.shown_N_per_m / played.contest.stiffness_N_per_m; }
double ripple(const PlayedBout& played) { return played.bout.restlessness; }
double variance(const PlayedBout& played) { return played.bout.force_N2_variance; }
double error(const PlayedBout& played) { return played.bout.error; }
double ringing_s(const PlayedBout& played) { return played.bout.ringing_s.value_or(std::nan("")); }
double direction_deg(const PlayedBout& played) { return played.bout.direction_error_rad * 180 / std::numbers::pi; }
double drift_mm(const PlayedBout& played) { return 1e3 * played.bout.drift_m; }

template <typename Take>
std::vector<const PlayedBout*> bouts_where(const LawInArena& law, Take take) {
  std::vector<const PlayedBout*> taken;
  for (const PlayedBout& played : law.bouts) {
    if (played.bout.refused.empty() && take(played)) taken.push_back(&played);
  }
  return taken;
}

Json behind(const LawInArena& law, std::size_t network) {
  const auto bouts = bouts_where(law, [&](const PlayedBout& played) {
    return played.network == network && played.contest.conditions == Conditions::real;
  });
  return {{"shown", median(bouts, shown)},
          {"ripple", median(bouts, ripple)},
          {"error", median(bouts, error)},
          {"calm", calm_share(bouts)},
          {"least_P_J", worst_J(bouts)}};
}

Json tuned(const LawInArena& law) {
  Json all = Json::array();
  for (const auto& [scene, network, tuning] : law.tuned) {
    if (tuning.tried == 0) continue;
    all.push_back({{"scene", scene},
                   {"network", network + 1},
                   {"standard", tuning.standard},
                   {"best", tuning.best},
                   {"standard_score", std::isfinite(tuning.standard_score) ? Json(tuning.standard_score) : Json()},
                   {"best_score", std::isfinite(tuning.best_score) ? Json(tuning.best_score) : Json()},
                   {"tried", tuning.tried},
                   {"refused", tuning.refused}});
  }
  return all;
}

Json refusals(const LawInArena& law) {
  Json all = Json::object();
  for (const PlayedBout& played : law.bouts) {
    if (!played.bout.refused.empty()) all[played.contest.ground.scene] = played.bout.refused;
  }
  return all;
}

Json standing(const ArenaResult& result, const LawInArena& law) {
  const auto ideal = bouts_where(law, [](const PlayedBout& p) { return p.contest.conditions == Conditions::ideal; });
  const auto real = bouts_where(law, [](const PlayedBout& p) { return p.contest.conditions == Conditions::real; });
  const auto passive = [](const PlayedBout* played) { return played->bout.passivity_minimum_J >= kPassive_J; };
  Json networks = Json::array();
  for (std::size_t i = 0; i < result.settings.networks.size(); ++i) networks.push_back(behind(law, i));
  Json stable = Json::array();
  for (const std::vector<StableStiffness>& of_hands : law.stable) {
    Json hands = Json::array();
    for (const StableStiffness& limit : of_hands) {
      hands.push_back({{"N_per_m", limit.N_per_m}, {"no_limit", limit.no_limit}});
    }
    stable.push_back(std::move(hands));
  }
  const control::LawRegistry laws = control::shipped_laws();
  return {{"law", law.law},
          {"reference", laws.find(law.law).reference},
          {"refused", refusals(law)},
          {"bouts", real.size()},
          {"ideal", {{"least_P_J", worst_J(ideal)}, {"passive", std::ranges::count_if(ideal, passive)}}},
          {"real", {{"least_P_J", worst_J(real)}, {"passive", std::ranges::count_if(real, passive)}}},
          {"calm", calm_share(real)},
          {"variance_N2", median(real, variance)},
          {"ringing_s", median(real, ringing_s)},
          {"direction_deg", most(real, direction_deg)},
          {"drift_mm", most(real, drift_mm)},
          {"work_ns", std::isfinite(law.work_ns) ? Json(law.work_ns) : Json()},
          {"behind", std::move(networks)},
          {"stable", std::move(stable)},
          {"tuned", tuned(law)}};
}

void add_cell(std::ostringstream& row, double value) {
  row << ',';
  if (std::isfinite(value)) row << value;
}

}  // namespace

Json standings(const ArenaResult& result) {
  const ArenaSettings& settings = result.settings;
  Json all{{"scenes", Json::array()}, {"networks", Json::array()}};
  for (const Ground& ground : settings.grounds) {
    all["scenes"].push_back({{"scene", ground.scene}, {"device", ground.device}, {"hand", ground.hand}});
  }
  for (const NamedNetwork& network : settings.networks) all["networks"].push_back(network.name);
  all["stiffnesses_N_per_m"] = settings.stiffnesses_N_per_m;
  all["seeds"] = settings.seeds;
  all["effort"] = settings.effort;
  all["limits"] = Json::array();
  for (std::size_t i = 0; i < settings.delays_s.size(); ++i) {
    all["limits"].push_back({{"delay_s", settings.delays_s[i]},
                             {"passive_N_per_m", result.theory[i].passive_N_per_m},
                             {"delayed_N_per_m", result.theory[i].delayed_N_per_m},
                             {"free_N_per_m", result.theory[i].free_N_per_m}});
  }
  all["hands"] = Json::array();
  for (const PressingHand& hand : pressing_hands()) {
    all["hands"].push_back({{"hand", hand.name}, {"operator", hand.specification}});
  }
  all["laws"] = Json::array();
  for (const LawInArena& law : result.laws) all["laws"].push_back(standing(result, law));
  return all;
}

std::string to_csv(const ArenaResult& result) {
  std::ostringstream rows;
  rows.precision(9);
  rows << "law,scene,device,network,conditions,stiffness_N_per_m,seed,passivity_minimum_J,calm,ringing_s,"
          "displayed_stiffness_N_per_m,force_mean_N,force_variance_N2,restlessness,device_error,direction_error_rad,"
          "drift_m,refused\n";
  for (const LawInArena& law : result.laws) {
    for (const auto& [contest, network, bout] : law.bouts) {
      rows << law.law << ',' << contest.ground.scene << ',' << contest.ground.device << ",\"" << contest.network.name
           << "\"," << (contest.conditions == Conditions::ideal ? "ideal" : "real") << ',' << contest.stiffness_N_per_m
           << ',' << contest.seed;
      if (!bout.refused.empty()) {
        rows << ",,,,,,,,,,,\"" << bout.refused << "\"\n";
        continue;
      }
      rows << ',' << bout.passivity_minimum_J << ',' << (bout.calm ? 1 : 0);
      for (const double value :
           {bout.ringing_s.value_or(std::nan("")), bout.shown_N_per_m, bout.force_N_mean, bout.force_N2_variance,
            bout.restlessness, bout.error, bout.direction_error_rad, bout.drift_m}) {
        add_cell(rows, value);
      }
      rows << ",\n";
    }
  }
  return rows.str();
}

}  // namespace forcebound::lab
