#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "forcebound/device/simulated/operator.hpp"

namespace forcebound::device {

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

  /// mass_kg, stiffness_N_per_m, damping_N_s_per_m.
  [[nodiscard]] Hand hand(const Hand& otherwise);

  /// offset_x_m, offset_y_m, ... of as many axes, 0 otherwise.
  [[nodiscard]] Vector offset(int dof);

  /// To be called when all has been read.
  void refuse_other_keys() const;

  /// The specification with every key in it: `NAME:KEY=VALUE,...`.
  [[nodiscard]] std::string complete() const;

 private:
  [[noreturn]] void refuse(const std::string& message) const;
  [[nodiscard]] double take(const std::string& key, double otherwise);

  std::string name_;
  std::vector<std::pair<std::string, double>> given_;
  std::vector<std::pair<std::string, double>> used_;
};

/// Common base of the operators made from a specification.
class SpecifiedOperator : public Operator {
 public:
  [[nodiscard]] std::string_view name() const noexcept final { return name_; }
  [[nodiscard]] const Hand& hand() const noexcept final { return hand_; }
  [[nodiscard]] int degrees_of_freedom() const noexcept final { return dof_; }
  [[nodiscard]] std::string description() const final { return description_; }

 protected:
  SpecifiedOperator(OperatorSettings& settings, int dof, const Hand& hand)
      : name_(settings.name()), dof_(dof), hand_(settings.hand(hand)) {}

  /// To be called last by the constructor: no other key is known.
  void finish(const OperatorSettings& settings) {
    settings.refuse_other_keys();
    description_ = settings.complete();
  }

 private:
  std::string name_;
  int dof_;
  Hand hand_;
  std::string description_;
};

}  // namespace forcebound::device
