#include <cmath>
#include <utility>

#include "forcebound/results/summary_cells.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/table.hpp"
#include "forcebound/text/terminal.hpp"
#include "tests/tools/lab/comparison/standing.hpp"

namespace forcebound::lab {
namespace {

using Json = nlohmann::ordered_json;

/// Whole numbers are not rounded: a year is a parameter.
std::string number_text(const Json& value) {
  if (!value.is_number()) return "-";
  const double of = value;
  return of == std::round(of) && std::abs(of) < 1e6 ? std::to_string(std::lround(of)) : text::rounded(of);
}

/// A share in percent, without its unit.
std::string share(const Json& value) { return value.is_number() ? text::rounded(100 * value.get<double>()) : "-"; }

/// With each hand in turn: "0.5/60/all".
std::string stiffness(const Json& of_hands) {
  std::string text;
  for (const Json& limit : of_hands) {
    text += (text.empty() ? "" : "/") + (limit.at("no_limit").get<bool>()
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
  return angle.get<double>() < kRounding_deg ? "0" : number_text(angle);
}

/// A share in percent with one decimal, without its unit.
std::string percent_text(const Json& value) {
  return value.is_number() ? text::fixed(100 * value.get<double>(), 1) : "-";
}

std::string law_name(const Json& law) { return law.at("law"); }

std::string passivity_table(const Json& all) {
  text::Table table({{"law"},
                     {"ideal: least P", "mJ"},
                     {"passive", "%"},
                     {"real: least P", "mJ"},
                     {"passive", "%"},
                     {"at rest", "%"},
                     {"rings", "s"}});
  for (const Json& law : all.at("laws")) {
    if (!played(law)) {
      table.add_remark(law_name(law), refused(law));
      continue;
    }
    const double trials = law.at("trials");
    const auto passive = [&](const char* device) {
      return text::rounded(100 * law.at(device).at("passive").get<double>() / trials);
    };
    table.add({law_name(law), results::millijoules(law.at("ideal").at("least_P_J")), passive("ideal"),
               results::millijoules(law.at("real").at("least_P_J")), passive("real"), percent_text(law.at("calm")),
               number_text(law.at("ringing_s"))});
  }
  return "Passivity and rest, with ideal and with real devices: least P over all trials,\n"
         "0: passive; passive and at rest: shares of all trials\n" +
         table.to_text();
}

std::string force_table(const Json& all) {
  text::Table table({{"law"}, {"variance", "N^2"}, {"bent by", "deg"}, {"drift", "mm"}, {"time", "ns"}});
  for (const Json& law : all.at("laws")) {
    if (!played(law)) continue;
    table.add({law_name(law), number_text(law.at("variance_N2")), degrees(law.at("direction_deg")),
               number_text(law.at("drift_mm")), number_text(law.at("work_ns"))});
  }
  return "The force: variance in contact (median), largest change of its direction,\n"
         "largest distance of its requested position from the device, time of a tick\n" +
         table.to_text();
}

std::string network_table(const Json& all, const char* what, const char* title) {
  std::vector<text::Table::Column> columns{{"law"}};
  const std::size_t count = all.at("networks").size();
  for (std::size_t i = 0; i < count; ++i) columns.push_back({"(" + std::to_string(i + 1) + ")"});
  text::Table table(std::move(columns));
  for (const Json& law : all.at("laws")) {
    if (!played(law)) continue;
    std::vector<text::Table::Cell> row{law_name(law)};
    for (std::size_t i = 0; i < count; ++i) row.emplace_back(percent_text(law.at("behind").at(i).at(what)));
    table.add(std::move(row));
  }
  return std::string(title) + " [%]\n" + table.to_text();
}

/// The stiffest walls at rest: what theory says for each delay, then what each law reached.
/// @param quote around a law's name
text::Table limits_table(const Json& all, const std::string& title, const std::string& quote) {
  std::vector<text::Table::Column> columns{{title}};
  for (const Json& limit : all.at("limits"))
    columns.push_back({text::rounded(1e3 * limit.at("delay_s").get<double>()) + " ms each way"});
  text::Table table(std::move(columns));
  const auto add = [&](const std::string& name, const Json& cells, auto to_cell) {
    std::vector<text::Table::Cell> row{name};
    for (const Json& each : cells) row.emplace_back(to_cell(each));
    table.add(std::move(row));
  };
  const auto theory = [&](const char* name, const char* key) {
    add(name, all.at("limits"), [&](const Json& limit) { return text::rounded(1e-3 * limit.at(key).get<double>()); });
  };
  theory("2b/T", "passive_N_per_m");
  theory("b/(T/2 + 2t)", "delayed_N_per_m");
  theory("free device", "free_N_per_m");
  for (const Json& law : all.at("laws"))
    add(std::string(quote).append(law_name(law)).append(quote), law.at("stable"), stiffness);
  return table;
}

std::string in_words(const Json& parameters) {
  std::string words;
  for (const auto& [name, value] : parameters.items()) {
    words += (words.empty() ? "" : ", ") + name + " " + number_text(value);
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
        return tuned.at(key).is_number() ? number_text(tuned.at(key)) : std::string("refused");
      };
      table += text::wrapped("  " + law_name(law) + " " + tuned.at("scene").get<std::string>() + " (" +
                                 std::to_string(tuned.at("network").get<int>()) + "): " + in_words(tuned.at("best")) +
                                 "; score " + score("best_score") + ", standard " + score("standard_score") + "\n",
                             4);
    }
  }
  return any ? table : "";
}

/// Of laws whose ticks failed: their other figures are those of a law without force there.
std::string faults_text(const Json& all) {
  std::string text;
  for (const Json& law : all.at("laws")) {
    if (!law.contains("law_faults")) continue;
    text += text::wrapped(law_name(law) + " gave no force, or none that is finite, on " +
                              number_text(law["law_faults"]) + " ticks: zero force instead",
                          2);
  }
  return text.empty() ? text : "\n" + text;
}

}  // namespace

std::string to_text(const Json& all) {
  // Comparisons from before there was local rendering do not say.
  std::string text = all.value("rendering", "remote") == "local"
                         ? "Rendered locally, but for laws with a server-side law\n\nNetworks\n"
                         : "Networks\n";
  for (std::size_t i = 0; i < all.at("networks").size(); ++i) {
    text += "  (" + std::to_string(i + 1) + ") " + all.at("networks").at(i).get<std::string>() + "\n";
  }
  text +=
      "\n" + passivity_table(all) + "\n" + force_table(all) + "\n" +
      network_table(all, "shown",
                    "Displayed stiffness over the wall's where the contact rests, real device,\nthrough each network") +
      "\n" + network_table(all, "error", "E_dev: error of the force at the device's true position, at its moment") +
      "\n" + network_table(all, "ripple", "Restlessness: deviation of the force over its mean, once contact was made");
  if (!all.at("limits").empty()) {
    text +=
        "\nStiffest wall up to which every wall tried comes to rest, under a light / a\n"
        "usual / a firm hand, the paper's device, ideal [N/mm]; all: up to 1000\n" +
        limits_table(all, "", "").to_text();
  }
  const std::string tuning = tuning_table(all);
  return text + (tuning.empty() ? "" : "\n" + tuning) + faults_text(all);
}

namespace {

/// The networks shown in the Markdown tables: a few, so that the columns fit.
std::vector<std::size_t> shown_networks(const Json& all) {
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
  const std::vector<std::size_t> networks = shown_networks(all);
  std::vector<text::Table::Column> columns{{"law"}, {"least P ideal", "mJ"}, {"least P real", "mJ"}, {"at rest", "%"}};
  for (const char* const what : {"shown, ", "E_dev, "}) {
    for (const std::size_t i : networks) columns.push_back({what + all.at("networks").at(i).get<std::string>(), "%"});
  }
  columns.push_back({"time", "ns"});
  text::Table table(std::move(columns));
  for (const Json& law : all.at("laws")) {
    if (!played(law)) continue;
    std::vector<text::Table::Cell> row{"`" + law_name(law) + "`", results::millijoules(law.at("ideal").at("least_P_J")),
                                       results::millijoules(law.at("real").at("least_P_J")), share(law.at("calm"))};
    for (const char* const what : {"shown", "error"}) {
      for (const std::size_t i : networks) row.emplace_back(share(law.at("behind").at(i).at(what)));
    }
    row.emplace_back(number_text(law.at("work_ns")));
    table.add(std::move(row));
  }
  if (all.at("limits").empty()) return table.to_markdown();
  return table.to_markdown() + "\n" +
         limits_table(all, "stiffest wall at rest under a light/usual/firm hand [N/mm]", "`").to_markdown();
}

}  // namespace forcebound::lab
