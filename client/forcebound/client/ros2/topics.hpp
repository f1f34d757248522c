#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "forcebound/client/ros2/peer_watch.hpp"
#include "forcebound/client/ros2/state_queue.hpp"
#include "forcebound/client/ros2/velocity_window.hpp"
#include "forcebound/client/ros2/wrench_inbox.hpp"

namespace forcebound::ros2 {

/// CRTK's states of a robot, of those that a device has.
enum class OperatingState : std::uint8_t { disabled, enabled, fault };

/// The topics of one hand, as ROS 2 has them on DDS, by CRTK's names:
///
///     servo_cf         in   WrenchStamped   best effort, what a publisher asks for
///     measured_cp      out  PoseStamped     reliable, so that both kinds of subscriptions match
///     measured_cv      out  TwistStamped
///     measured_cf      out  WrenchStamped   what was applied
///     measured_js      out  JointState      where joints are known
///     joy              out  Joy             where there are buttons or a gripper
///     operating_state  out  OperatingState  latched
///
/// All keep the last ten. Stamps are the readings' by the wall clock. Not real time: DDS allocates and takes locks, on
/// threads of its own. One thread publishes, one other asks for news.
class Topics {
 public:
  struct Settings {
    unsigned domain = 0;
    std::string name_space{};  ///< as checked_namespace gives it
    std::string frame{"forcebound"};
    bool beyond_this_machine = false;  ///< where CYCLONEDDS_URI says; otherwise on the loopback alone
  };

  /// @param inbox gets what arrives; must outlive it
  /// @throws std::runtime_error in one line if DDS refuses
  Topics(const Settings& settings, WrenchInbox& inbox);
  ~Topics();
  Topics(const Topics&) = delete;
  Topics& operator=(const Topics&) = delete;

  void publish(const StateSample& sample, const std::optional<Velocity>& velocity);

  /// Does nothing if that was the last.
  void publish(OperatingState state, bool is_busy);

  /// The domain and the topics, in one line.
  [[nodiscard]] std::string in_words() const;
  /// As ROS 2 calls it.
  [[nodiscard]] std::string wrench_topic() const;

  /// As PeerWatch's, of who else is on these topics.
  [[nodiscard]] std::vector<News> take_news();
  [[nodiscard]] const PeerWatch::Publishers& publishers() const noexcept;

  /// Messages that DDS did not take. Any thread.
  [[nodiscard]] std::uint64_t not_written() const noexcept;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace forcebound::ros2
