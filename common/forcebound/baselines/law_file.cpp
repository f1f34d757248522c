#include "forcebound/baselines/law_file.hpp"

#include "forcebound/config/checked_table.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::baselines {
namespace {

control::LawParameters read_law(config::CheckedTable section, const control::LawDescription& law) {
  control::LawParameters chosen;
  for (const control::LawParameter& parameter : law.parameters) {
    if (section.find(parameter.name) == nullptr) continue;
    const double value = section.number({.key = parameter.name});
    if (!parameter.accepts(value)) section.refuse(parameter.name, parameter.accepted());
    chosen[parameter.name] = value;
  }
  section.refuse_unknown_keys("no parameter");
  return chosen;
}

}  // namespace

control::LawParameters parse_law_parameters(std::string_view toml_text, const std::string& place, std::string_view law,
                                            const control::LawRegistry& laws) {
  const config::Node node = config::parse_toml(toml_text, place);
  config::CheckedTable file(node, place, "law parameters");
  control::LawParameters chosen;
  for (const std::string& name : laws.names()) {
    if (file.find(name) == nullptr) continue;
    const config::Node& own = file.table(name).node();
    const control::LawParameters read = read_law({own, place, "law '" + name + "'"}, laws.find(name));
    if (name == law) chosen = read;
  }
  file.refuse_unknown_keys("no law");
  return chosen;
}

control::LawParameters load_law_parameters(const std::string& file, std::string_view law,
                                           const control::LawRegistry& laws) {
  return parse_law_parameters(text::read_file(file), file, law, laws);
}

std::string describe(const control::LawParameters& parameters) {
  std::string text;
  for (const auto& [name, value] : parameters) text += (text.empty() ? "" : ", ") + name + " " + text::to_text(value);
  return text;
}

}  // namespace forcebound::baselines
