#pragma once

#include "forcebound/client/ros2/answer_ages.hpp"
#include "forcebound/client/ros2/state_queue.hpp"
#include "forcebound/client/ros2/wrench_inbox.hpp"
#include "forcebound/client/session/late_force_policy.hpp"
#include "forcebound/server/offer/environment.hpp"

namespace forcebound::ros2 {

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
