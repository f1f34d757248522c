#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "forcebound/scene/dynamic_model.hpp"
#include "forcebound/server/dynamics/bodies/coupling.hpp"
#include "forcebound/server/dynamics/bodies/description.hpp"
#include "forcebound/server/dynamics/bodies/dragged_body.hpp"
#include "forcebound/server/dynamics/bodies/mujoco.hpp"

namespace forcebound::server {

/// The state of the bodies.
///
/// When a device joins, the far end of its coupling begins at the probe and moves smoothly to the device, in half a
/// second if it is near, so that the force does not jump. A generated ball begins at the device, or where that is
/// inside a body, on its surface; a body of the scene's author stays where it is.
///
/// With a grasp (GraspDescription) a generated ball is welded to the body that it holds, where the two are then.
class BodyWorld final : public scene::DynamicModelState {
 public:
  /// The body that a device drags.
  struct Probe {
    int body = -1;
    int slides = -1;  ///< generated ball: the first of its three coordinates; -1: a body of the scene's author
    int weld = -1;    ///< to what it holds, of the model's equalities; -1: it cannot hold
  };

  /// @throws BodiesError
  BodyWorld(ModelPointer model, const Coupling& coupling, const std::vector<Probe>& probes,
            const std::optional<GraspDescription>& grasp = std::nullopt);

  int join() override;
  void leave(int seat) override;
  void press(int seat, std::uint32_t buttons) noexcept override;
  void move(int seat, const scene::Point& position_m, const scene::Point& velocity_m_per_s) noexcept override;
  void advance(double elapsed_s) noexcept override;
  scene::ModelTouch touch(int seat) noexcept override;

  /// The dragged body with what is near it, once the coupling's far end has reached the device.
  [[nodiscard]] bool describe(int seat, local_model::LocalModel& model) noexcept override;

  /// The geometries of all bodies but the devices' balls; of MuJoCo's kinds not its height fields and ellipsoids.
  [[nodiscard]] std::vector<scene::VisiblePart> visible() const override;
  [[nodiscard]] std::size_t sample(std::size_t first, std::span<float> to) const noexcept override;

  /// The body that the probe holds; -1: none.
  [[nodiscard]] int held_by(int seat) const noexcept { return seats_[static_cast<std::size_t>(seat)].held; }

  [[nodiscard]] bool sound() const noexcept override { return sound_; }
  [[nodiscard]] scene::DynamicModelFaults faults() const noexcept override { return faults_; }

  /// Between worlds with equal numbers of bodies and probes on the same joints; masses, shapes, solver and time step
  /// may differ.
  [[nodiscard]] bool copy_from(const scene::DynamicModelState& other) noexcept override;

  [[nodiscard]] const mjModel_& model() const noexcept { return *model_; }
  [[nodiscard]] const mjData_& data() const noexcept { return *data_; }
  [[nodiscard]] mjData_& data() noexcept { return *data_; }

 private:
  struct Seat : Probe {
    bool taken = false;
    bool placed = false;  ///< has a position since it was taken
    scene::Point device_m = scene::Point::Zero();
    scene::Point device_m_per_s = scene::Point::Zero();
    bool heard = false;                                  ///< a new position came since the last advance
    double unmoved_s = 0;                                ///< simulated since the last new position
    scene::Point begins_aside_m = scene::Point::Zero();  ///< how far from the device the coupling's far end began
    double placed_s = 0;                                 ///< simulated since the seat was placed
    double arrival_s = 0;                                ///< time at which the coupling's far end reaches the device
    scene::Point force_N = scene::Point::Zero();         ///< on the device, in the last step
    scene::Point pushed_m = scene::Point::Zero();        ///< from the coupling's far end to the probe, in the last step
    bool pressed = false;                                ///< the button that grasps
    int held = -1;                                       ///< body that it holds; -1: none
    bool slipped = false;                                ///< out of this hold: the button must be let go first
    double overload_s = 0;                               ///< simulated since the hold last carried no more than it can
  };

  [[nodiscard]] bool has_shape_of(const BodyWorld& other) const noexcept;
  [[nodiscard]] std::vector<int> balls() const;
  void park(int seat) noexcept;
  void appear(Seat& seat) noexcept;
  void place(const Probe& ball, const scene::Point& position_m) noexcept;
  void place_outside(const Probe& ball, scene::Point position_m) noexcept;
  void step_once(double before_end_s) noexcept;
  void pull(Seat& seat, double before_end_s) noexcept;
  void hold(Seat& seat) noexcept;
  void grasp(Seat& seat) noexcept;
  void let_go(Seat& seat) noexcept;
  [[nodiscard]] double carried_N(const Seat& seat) const noexcept;
  [[nodiscard]] scene::Point bearing_N(const Probe& probe) const noexcept;

  ModelPointer model_;
  DataPointer data_;
  Coupling coupling_;
  std::optional<GraspDescription> grasp_;
  DraggedBodies describer_;
  std::vector<int> visible_;  // geometries that are seen, less planes
  std::vector<Seat> seats_;
  double left_s_ = 0;
  bool sound_ = true;
  scene::DynamicModelFaults faults_;
};

}  // namespace forcebound::server
