#include "forcebound/control/law_registry.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "forcebound/control/classic_text.hpp"
#include "forcebound/control/exact_law.hpp"
#include "forcebound/control/less_conservative_law.hpp"
#include "forcebound/control/more_conservative_law.hpp"
#include "forcebound/control/transparent_law.hpp"

namespace forcebound::control {
namespace {

std::string words_of(LawCertainty certainty) {
  switch (certainty) {
    case LawCertainty::published:
      return "as published";
    case LawCertainty::likely:
      return "the published idea; details are ours";
    case LawCertainty::reconstruction:
      return "a reconstruction from a description; its authors may have done otherwise";
  }
  return {};
}

std::string words_of(LawClaim claim) {
  switch (claim) {
    case LawClaim::nothing:
      return "nothing";
    case LawClaim::passive_if_ideal:
      return "passivity on straight axes with ideal encoders, punctual ticks and immediate forces";
    case LawClaim::passive:
      return "passivity with the device's encoder, clock, latency and friction";
  }
  return {};
}

/// " (Kim 2010; likely)"
std::string source_of(const LawDescription& law) {
  if (law.reference.empty()) return {};
  const char* const doubt = law.certainty == LawCertainty::published ? ""
                            : law.certainty == LawCertainty::likely  ? "; likely"
                                                                     : "; reconstruction";
  return " (" + law.reference + doubt + ")";
}

[[noreturn]] void refuse_unknown(const LawDescription& law, const std::string& name) {
  std::string known;
  for (const LawParameter& parameter : law.parameters) known += (known.empty() ? "" : ", ") + parameter.name;
  throw std::invalid_argument("law '" + law.name + "' has no parameter '" + name + "'" +
                              (known.empty() ? "; there are none" : " (known: " + known + ")"));
}

std::string heading_of(const LawDescription& law) {
  std::string text = law.name + ": " + law.summary + "\n";
  if (!law.reference.empty()) text += "  after " + law.reference + ", " + words_of(law.certainty) + "\n";
  text += "  promises " + words_of(law.claim) + "\n";
  if (law.make_server_side) text += "  has a server-side law\n";
  return text;
}

std::string columns(const std::vector<std::pair<std::string, std::string>>& rows) {
  std::size_t width = 0;
  for (const auto& [name, words] : rows) width = std::max(width, name.size());
  std::string text;
  for (const auto& [name, words] : rows) {
    text.append("  ").append(name).append(width - name.size() + 2, ' ').append(words).append("\n");
  }
  return text;
}

}  // namespace

void LawRegistry::add(LawDescription law) {
  if (std::ranges::any_of(laws_, [&](const LawDescription& known) { return known.name == law.name; })) {
    throw std::invalid_argument("there is a law '" + law.name + "' already");
  }
  if (!law.make) throw std::invalid_argument("law '" + law.name + "' has nothing to make it with");
  for (const LawParameter& parameter : law.parameters) {
    if (parameter.standard) continue;
    throw std::invalid_argument("law '" + law.name + "': parameter '" + parameter.name + "' has no standard value");
  }
  laws_.push_back(std::move(law));
}

const LawDescription& LawRegistry::find(std::string_view name) const {
  const auto found = std::ranges::find_if(laws_, [&](const LawDescription& law) { return law.name == name; });
  if (found != laws_.end()) return *found;
  std::string known;
  for (const LawDescription& law : laws_) known += (known.empty() ? "" : ", ") + law.name;
  throw std::invalid_argument("unknown law '" + std::string(name) + "' (known: " + known + ")");
}

LawParameters LawRegistry::parameters(std::string_view name, const DeviceFacts& facts,
                                      const LawParameters& chosen) const {
  const LawDescription& law = find(name);
  LawParameters all = chosen;
  for (const auto& [key, value] : chosen) {
    const auto parameter = std::ranges::find(law.parameters, key, &LawParameter::name);
    if (parameter == law.parameters.end()) refuse_unknown(law, key);
    if (parameter->accepts(value)) continue;
    throw std::invalid_argument(
        joined("law '", law.name, "': ", key, " must be ", parameter->accepted(), ", got ", value));
  }
  for (const LawParameter& parameter : law.parameters) {
    if (!all.contains(parameter.name)) all[parameter.name] = parameter.standard(facts);
  }
  return all;
}

std::unique_ptr<PassivityLaw> LawRegistry::make(std::string_view name, const DeviceFacts& facts,
                                                const LawOptions& options) const {
  return find(name).make(facts, {options.memory, parameters(name, facts, options.parameters)});
}

std::string LawRegistry::refusal(std::string_view name, const DeviceFacts& facts, const LawOptions& options) const {
  (void)find(name);  // an unknown name is an error, not a refusal
  try {
    (void)make(name, facts, options);
  } catch (const std::invalid_argument& refused) {
    return refused.what();
  }
  return {};
}

std::unique_ptr<ServerSideLaw> LawRegistry::make_server_side(std::string_view law, int degrees_of_freedom) const {
  const auto found = std::ranges::find_if(
      laws_, [&](const LawDescription& known) { return known.name == law && known.make_server_side != nullptr; });
  return found == laws_.end() ? nullptr : found->make_server_side(degrees_of_freedom);
}

std::vector<std::string> LawRegistry::names() const {
  std::vector<std::string> result;
  for (const LawDescription& law : laws_) result.push_back(law.name);
  return result;
}

std::string LawRegistry::help() const {
  std::vector<std::pair<std::string, std::string>> rows;
  for (const LawDescription& law : laws_) {
    rows.emplace_back(law.name, law.summary + source_of(law));
  }
  return columns(rows);
}

std::string LawRegistry::guarantee(std::string_view name) const {
  switch (find(name).claim) {
    case LawClaim::nothing:
      return {};
    case LawClaim::passive_if_ideal:
      return "P >= 0 only on straight axes with an ideal encoder, punctual ticks and forces that act at once, which no "
             "real device has";
    case LawClaim::passive:
      return "P >= 0 as long as damping, friction, encoder, torque, clock, stamps, latency and hold time stay within "
             "the bounds of the device's description and no command is lost unreported";
  }
  return {};
}

std::string LawRegistry::help(std::string_view name) const {
  const LawDescription& law = find(name);
  std::vector<std::pair<std::string, std::string>> rows;
  for (const LawParameter& parameter : law.parameters) {
    rows.emplace_back(parameter.name, parameter.purpose + "; " + parameter.accepted());
  }
  return heading_of(law) + columns(rows);
}

std::string LawRegistry::help(std::string_view name, const DeviceFacts& facts) const {
  std::string text = help(name);
  std::vector<std::pair<std::string, std::string>> rows;
  for (const auto& [key, value] : parameters(name, facts)) rows.emplace_back(key, joined(value));
  if (!rows.empty()) text += "\nStandard values on '" + facts.name + "':\n" + columns(rows);
  const std::string refused = refusal(name, facts);
  return refused.empty() ? text : text + "\nBut it refuses: " + refused + "\n";
}

namespace {

template <typename Law>
std::unique_ptr<PassivityLaw> make_published(const DeviceFacts& facts, const LawOptions& /*options*/) {
  return std::make_unique<Law>(facts.degrees_of_freedom(), facts.period_s);
}

}  // namespace

LawRegistry published_laws() {
  LawRegistry laws;
  laws.add({.name = "none",
            .summary = "no bound: what the environment asks for is applied",
            .shortens = true,
            .make = make_published<TransparentLaw>});
  laws.add({.name = "fba-less",
            .summary = "less conservative force bounding: spends all energy ever saved",
            .reference = "Kim 2015, Prop. 1",
            .claim = LawClaim::passive_if_ideal,
            .shortens = true,
            .make = make_published<LessConservativeLaw>});
  laws.add({.name = "fba-more",
            .summary = "more conservative force bounding: forgets free space, rests where readings are exact",
            .reference = "Kim 2015, Prop. 3",
            .claim = LawClaim::passive_if_ideal,
            .shortens = true,
            .make = make_published<MoreConservativeLaw>});
  return laws;
}

LawRegistry force_bounding_laws() {
  LawRegistry laws = published_laws();
  laws.add({.name = "fba-exact",
            .summary = "credits a lower bound on the dissipated energy: passive with real encoders, clocks and latency",
            .claim = LawClaim::passive,
            .shortens = true,
            .make = [](const DeviceFacts& facts, const LawOptions& options) {
              return std::make_unique<ExactLaw>(facts, options.memory);
            }});
  return laws;
}

}  // namespace forcebound::control
