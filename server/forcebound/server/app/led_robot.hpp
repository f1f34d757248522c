#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "forcebound/control/law_registry.hpp"
#include "forcebound/server/offer/environment.hpp"
#include "forcebound/time/clock.hpp"
#include "forcebound/view/description.hpp"

namespace CLI {
class App;
}  // namespace CLI

namespace forcebound::server {

/// A robot that forcebound-server drives in place of a scene, and tells of in log and totals. All that the server knows
/// of robots: a build with FORCEBOUND_ROBOT=OFF has none.
class LedRobot {
 public:
  virtual ~LedRobot() = default;

  /// That clients request; its name is the task's, or `robot`.
  [[nodiscard]] virtual EnvironmentKind environment() const = 0;

  /// Robot, task, architecture and law in a line.
  [[nodiscard]] virtual std::string summary() const = 0;

  /// How it looks.
  [[nodiscard]] virtual const view::Description& appearance() const noexcept = 0;
  /// Where all items of a group of that are now, as Environment::sample.
  [[nodiscard]] virtual std::size_t sample(std::size_t group, std::span<float> to) noexcept = 0;

  /// Logs what changed since the last call.
  virtual void log_changes() = 0;

  /// Learn the bias of its force sensor now; what comes of it is logged.
  virtual void learn_bias() noexcept = 0;

  /// Brings the robot to rest, ends its thread, and logs what changed meanwhile. To be called once no client leads it.
  virtual void stop() = 0;

  /// Whether its driver hangs or has crashed: the process cannot but end, by std::_Exit after `stop`.
  [[nodiscard]] virtual bool is_lost() const noexcept = 0;
  [[nodiscard]] virtual bool has_crashed() const noexcept = 0;

  /// Of all that the robot did, after `stop`: a line for each subject, not broken.
  [[nodiscard]] virtual std::string totals() const = 0;
};

/// Starts a robot and its thread. @param clock must outlive it
/// @param priority of its thread, SCHED_FIFO; none: as any thread
/// @throws std::exception with the reason, in a line, why robot, task, architecture and law do not go together
using StartRobot = std::function<std::unique_ptr<LedRobot>(const control::LawRegistry& laws, const time::Clock& clock,
                                                           std::optional<int> priority)>;

/// Adds --follower and what belongs to it.
/// @param start both must outlive the parsing, which sets this if a robot is asked for, or throws program::End
void add_robot_options(CLI::App& app, StartRobot& start, const control::LawRegistry& laws);

/// Robots, tasks and architectures, for the help.
[[nodiscard]] std::string robot_help();

}  // namespace forcebound::server
