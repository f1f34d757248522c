#pragma once

#include <toml++/toml.h>

#include <functional>
#include <memory>
#include <string>

#include "forcebound/scene/auto_accuracy.hpp"
#include "forcebound/server/environment/checked_table.hpp"

namespace forcebound::server {

/// Of the table [accuracy].
inline constexpr scene::NumberParameter kChangePerSecond{
    .key = "change_per_s",
    .meaning = "how fast the force changes: the RMS of its rate over its own, for the motion the scene is made for",
    .least = 0,
    .least_excluded = true,
    .most = 1e4};

/// Of each of its levels.
inline constexpr scene::NumberParameter kModelError{
    .key = "model_error",
    .meaning = "RMS of the force's error at the same states over RMS of the force",
    .least = 0,
    .most = 100};

/// What a level is compiled by: the value for the key, and how the two are written.
using CompileLevel =
    std::function<std::shared_ptr<const scene::Scene>(const std::string& key, const toml::node& value)>;

/// The table [accuracy] of a scene file, with every level compiled and its cost taken.
/// @throws SceneError
scene::AutoAccuracy parse_accuracy(CheckedTable& file, const CompileLevel& compile, const scene::MeasureCost& measure);

}  // namespace forcebound::server
