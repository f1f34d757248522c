#pragma once

#include <functional>
#include <memory>
#include <string>

#include "forcebound/config/checked_table.hpp"
#include "forcebound/scene/auto_accuracy.hpp"

namespace forcebound::server {

/// [accuracy] and a level of it.
[[nodiscard]] config::TableDescription accuracy_table();
[[nodiscard]] config::TableDescription accuracy_level_table();

/// What a level is compiled by: the value for the key, and how the two are written.
using CompileLevel =
    std::function<std::shared_ptr<const scene::Scene>(const std::string& key, const config::Node& value)>;

/// The table [accuracy] of a scene file, with every level compiled and its cost taken.
/// @throws SceneError
scene::AutoAccuracy parse_accuracy(config::CheckedTable& file, const CompileLevel& compile,
                                   const scene::MeasureCost& measure);

}  // namespace forcebound::server
