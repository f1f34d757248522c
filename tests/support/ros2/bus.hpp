#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

/// What a ROS 2 node would be to forcebound-ros2: a publisher of wrenches that subscribes to all that goes out.
namespace forcebound::ros2_peer {

struct Header {
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
  std::string frame{};

  [[nodiscard]] std::int64_t stamp_ns() const { return std::int64_t{sec} * 1'000'000'000 + nanosec; }
  void each(auto& with) {
    with(sec);
    with(nanosec);
    with(frame);
  }
};

/// geometry_msgs: PoseStamped is seven numbers, TwistStamped and WrenchStamped six.
template <std::size_t kNumbers>
struct Numbers {
  Header header{};
  std::array<double, kNumbers> values{};

  void each(auto& with) {
    header.each(with);
    for (double& value : values) with(value);
  }
};
using Pose = Numbers<7>;
using Twist = Numbers<6>;
using Wrench = Numbers<6>;

struct JointState {
  Header header{};
  std::vector<std::string> name{};
  std::vector<double> position{};
  std::vector<double> velocity{};
  std::vector<double> effort{};

  void each(auto& with) {
    header.each(with);
    with(name);
    with(position);
    with(velocity);
    with(effort);
  }
};

struct Joy {
  Header header{};
  std::vector<float> axes{};
  std::vector<std::int32_t> buttons{};

  void each(auto& with) {
    header.each(with);
    with(axes);
    with(buttons);
  }
};

struct OperatingState {
  Header header{};
  std::string state{};
  std::uint8_t is_homed = 0;
  std::uint8_t is_busy = 0;

  void each(auto& with) {
    header.each(with);
    with(state);
    with(is_homed);
    with(is_busy);
  }
};

/// Called on threads of DDS.
struct Ears {
  std::function<void(const Pose&)> pose;
  std::function<void(const Twist&)> twist;
  std::function<void(const Wrench&)> wrench;
  std::function<void(const JointState&)> joints;
  std::function<void(const Joy&)> joy;
  std::function<void(const OperatingState&)> state;
};

struct Settings {
  std::uint32_t domain = 0;
  std::string name_space{};
  std::string type{"geometry_msgs::msg::dds_::WrenchStamped_"};  ///< of what it publishes
  bool best_effort = false;
  bool exclusive = false;  ///< it owns its topic
};

class Bus {
 public:
  virtual ~Bus() = default;
  virtual void publish(const Wrench& wrench) = 0;
  /// Whether somebody subscribes to its wrenches.
  [[nodiscard]] virtual bool matched() const = 0;
};

[[nodiscard]] std::unique_ptr<Bus> fast_bus(const Settings& settings, Ears ears);
[[nodiscard]] std::unique_ptr<Bus> cyclone_bus(const Settings& settings, Ears ears);

}  // namespace forcebound::ros2_peer
