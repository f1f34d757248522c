#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace forcebound::scene {

class Scene;

/// Time to answer one motion in a scene [s].
using MeasureCost = std::function<double(const std::shared_ptr<const Scene>&)>;

/// One of the scenes that a scene with `accuracy = "auto"` may be.
struct AccuracyLevel {
  std::string value;                     ///< of the key, as the file has it
  double model_error = 0;                ///< RMS of the force's error at the same states, over the RMS of the force
  double step_s = 0;                     ///< time to answer a motion
  std::shared_ptr<const Scene> scene{};  ///< with that value
};

/// The levels of accuracy of a scene, and their errors at the device. A force is wrong because its model is rough, and
/// because it is late; the more exact model is the later one. With the two independent, the error at the device is
///
///     E = sqrt(model^2 + (change * age)^2),   age = round trip + step + T/2 + max(step, T)/2
///
/// approximately, where `change` is the RMS of the force's rate of change over its RMS, for the motion that the scene
/// is made for, and T the device's tick. The last two terms are the mean wait until the device's next tick, and half
/// the time until the next force.
///
/// A client that renders locally is left with less of the change: with nothing where it computes the force itself, with
/// what its local models miss where these travel. So a finer level is worth more of its time there.
struct AutoAccuracy {
  std::string key;                  ///< of the scene file, "tissue.pad.shape.cells"
  double change_per_s = 0;          ///< see above
  double change_locally_per_s = 0;  ///< the same for a client that renders locally
  std::vector<AccuracyLevel> levels{};

  /// Who asks.
  struct Client {
    double round_trip_s = 0;
    bool renders_locally = false;
  };

  /// E of a level at a client.
  [[nodiscard]] double expected_error(const AccuracyLevel& level, const Client& client) const;

  /// The level with the least E. There must be at least one level.
  [[nodiscard]] const AccuracyLevel& best(const Client& client) const;

  /// The level picked and the reason, as one line of text.
  [[nodiscard]] std::string text(const AccuracyLevel& picked, const Client& client) const;
};

}  // namespace forcebound::scene
