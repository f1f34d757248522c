#include "tests/tools/lab/accuracy/levels_text.hpp"

#include <algorithm>
#include <stdexcept>

#include "forcebound/text/numbers.hpp"

namespace forcebound::lab {

std::string levels_text(const StudyResult& result) {
  if (result.same_scene)
    throw std::runtime_error("levels need a key of a scene; '" + result.key + "' is a key of the session");
  std::string text = "# With accuracy = \"auto\" in [scene]. Measured by forcebound-lab accuracy: " + result.hand +
                     ".\n[accuracy]\nkey = \"" + result.key +
                     "\"\nchange_per_s = " + text::rounded(result.change_per_s) + "\n";
  if (result.extrapolation_per_s > 0)
    text += "extrapolation_per_s = " + text::rounded(result.extrapolation_per_s) + "\n";
  text += "levels = [\n";
  int levels = 0;
  for (const StudiedSetting& setting : result.settings) {
    if (!setting.trouble.empty()) continue;
    ++levels;
    text += "  { value = " + setting.value +
            ", model_error = " + text::rounded(std::max(setting.at_states.force, result.reference_uncertainty)) +
            " },\n";
  }
  if (levels < 2) {
    throw std::runtime_error("levels need two settings that work, of " + result.key + " " + std::to_string(levels) +
                             " did");
  }
  return text + "]\n";
}

}  // namespace forcebound::lab
