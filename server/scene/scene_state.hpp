#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "forcebound/control/vector.hpp"
#include "forcebound/server/scene/scene.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::server {

using control::Vector;
using time::Nanoseconds;

/// What the scene answers to one motion; the vectors have the device's rows, rotations are zero.
struct SceneAnswer {
  Vector force;                              ///< on the device [N], then torque [N m]; always finite
  Vector contact_normal{};                   ///< unit, out of the surface touched (deepest one); no rows: no contact
  double penetration_m = 0;                  ///< depth below that surface, 0: no contact
  Texture texture{};                         ///< of that surface
  const std::string* quarantined = nullptr;  ///< the object or field left out from now on; null: none on this motion
};

/// What went wrong within a scene and was kept from the client.
struct SceneFaults {
  std::uint64_t old_normals = 0;  ///< contacts whose direction had to be the last valid one
  std::uint64_t quarantined = 0;  ///< objects and fields whose force was not finite: left out from then on
};

/// One client's state of a scene.
///
/// An object or field whose force is not finite is left out from then on, for this client; the others keep their
/// states.
///
/// Real time: `answer` is noexcept, allocates nothing and is O(effects). Not thread-safe.
class SceneState {
 public:
  /// The scene accepts so many degrees of freedom.
  SceneState(std::shared_ptr<const Scene> scene, std::uint32_t degrees_of_freedom);

  /// One object or field of it alone, the step of the plan.
  static SceneState of_step(std::shared_ptr<const Scene> scene, std::uint32_t degrees_of_freedom, std::size_t step);

  /// The force for a device that was at `position` (finite, one row per degree of freedom) at `device_time` on its own
  /// clock. The velocity is the mean since the previous call; a time that does not advance gives none.
  [[nodiscard]] SceneAnswer answer(const Vector& position, Nanoseconds device_time) noexcept;

  /// With the device's rows; rotations are zero.
  [[nodiscard]] Vector in_device_rows(const Point& point) const noexcept;

  [[nodiscard]] const Scene& scene() const noexcept { return *scene_; }
  [[nodiscard]] const SceneFaults& faults() const noexcept { return faults_; }

 private:
  void look_at_time(Probe& probe, Nanoseconds device_time) noexcept;
  [[nodiscard]] SurfacePoint find_surface(const PlanStep& step, const Point& position_m) noexcept;
  void act(const PlanStep& step, Probe& probe, Reaction& reaction) noexcept;
  void run(std::uint32_t begin, std::uint32_t end, const Probe& probe, Reaction& reaction) noexcept;
  void forget(std::uint32_t begin, std::uint32_t end) noexcept;

  std::shared_ptr<const Scene> scene_;
  Eigen::Index rows_;                 ///< of the device
  Eigen::Index translations_;         ///< of them
  std::vector<std::byte> bytes_;      ///< the states of all effects and shapes
  std::vector<std::uint32_t> steps_;  ///< of the plan, less those quarantined
  Point last_position_m_ = Point::Zero();
  Nanoseconds first_time_{0};
  Nanoseconds last_time_{0};
  bool has_last_ = false;
  SceneFaults faults_;
};

}  // namespace forcebound::server
