#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "forcebound/client/app/late_force_log.hpp"
#include "forcebound/client/ros2/answer_ages.hpp"
#include "forcebound/client/ros2/options.hpp"
#include "forcebound/client/ros2/state_publisher.hpp"
#include "forcebound/client/ros2/state_queue.hpp"
#include "forcebound/client/ros2/topic_environment.hpp"
#include "forcebound/client/ros2/topics.hpp"
#include "forcebound/client/ros2/wrench_inbox.hpp"
#include "forcebound/server/offer/environment.hpp"
#include "forcebound/time/steady_clock.hpp"

namespace forcebound::ros2 {

/// One hand and its topics: what a publisher asks for, and what is published.
class HandOnTopics {
 public:
  /// @throws std::runtime_error if DDS refuses
  explicit HandOnTopics(const Options& options);

  /// For one client at once.
  [[nodiscard]] server::EnvironmentKind environment();
  static constexpr const char* kSimulated = "nothing: forces are a ROS 2 publisher's";

  /// Gets the ticks of the device here.
  [[nodiscard]] record::TickSink& ticks() noexcept { return queue_; }
  /// Gives these the ages of the wrenches that they apply.
  [[nodiscard]] client::TickAmendment& ages() noexcept { return ages_; }

  /// The domain and the topics, in one line.
  [[nodiscard]] std::string in_words() const { return topics_.in_words(); }

  /// Logs what is new of publishers and their wrenches. To be called several times a second, by one thread.
  void log_news();

  /// A count: of what and in which words in text, and its name in JSON.
  struct Count {
    const char* subject;
    const char* words;
    const char* name;
    std::uint64_t count;
  };
  [[nodiscard]] std::vector<Count> counts() const;

  /// Them in lines, and whether nobody published.
  [[nodiscard]] std::string totals() const;

 private:
  void log_refusals();
  [[nodiscard]] std::string refusal_in_words(Verdict verdict) const;
  void log_age();

  client::LateForcePolicy policy_;
  std::string frame_;
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
