#pragma once

#include <Eigen/Core>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string_view>

#include "forcebound/server/robot/robot.hpp"

namespace forcebound::server {

/// Bias of a force sensor, which drifts: the mean of what the sensor says while the robot stands and touches nothing.
///
/// Nobody tells a sensor's bias from a steady force by its value. What is known: a bias changes slowly and does not ask
/// where the tool is, a contact changes at once and along its own direction. So from one state of *untouched* to the
/// next:
///
///  * while the robot waits for its first leader it touches nothing: what is read is the bias;
///  * it touches something while the reading (smoothed over 50 ms) is farther than kTouch_N or kTouch_N_m, and three
///    standard deviations of the noise, from the last one that was untouched, or while its gripper holds something;
///  * while the robot stands stopped and untouched, the bias is learned anew, and follows the reading;
///  * a reading that stays the same while the tool moves by kWay_m along the force that it would be is untouched: no
///    contact is so soft. So drift that a leader's run brought about is told from touch, and learned at the next stop.
///
/// On command it is learned in any state, and refused while it touches.
///
/// Real time: noexcept, no allocation, O(1).
class SensorBias {
 public:
  static constexpr double kTouch_N = 0.5;
  static constexpr double kTouch_N_m = 0.05;
  static constexpr double kWay_m = 0.02;
  static constexpr int kSamplesLeast = 100;  ///< before it replaces the bias of before

  /// What a command to learn it came to.
  enum class Answer : std::uint8_t { none, learned, no_sensor, no_samples, touches, holds };

  /// @param facts none: there is no sensor
  explicit SensorBias(const std::optional<ForceSensorFacts>& facts) noexcept;

  /// As of one tick of the robot.
  struct Sample {
    Nanoseconds now{0};
    std::optional<SensedForce> sensed{};
    Eigen::Vector3d tool_m{Eigen::Vector3d::Zero()};
    bool waits = false;   ///< for its first leader
    bool stands = false;  ///< stopped
    bool holds = false;   ///< its gripper is kept open by something
  };
  void update(const Sample& sample) noexcept;

  /// Learn it now: `answer` tells what came of it, within kCommandMost.
  void command(Nanoseconds now) noexcept;
  static constexpr Nanoseconds kCommandMost = std::chrono::seconds{5};

  /// Force [N] above torque about the tool's point [N m].
  [[nodiscard]] std::optional<Vector6> without(const std::optional<SensedForce>& sensed) const noexcept {
    if (!sensed) return std::nullopt;
    return Vector6(wrench_of(*sensed) - bias_);
  }

  struct Status {
    std::optional<Nanoseconds> learned{};  ///< when it was last; none: never
    std::uint64_t answers = 0;             ///< to commands so far
    Answer answer = Answer::none;          ///< the last
    double off_N = 0;  ///< where it was learned on command by how much it changed, where it touches by how much more
                       ///< than untouched it reads
  };
  [[nodiscard]] const Status& status() const noexcept { return status_; }

 private:
  /// Where the tool was, and what was read there.
  struct Anchor {
    Eigen::Vector3d tool_m{Eigen::Vector3d::Zero()};
    Vector6 wrench{Vector6::Zero()};
  };

  [[nodiscard]] static Vector6 wrench_of(const SensedForce& sensed) noexcept;
  void smooth(const SensedForce& sensed) noexcept;
  void look_for_free_motion(const Eigen::Vector3d& tool_m) noexcept;
  void learn(const Vector6& wrench, Nanoseconds now, bool at_once) noexcept;
  [[nodiscard]] bool differs(const Vector6& wrench, const Vector6& other, double share) const noexcept;
  void give(Answer answer, double off_N = 0) noexcept;

  bool has_sensor_;
  double touch_N_;
  double touch_N_m_;
  Vector6 bias_{Vector6::Zero()};
  Vector6 mean_{Vector6::Zero()};  // of `count_` samples, the bias to be
  int count_ = 0;
  Vector6 smoothed_{Vector6::Zero()};
  Vector6 untouched_{Vector6::Zero()};
  Anchor anchor_;
  std::optional<Nanoseconds> last_;  // sample
  std::optional<Nanoseconds> commanded_;
  Status status_;
};

/// What a command came to, in words that end a sentence on the sensor's bias.
[[nodiscard]] std::string_view words_of(SensorBias::Answer answer) noexcept;

}  // namespace forcebound::server
