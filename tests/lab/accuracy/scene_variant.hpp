#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace forcebound::lab {

/// One key of a scene file, and what is to be tried for it.
struct Sweep {
  std::string key;                    ///< "tissue.pad.shape.cells"; a "[[tissue]]" is found by its name
  std::vector<std::string> values{};  ///< each as TOML writes it, "[4, 4, 2]"
};

/// "KEY=V1,V2,..." with values as TOML writes them; commas within brackets and quotes do not separate.
/// @throws std::invalid_argument
Sweep parse_sweep(std::string_view sweep);

/// The text of a scene with another value for a key, which may be new.
/// @throws std::invalid_argument naming what is not there
std::string scene_variant(std::string_view scene_text, const std::string& key, const std::string& value);

/// The text of a scene without the levels that it may be picked from.
std::string without_levels(std::string_view scene_text);

}  // namespace forcebound::lab
