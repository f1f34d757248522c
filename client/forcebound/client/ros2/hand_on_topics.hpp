#pragma once

#include <string>

#include "forcebound/client/app/late_force_log.hpp"
#include "forcebound/client/ros2/options.hpp"
#include "forcebound/client/ros2/state_publisher.hpp"
#include "forcebound/client/ros2/state_queue.hpp"
#include "forcebound/client/ros2/topic_environment.hpp"
#include "forcebound/client/ros2/topics.hpp"
#include "forcebound/client/ros2/wrench_inbox.hpp"
#include "forcebound/server/offer/environment_library.hpp"
#include "forcebound/time/steady_clock.hpp"

namespace forcebound::ros2 {

/// One hand and its topics: what a publisher asks for, and what is published.
class HandOnTopics {
 public:
  /// @throws std::runtime_error if DDS refuses
  explicit HandOnTopics(const Options& options);

  /// Its environment alone, for one client at once.
  [[nodiscard]] server::EnvironmentLibrary environments();

  /// Gets the ticks of the device here.
  [[nodiscard]] record::TickSink& ticks() noexcept { return queue_; }

  /// Logs what is new of publishers and their wrenches. To be called several times a second, by one thread.
  void log_news();

  /// What was counted, in lines.
  [[nodiscard]] std::string totals() const;

 private:
  void log_refusals();
  void log_age();

  client::LateForcePolicy policy_;
  bool is_remote_;
  time::SteadyClock clock_{};
  WrenchInbox inbox_;
  AnswerAges ages_{};
  StateQueue queue_{};
  Topics topics_;
  StatePublisher publisher_;
  WrenchInbox::Counts told_{};  // from here on of the thread that logs
  record::ForcePolicy told_policy_ = record::ForcePolicy::none;
  Nanoseconds not_fresh_since_{0};
  client::LateForceLog late_forces_{};
};

}  // namespace forcebound::ros2
