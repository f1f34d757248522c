#pragma once

#include <functional>
#include <memory>
#include <string>

#include "forcebound/config/checked_table.hpp"
#include "forcebound/scene/auto_accuracy.hpp"

namespace forcebound::server {

/// Descriptions of the table [accuracy] and of its levels.
[[nodiscard]] config::TableDescription accuracy_table();
[[nodiscard]] config::TableDescription accuracy_level_table();

/// Compiles the scene of one level: the file with `value` for `key`.
using CompileLevel =
    std::function<std::shared_ptr<const scene::Scene>(const std::string& key, const config::Node& value)>;

/// Reads the table [accuracy] of a scene file, compiles each level and measures its cost.
/// @throws SceneError
scene::AutoAccuracy parse_accuracy(config::CheckedTable& file, const CompileLevel& compile,
                                   const scene::MeasureCost& measure);

}  // namespace forcebound::server
