#pragma once

#include <memory>
#include <optional>
#include <string>

#include "forcebound/control/law_registry.hpp"
#include "forcebound/server/app/follower_options.hpp"
#include "forcebound/server/app/led_robot.hpp"
#include "forcebound/server/follower/follower_thread.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::server {

/// As StartRobot.
[[nodiscard]] std::unique_ptr<LedRobot> start_follower(const FollowerOptions& options, const control::LawRegistry& laws,
                                                       const time::Clock& clock, std::optional<int> priority);

/// Why there is no robot any more, and what became of it.
[[nodiscard]] std::string loss_in_words(const RobotGuard& guard, const std::string& robot);

/// "following -> holding after 12.4 s; the leader was last heard 101 ms ago".
[[nodiscard]] std::string in_words(const StateChange& change);

/// "the sensor's bias is learned again: by 3 N other than before".
[[nodiscard]] std::string in_words(const SensorBias::Status& bias);

/// The numbers of a robot's run, a line for each subject.
[[nodiscard]] std::string in_words(const FollowerThread::Outcome& outcome);

}  // namespace forcebound::server
