#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "forcebound/client/ros2/state_queue.hpp"
#include "forcebound/client/ros2/wrench_inbox.hpp"
#include "forcebound/client/session/late_force_policy.hpp"
#include "forcebound/server/offer/environment.hpp"

namespace forcebound::ros2 {

/// How old the wrenches were that motions were answered with. Counted by one thread, read by any.
class AnswerAges {
 public:
  using Counts = std::array<std::uint64_t, 4>;  ///< by record::ForcePolicy

  void add(record::ForcePolicy policy, Nanoseconds age) noexcept;

  [[nodiscard]] Counts counts() const noexcept;
  /// Of the newest answer.
  [[nodiscard]] record::ForcePolicy newest() const noexcept { return newest_.load(std::memory_order_relaxed); }
  [[nodiscard]] Nanoseconds age() const noexcept { return Nanoseconds{age_.load(std::memory_order_relaxed)}; }

 private:
  std::array<std::atomic<std::uint64_t>, 4> counts_{};
  std::atomic<record::ForcePolicy> newest_{record::ForcePolicy::none};
  std::atomic<Nanoseconds::rep> age_{0};
};

/// An environment whose force is the newest wrench of a ROS 2 topic: held up to the age `hold`, then fading, zero from
/// `drop` on. The age is since its arrival. That of the answer on its way to a remote client counts there again.
///
/// Real time: `respond` is noexcept, allocates nothing and never waits.
class TopicEnvironment final : public server::Environment {
 public:
  /// All must outlive it. @param answered gets each motion with the force that answers it; null: nobody wants them
  TopicEnvironment(WrenchInbox& inbox, const client::LateForcePolicy& policy, AnswerAges& ages, bool shows_torque,
                   StateQueue* answered)
      : inbox_(inbox), policy_(policy), ages_(ages), shows_torque_(shows_torque), answered_(answered) {}

  [[nodiscard]] server::Answer respond(const server::Motion& motion) noexcept override;

 private:
  WrenchInbox& inbox_;
  client::LateForcePolicy policy_;
  AnswerAges& ages_;
  bool shows_torque_;
  StateQueue* answered_;
};

}  // namespace forcebound::ros2
