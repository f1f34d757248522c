#include "forcebound/control/law_registry.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "forcebound/control/exact_law.hpp"
#include "forcebound/control/less_conservative_law.hpp"
#include "forcebound/control/more_conservative_law.hpp"
#include "forcebound/control/transparent_law.hpp"

namespace forcebound::control {

void LawRegistry::add(std::string name, std::string summary, Factory factory) {
  if (std::ranges::any_of(entries_, [&](const Entry& entry) { return entry.name == name; })) {
    throw std::invalid_argument("there is a law '" + name + "' already");
  }
  entries_.push_back({std::move(name), std::move(summary), std::move(factory)});
}

std::unique_ptr<PassivityLaw> LawRegistry::make(std::string_view name, const DeviceFacts& facts,
                                                const LawOptions& options) const {
  for (const Entry& entry : entries_) {
    if (entry.name == name) return entry.factory(facts, options);
  }
  std::string known;
  for (const Entry& entry : entries_) known += (known.empty() ? "" : ", ") + entry.name;
  throw std::invalid_argument("unknown law '" + std::string(name) + "'; known are " + known);
}

std::vector<std::string> LawRegistry::names() const {
  std::vector<std::string> result;
  for (const Entry& entry : entries_) result.push_back(entry.name);
  return result;
}

std::string LawRegistry::help() const {
  std::size_t width = 0;
  for (const Entry& entry : entries_) width = std::max(width, entry.name.size());
  std::string text;
  for (const Entry& entry : entries_) {
    text += "  " + entry.name + std::string(width - entry.name.size() + 2, ' ') + entry.summary + "\n";
  }
  return text;
}

namespace {

template <typename Law>
std::unique_ptr<PassivityLaw> make_published(const DeviceFacts& facts, const LawOptions& /*options*/) {
  return std::make_unique<Law>(facts.degrees_of_freedom(), facts.period_s);
}

}  // namespace

LawRegistry published_laws() {
  LawRegistry laws;
  laws.add("none", "no bound: what the environment asks for is applied", make_published<TransparentLaw>);
  laws.add("fba-less", "less conservative force bounding: spends all energy ever saved (Kim 2015, Prop. 1)",
           make_published<LessConservativeLaw>);
  laws.add("fba-more", "more conservative force bounding: forgets free space, does not ring (Kim 2015, Prop. 3)",
           make_published<MoreConservativeLaw>);
  return laws;
}

LawRegistry shipped_laws() {
  LawRegistry laws = published_laws();
  laws.add("fba-exact", "least energy consistent with the readings: passive with real encoders, clocks and latency",
           [](const DeviceFacts& facts, const LawOptions& options) {
             return std::make_unique<ExactLaw>(facts, options.memory);
           });
  return laws;
}

}  // namespace forcebound::control
