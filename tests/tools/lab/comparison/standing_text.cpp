#include <algorithm>
#include <cmath>
#include <cstdio>

#include "forcebound/text/numbers.hpp"
#include "forcebound/text/terminal.hpp"
#include "tests/tools/lab/comparison/standing.hpp"

namespace forcebound::lab {
namespace {

using Json = nlohmann::ordered_json;

std::string padded(const std::string& text, int width) {
  char cell[64];
  std::snprintf(cell, sizeof cell, "%*s", width, text.c_str());
  return cell;
}

std::string law_cell(const Json& law) {
  char cell[64];
  std::snprintf(cell, sizeof cell, "  %-11s", law.at("law").get<std::string>().c_str());
  return cell;
}

/// Whole numbers are not rounded: a year is a parameter.
std::string number(const Json& value) {
  if (!value.is_number()) return "-";
  const double of = value;
  return of == std::round(of) && std::abs(of) < 1e6 ? std::to_string(std::lround(of)) : text::rounded(of);
}

std::string share(const Json& value) {
  return value.is_number() ? text::rounded(100 * value.get<double>()) + " %" : "-";
}

std::string millijoules(const Json& energy) {
  const double value_J = energy;
  return value_J >= kPassive_J ? "0" : text::rounded(1e3 * value_J);
}

/// With each hand in turn: "0.5 / 60 / all".
std::string stiffness(const Json& of_hands) {
  std::string text;
  for (const Json& limit : of_hands) {
    text += (text.empty() ? "" : " / ") + (limit.at("no_limit").get<bool>()
                                               ? std::string("all")
                                               : text::rounded(1e-3 * limit.at("N_per_m").get<double>()));
  }
  return text;
}

/// Whether the law ran any trial: it may have refused all devices.
bool played(const Json& law) { return law.at("trials").get<int>() > 0; }

std::string refused(const Json& law) {
  for (const auto& [scene, words] : law.at("refused").items()) return "refuses: " + words.get<std::string>();
  return "no trials";
}

/// A direction error within rounding counts as 0.
std::string degrees(const Json& angle) {
  constexpr double kRounding_deg = 1e-6;
  return (angle.get<double>() < kRounding_deg ? std::string("0") : number(angle)) + " deg";
}

std::string passivity_table(const Json& all) {
  std::string table =
      "Passivity and rest: least P over all trials [mJ], 0: passive;\n"
      "passive and at rest: shares of all trials\n"
      "                    ideal device          real device\n"
      "  law             least P   passive   least P   passive   at rest  rings [s]\n";
  for (const Json& law : all.at("laws")) {
    if (!played(law)) {
      table += text::wrapped(law_cell(law) + "  " + refused(law), 4) + "\n";
      continue;
    }
    const double trials = law.at("trials");
    table += law_cell(law) + padded(millijoules(law.at("ideal").at("least_P_J")), 12) +
             padded(share(law.at("ideal").at("passive").get<double>() / trials), 10) +
             padded(millijoules(law.at("real").at("least_P_J")), 10) +
             padded(share(law.at("real").at("passive").get<double>() / trials), 10) +
             padded(share(law.at("calm")), 10) + padded(number(law.at("ringing_s")), 11) + "\n";
  }
  return table;
}

std::string force_table(const Json& all) {
  std::string table =
      "The force: variance in contact (median), largest change of its direction, largest\n"
      "distance of its requested position from the device, time of a tick\n"
      "  law          variance [N^2]       bent by    drift [mm]    time\n";
  for (const Json& law : all.at("laws")) {
    if (!played(law)) continue;
    table += law_cell(law) + padded(number(law.at("variance_N2")), 16) + padded(degrees(law.at("direction_deg")), 14) +
             padded(number(law.at("drift_mm")), 14) +
             padded(law.at("work_ns").is_number() ? number(law.at("work_ns")) + " ns" : std::string("-"), 9) + "\n";
  }
  return table;
}

/// A share with one decimal: columns of ten networks fit.
std::string percent(const Json& value) {
  if (!value.is_number()) return "-";
  char cell[32];
  std::snprintf(cell, sizeof cell, "%.1f", 100 * value.get<double>());
  return cell;
}

/// This many columns fit side by side; more continue below.
constexpr std::size_t kNetworksInARow = 9;
constexpr std::size_t kLimitsInARow = 4;

std::string network_table(const Json& all, const char* what, const char* title) {
  const std::size_t count = all.at("networks").size();
  std::string table = std::string(title) + " [%]\n";
  for (std::size_t begin = 0; begin < count; begin += kNetworksInARow) {
    const std::size_t end = std::min(count, begin + kNetworksInARow);
    table += "  law        ";
    for (std::size_t i = begin; i < end; ++i) table += padded("(" + std::to_string(i + 1) + ")", 7);
    table += "\n";
    for (const Json& law : all.at("laws")) {
      if (!played(law)) continue;
      table += law_cell(law);
      for (std::size_t i = begin; i < end; ++i) table += padded(percent(law.at("behind").at(i).at(what)), 7);
      table += "\n";
    }
  }
  return table;
}

std::string limits_table(const Json& all) {
  const std::size_t count = all.at("limits").size();
  if (count == 0) return {};
  std::string table =
      "Stiffest wall up to which every wall tried comes to rest, under a light / a usual /\n"
      "a firm hand, the paper's device, ideal [N/mm]; all: up to 1000\n";
  for (std::size_t begin = 0; begin < count; begin += kLimitsInARow) {
    const std::size_t end = std::min(count, begin + kLimitsInARow);
    const auto row = [&](const std::string& name, auto cell) {
      table += name;
      for (std::size_t i = begin; i < end; ++i) table += padded(cell(i), 16);
      table += "\n";
    };
    const auto theory = [&](const char* name, const char* key) {
      char cell[64];
      std::snprintf(cell, sizeof cell, "  %-11s", name);
      row(cell, [&](std::size_t i) { return text::rounded(1e-3 * all.at("limits").at(i).at(key).get<double>()); });
    };
    row("  each way   ",
        [&](std::size_t i) { return text::rounded(1e3 * all.at("limits").at(i).at("delay_s").get<double>()) + " ms"; });
    theory("2b/T", "passive_N_per_m");
    theory("b/(T/2+2t)", "delayed_N_per_m");
    theory("free device", "free_N_per_m");
    for (const Json& law : all.at("laws")) {
      row(law_cell(law), [&](std::size_t i) {
        std::string hands = stiffness(law.at("stable").at(i));
        std::erase(hands, ' ');
        return hands;
      });
    }
  }
  return table;
}

std::string in_words(const Json& parameters) {
  std::string words;
  for (const auto& [name, value] : parameters.items()) {
    words += (words.empty() ? "" : ", ") + name + " " + number(value);
  }
  return words;
}

std::string tuning_table(const Json& all) {
  std::string table = text::wrapped("Parameters: " + text::counted(all.at("effort").get<std::uint64_t>(), "set") +
                                        " tried for each law that has any, on each scene and network; score: error at "
                                        "the device, plus 1 without rest, plus 1 if not passive\n",
                                    2);
  bool any = false;
  for (const Json& law : all.at("laws")) {
    for (const Json& tuned : law.at("tuned")) {
      any = true;
      const auto score = [&](const char* key) {
        return tuned.at(key).is_number() ? number(tuned.at(key)) : std::string("refused");
      };
      table += text::wrapped(law_cell(law) + " " + tuned.at("scene").get<std::string>() + " (" +
                                 std::to_string(tuned.at("network").get<int>()) + "): " + in_words(tuned.at("best")) +
                                 "; score " + score("best_score") + ", standard " + score("standard_score") + "\n",
                             4);
    }
  }
  return any ? table : "";
}

}  // namespace

std::string to_text(const Json& all) {
  std::string text = "Networks\n";
  for (std::size_t i = 0; i < all.at("networks").size(); ++i) {
    text += "  (" + std::to_string(i + 1) + ") " + all.at("networks").at(i).get<std::string>() + "\n";
  }
  text +=
      "\n" + passivity_table(all) + "\n" + force_table(all) + "\n" +
      network_table(all, "shown",
                    "Displayed stiffness over the wall's where the contact rests, real device, through\neach network") +
      "\n" + network_table(all, "error", "E_dev: error of the force at the device's true position, at its moment") +
      "\n" + network_table(all, "ripple", "Restlessness: deviation of the force over its mean, once contact was made");
  const std::string limits = limits_table(all);
  const std::string tuning = tuning_table(all);
  return text + (limits.empty() ? "" : "\n" + limits) + (tuning.empty() ? "" : "\n" + tuning);
}

namespace {

std::string row_of(const std::vector<std::string>& cells) {
  std::string row = "|";
  for (const std::string& cell : cells) row += " " + cell + " |";
  return row + "\n";
}

/// The networks shown in the Markdown tables: a few, so that the columns fit.
std::vector<std::size_t> told_networks(const Json& all) {
  std::vector<std::size_t> told;
  const std::size_t count = all.at("networks").size();
  for (std::size_t i = 0; i < count; ++i) {
    const std::string name = all.at("networks").at(i);
    if (name == "none" || name == "delay 10ms" || name == "delay 50ms" || name == "5g-urban-n8") told.push_back(i);
  }
  if (told.empty()) told.push_back(0);
  return told;
}

}  // namespace

std::string comparison_markdown(const Json& all) {
  const std::vector<std::size_t> networks = told_networks(all);
  std::vector<std::string> head{"law", "least P ideal [mJ]", "least P real [mJ]", "at rest"};
  for (const std::size_t i : networks) head.push_back("shown, " + all.at("networks").at(i).get<std::string>());
  for (const std::size_t i : networks) head.push_back("E_dev, " + all.at("networks").at(i).get<std::string>());
  head.emplace_back("time [ns]");
  std::string table = row_of(head) + row_of(std::vector<std::string>(head.size(), "---"));
  for (const Json& law : all.at("laws")) {
    if (!played(law)) continue;
    std::vector<std::string> cells{"`" + law.at("law").get<std::string>() + "`",
                                   millijoules(law.at("ideal").at("least_P_J")),
                                   millijoules(law.at("real").at("least_P_J")), share(law.at("calm"))};
    for (const char* const what : {"shown", "error"}) {
      for (const std::size_t i : networks) cells.push_back(share(law.at("behind").at(i).at(what)));
    }
    cells.push_back(number(law.at("work_ns")));
    table += row_of(cells);
  }
  if (all.at("limits").empty()) return table;
  std::vector<std::string> delays{"stiffest wall at rest under a light / usual / firm hand [N/mm]"};
  std::vector<std::string> passive{"2b/T"};
  std::vector<std::string> delayed{"b/(T/2 + 2t)"};
  for (const Json& limit : all.at("limits")) {
    delays.push_back(text::rounded(1e3 * limit.at("delay_s").get<double>()) + " ms each way");
    passive.push_back(text::rounded(1e-3 * limit.at("passive_N_per_m").get<double>()));
    delayed.push_back(text::rounded(1e-3 * limit.at("delayed_N_per_m").get<double>()));
  }
  table += "\n" + row_of(delays) + row_of(std::vector<std::string>(delays.size(), "---")) + row_of(passive) +
           row_of(delayed);
  for (const Json& law : all.at("laws")) {
    std::vector<std::string> cells{"`" + law.at("law").get<std::string>() + "`"};
    for (const Json& limit : law.at("stable")) cells.push_back(stiffness(limit));
    table += row_of(cells);
  }
  return table;
}

}  // namespace forcebound::lab
