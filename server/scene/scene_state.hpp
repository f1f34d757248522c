#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "forcebound/control/vector.hpp"
#include "forcebound/server/scene/scene.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::server {

using control::Vector;
using time::Nanoseconds;

/// What the scene answers to one motion; the vectors have the device's rows, rotations are zero.
struct SceneAnswer {
  Vector force;              ///< on the device [N], then torque [N m]; always finite
  Vector contact_normal;     ///< unit, out of the surface touched (deepest one); no rows: no contact
  double penetration_m = 0;  ///< depth below that surface, 0: no contact
};

/// What went wrong within a scene and was kept from the client.
struct SceneFaults {
  std::uint64_t old_normals = 0;        ///< contacts whose direction had to be the last valid one
  std::uint64_t non_finite_forces = 0;  ///< an object's force that was not finite; it counted as zero
};

/// One client's state of a scene.
///
/// Real time: `answer` is noexcept, allocates nothing and is O(objects). Not thread-safe.
class SceneState {
 public:
  /// The scene accepts so many degrees of freedom.
  SceneState(std::shared_ptr<const Scene> scene, std::uint32_t degrees_of_freedom);

  /// The force for a device that was at `position` (finite, one row per degree of freedom) at `device_time` on its own
  /// clock. The velocity is the mean since the previous call; a time that does not advance gives none.
  [[nodiscard]] SceneAnswer answer(const Vector& position, Nanoseconds device_time) noexcept;

  [[nodiscard]] const Scene& scene() const noexcept { return *scene_; }
  [[nodiscard]] const SceneFaults& faults() const noexcept { return faults_; }

 private:
  [[nodiscard]] Point velocity_at(const Point& position_m, Nanoseconds device_time) noexcept;

  std::shared_ptr<const Scene> scene_;
  Eigen::Index rows_;                ///< of the device
  Eigen::Index translations_;        ///< of them
  std::vector<Point> last_normals_;  ///< per step of the plan
  Point last_position_m_ = Point::Zero();
  Nanoseconds last_time_{0};
  bool has_last_ = false;
  SceneFaults faults_;
};

}  // namespace forcebound::server
