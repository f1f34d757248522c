#include "forcebound/control/law_description.hpp"

#include <algorithm>
#include <cmath>

#include "forcebound/control/classic_text.hpp"

namespace forcebound::control {

bool LawParameter::accepts(double value) const {
  if (!choices.empty()) return std::ranges::find(choices, value) != choices.end();
  return std::isfinite(value) && value >= least && value <= most;
}

std::string LawParameter::accepted() const {
  ClassicText text;
  if (!choices.empty()) {
    for (std::size_t i = 0; i < choices.size(); ++i) text << (i > 0 ? " or " : "") << choices[i];
  } else if (most < std::numeric_limits<double>::max()) {
    text << least << " to " << most;
  } else {
    text << ">= " << least;
  }
  return text.str();
}

}  // namespace forcebound::control
