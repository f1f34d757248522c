#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tests/tools/lab/accuracy/along.hpp"
#include "tests/tools/lab/accuracy/device_run.hpp"

namespace forcebound::lab {

/// The reference force of a scene at any states: another scene's, or the limit of a series of ever finer ones.
class ReferenceModel {
 public:
  /// An exact scene, such as a closed form, or one with a known uncertainty.
  ReferenceModel(std::shared_ptr<const scene::Scene> scene, double uncertainty, std::string why);

  /// How the levels of a refinement may be used.
  enum class Levels : std::uint8_t {
    extrapolated,    ///< each is a function of the state, and so is their limit
    only_the_finest  ///< each depends on its own history: there is no limit at a state
  };

  /// From the last three levels, coarse to fine, by Richardson's extrapolation along saved states, if they allow it;
  /// otherwise, and where they do not converge, the finest.
  /// @param levels at least two
  /// @param spacings of each, falling
  /// @param runs of each, along the same states
  ReferenceModel(std::span<const std::shared_ptr<const scene::Scene>> levels, std::span<const double> spacings,
                 std::span<const Along> runs, Levels use = Levels::extrapolated);

  /// Along the states of these runs of the levels.
  [[nodiscard]] Along along(std::span<const Along> runs) const;

  /// Fills in the reference of each tick, at the device's true position.
  void fill_in(DeviceRun& run) const;

  [[nodiscard]] double uncertainty() const noexcept { return uncertainty_; }  ///< a share of its RMS
  [[nodiscard]] double order() const noexcept { return order_; }              ///< observed; 0: none
  [[nodiscard]] const std::string& why() const noexcept { return why_; }

 private:
  std::shared_ptr<const scene::Scene> fine_;
  std::shared_ptr<const scene::Scene> middle_;  ///< null: nothing to extrapolate from
  double further_ = 0;                          ///< F = F0 + further (F0 - F1)
  double uncertainty_ = 0;
  double order_ = 0;
  std::string why_;
};

}  // namespace forcebound::lab
