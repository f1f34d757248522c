#pragma once

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "forcebound/device/simulated/operator.hpp"

namespace forcebound::device {

/// A button of the handle that the hand presses for a time.
struct Press {
  int button = 0;
  double from_s = 0;
  double until_s = std::numeric_limits<double>::infinity();
};

/// The `key=value,...` of an operator's specification, read key by key.
///
/// @throws std::invalid_argument from every member: `operator 'NAME': KEY must be ..., got ...`.
class OperatorSettings {
 public:
  enum class Allowed { positive, not_negative, any };

  OperatorSettings(std::string name, std::string_view text);

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] double number(const std::string& key, Allowed allowed, double otherwise);
  [[nodiscard]] int integer(const std::string& key, int least, int most, int otherwise);

  /// mass_kg, stiffness_N_per_m, damping_N_s_per_m; on a tip that turns also inertia_kg_m2,
  /// rotation_stiffness_N_m_per_rad, rotation_damping_N_m_s_per_rad.
  [[nodiscard]] Hand hand(const Hand& otherwise);

  /// offset_x_m, offset_y_m, ... of as many axes, 0 otherwise.
  [[nodiscard]] Vector offset(int dof);

  /// button, button_from_s, button_until_s; none of them given: it presses none, and none is in `complete`.
  [[nodiscard]] std::optional<Press> press();

  /// How the hand turns a tip that turns: each axis in a sine of its own pace, faded in during the first second.
  struct Turning {
    Eigen::Vector3d amplitude_rad = Eigen::Vector3d::Zero();
    double frequency_Hz = 0;
  };
  /// turn_x_rad, turn_y_rad, turn_z_rad, turn_Hz.
  [[nodiscard]] Turning turning();

  /// The device's tip turns: the hand has keys for that, else unknown ones.
  void hold_a_turning_tip() noexcept { tip_turns_ = true; }

  /// To be called when all has been read.
  void refuse_other_keys() const;

  /// The specification with every key in it: `NAME:KEY=VALUE,...`.
  [[nodiscard]] std::string complete() const;

 private:
  [[noreturn]] void refuse(const std::string& message) const;
  [[nodiscard]] double use(const std::string& key, double otherwise);

  std::string name_;
  bool tip_turns_ = false;
  std::vector<std::pair<std::string, double>> given_;
  std::vector<std::pair<std::string, double>> used_;
  std::vector<std::string> also_known_;
};

/// Common base of the operators made from a specification.
class SpecifiedOperator : public Operator {
 public:
  [[nodiscard]] std::string_view name() const noexcept final { return name_; }
  [[nodiscard]] const Hand& hand() const noexcept final { return hand_; }
  [[nodiscard]] int degrees_of_freedom() const noexcept final { return dof_; }
  [[nodiscard]] std::string description() const final { return description_; }
  [[nodiscard]] control::Handle handle(double time_s) const noexcept override;
  [[nodiscard]] Eigen::Vector3d turn(double time_s) const noexcept final;

 protected:
  SpecifiedOperator(OperatorSettings& settings, int dof, const Hand& hand)
      : name_(settings.name()), dof_(dof), hand_(settings.hand(hand)) {}

  /// By itself, in place of what the settings say.
  void presses(const Press& press) noexcept { press_ = press; }

  /// To be called last by the constructor: no other key is known.
  void finish(OperatorSettings& settings) {
    if (!press_) press_ = settings.press();
    turning_ = settings.turning();
    settings.refuse_other_keys();
    description_ = settings.complete();
  }

  /// Behind what finish has written.
  void add_to_description(const std::string& words) { description_ += words; }

 private:
  std::string name_;
  int dof_;
  Hand hand_;
  std::optional<Press> press_{};
  OperatorSettings::Turning turning_{};
  std::string description_;
};

}  // namespace forcebound::device
