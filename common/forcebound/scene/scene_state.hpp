#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "forcebound/answer/answer.hpp"
#include "forcebound/control/vector.hpp"
#include "forcebound/scene/dynamic_model_coupling.hpp"
#include "forcebound/scene/scene.hpp"

namespace forcebound::scene {

using answer::Answer;
using control::Vector;

class ToolTouch;
struct ToolFelt;
struct ToolPose;

/// Faults within a scene that were kept from the client.
struct SceneFaults {
  std::uint64_t old_normals = 0;  ///< contacts that reused the last valid direction
  /// Objects, fields and dynamic models whose force was not finite: left out from then on.
  std::uint64_t quarantined = 0;
  DynamicModelFaults dynamic_models{};  ///< while answering this client's motions
};

/// One client's state of a scene.
///
/// A scene's tool touches objects with all of its points, and what they feel is a force at its tip and a torque about
/// that (ToolTouch); fields act at the tip. Of a handle that does not tell its orientation nobody knows where the
/// points are: it touches nothing.
///
/// An object, field or dynamic model whose force is not finite is left out from then on, for this client; the others
/// keep their states.
///
/// Real time: `answer` is noexcept, allocates nothing and is O(effects) plus the time of the dynamic models. Not
/// thread-safe, nor are states that share dynamic models.
class SceneState {
 public:
  /// With dynamic models of its own, which follow the device's clock. The scene must accept the degrees of freedom.
  SceneState(const std::shared_ptr<const Scene>& scene, std::uint32_t degrees_of_freedom);

  /// With the dynamic models of another client's state of this scene, or of new ones for several clients; these follow
  /// the server's clock. Asked for a local model, `answer` is about the device's path as it is played (DevicePath).
  SceneState(std::shared_ptr<const Scene> scene, std::uint32_t degrees_of_freedom, const DynamicModelsNow& shared);

  SceneState(SceneState&&) noexcept;
  SceneState& operator=(SceneState&&) noexcept;
  ~SceneState();

  /// One part of the scene alone: the object or field of a step of the plan, or, counted on from there, a dynamic
  /// model.
  static SceneState of_part(std::shared_ptr<const Scene> scene, std::uint32_t degrees_of_freedom, std::size_t part);

  /// The answer to a device that was at `position` (finite, one row per degree of freedom) at `device_time` on its own
  /// clock. It is finite; rotations are zero, and the torque of a tool is apart. The velocity is the mean since the
  /// previous call; it is zero where time has not advanced.
  /// @param server_time time of the answer; used only by shared dynamic models
  /// @param wants_model whether the answer has the local models of the dynamic models' part of `server_parts_N`
  /// @param handle of the device at `device_time`
  [[nodiscard]] Answer answer(const Vector& position, Nanoseconds device_time, Nanoseconds server_time = Nanoseconds{0},
                              bool wants_model = false, const Handle& handle = {}) noexcept;

  /// Points of the tool that the last answer found in contact, counted for each object; 1 or 0 of an ordinary point.
  [[nodiscard]] std::size_t contacts() const noexcept { return contacts_; }

  /// Where the tool was simulated for the last answer (ToolProxy); null: where the device has it.
  [[nodiscard]] const ToolPose* simulated_tool() const noexcept;

  /// Names of the parts that the last answer left out, as do those after it; of most none. Valid until the next one.
  [[nodiscard]] std::span<const std::string* const> quarantined() const noexcept { return quarantined_; }

  /// Forgets all that was: effects, contacts and velocity begin anew, contacts from a place that is known to be outside
  /// of everything solid [m], and the scene's time at a time of the device's clock. Real time.
  void begin_again(const Vector& outside_m, Nanoseconds first_time) noexcept;

  /// Remembers what another state did in a scene of the same objects, fields and effects, such as one of which fewer
  /// triangles were known. Each keeps its own, friction its anchor; but a shape of which there was no geometry before
  /// begins anew. Of neither are there dynamic models. False, with nothing done, if the plans differ. Real time.
  [[nodiscard]] bool go_on_from(const SceneState& other) noexcept;

  [[nodiscard]] DynamicModelsNow dynamic_models() const;

  /// Where the parts of a dynamic model are now: DynamicModelState::sample. Nothing of one that is not sound. Real
  /// time.
  [[nodiscard]] std::size_t sample(std::size_t dynamic_model, std::size_t first, std::span<float> to) const noexcept;

  [[nodiscard]] const Scene& scene() const noexcept { return *scene_; }
  [[nodiscard]] const SceneFaults& faults() const noexcept { return faults_; }

 private:
  SceneState(std::shared_ptr<const Scene> scene, std::uint32_t degrees_of_freedom,
             const DynamicModelsNow& dynamic_models, bool shares_dynamic_models);

  struct Totals {
    Point force_N = Point::Zero();
    Point torque_N_m = Point::Zero();
    Point server_parts_N = Point::Zero();
    Point fading_N = Point::Zero();
  };

  void feel_steps(Probe probe, Totals& totals, Answer& answer) noexcept;
  void feel_dynamic_models(const Probe& probe, const FeltAt& felt_at, Nanoseconds device_time, bool wants_model,
                           Totals& totals, Answer& answer) noexcept;
  [[nodiscard]] ToolFelt feel_step(std::uint32_t number, Probe& probe) noexcept;
  /// Adds one part's force to the answer; false if it is not finite.
  [[nodiscard]] bool add(const Reaction& reaction, const SurfacePoint& surface, Point& total_N,
                         Answer& answer) noexcept;
  void describe(DynamicModelCoupling& coupling, std::uint32_t number, local_model::LocalModel& model) noexcept;
  [[nodiscard]] Point place(const Vector& position) const noexcept;
  /// With the device's rows; rotations are zero.
  [[nodiscard]] Vector in_device_rows(const Point& point) const noexcept;
  void quarantine(const std::string& name) noexcept;
  void look_at_time(Probe& probe, Nanoseconds device_time) noexcept;

  std::shared_ptr<const Scene> scene_;
  Eigen::Index rows_;                            ///< of the device
  Eigen::Index translations_;                    ///< rows that are translations
  std::vector<std::byte> bytes_;                 ///< the states of all effects and shapes, of each point of the tool
  std::unique_ptr<ToolTouch> tool_;              ///< of the scene; null: none
  std::vector<std::uint32_t> steps_;             ///< of the plan, less those quarantined
  std::vector<DynamicModelCoupling> couplings_;  ///< in all dynamic models
  std::vector<std::uint32_t> dynamic_models_;    ///< of the couplings, less those quarantined
  std::vector<const std::string*> quarantined_;  ///< on this motion; room for all
  bool shares_dynamic_models_;
  std::size_t contacts_ = 0;
  Point last_position_m_ = Point::Zero();
  bool has_first_ = false;
  Nanoseconds first_time_{0};
  Nanoseconds last_time_{0};
  bool has_last_ = false;
  SceneFaults faults_;
};

}  // namespace forcebound::scene
