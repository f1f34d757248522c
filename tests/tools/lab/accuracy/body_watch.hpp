#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "forcebound/scene/scene_state.hpp"
#include "forcebound/server/dynamics/bodies/mujoco.hpp"

namespace forcebound::server {
class BodyWorld;
}

namespace forcebound::lab {

/// Final position and orientation of a body.
struct BodyPlace {
  std::string name;
  scene::Point center_m = scene::Point::Zero();
  scene::Point up = scene::Point::UnitZ();  ///< the body's direction that pointed upwards at first
  double radius_m = 0;                      ///< of the sphere around its largest part
  double thickness_m = 0;                   ///< half of the smallest size of its thinnest part
  bool is_round = false;                    ///< it may roll
};

/// Record of rigid bodies along a path.
struct BodyRecord {
  double gained_J = 0;                    ///< largest energy above the initial energy and the work put in
  double drift_J = 0;                     ///< the same at the end: negative by what friction and contacts dissipated
  double turned_over_J = 0;               ///< exchanged with the device, both ways
  double weight_J = 0;                    ///< to lift each body by its own radius
  bool is_driven = false;                 ///< by actuators, which add energy
  double deepest_m = 0;                   ///< of any body in another
  double deepest_of_thickness = 0;        ///< the most of that as a share of half the thinner one's thickness
  int ticks = 0;                          ///< on which the bodies made a step
  int exhausted = 0;                      ///< of them: on which the solver used all its iterations
  std::map<std::string, int> warnings{};  ///< of MuJoCo
  std::vector<BodyPlace> places{};        ///< at the end
};

/// Observes the bodies of a scene, if any, without changing them.
///
/// Their energy is kinetic and potential. External work comes from the forces at their centres of mass: of couplings
/// and of the support of a probe's weight:
///
///     W += f . (v + v') / 2 dt,     f of the last step, or the mean of two ticks where there were several
///
/// which is exact for a step that changes velocities by f dt / m, as MuJoCo's do.
class BodyWatch {
 public:
  /// @param state must outlive this
  explicit BodyWatch(const scene::SceneState& state);
  ~BodyWatch();
  BodyWatch(const BodyWatch&) = delete;
  BodyWatch& operator=(const BodyWatch&) = delete;

  /// To be called after each tick. @return whether any of the dynamic models made a step, or there are no bodies.
  bool observe();

  [[nodiscard]] bool any() const noexcept { return !worlds_.empty(); }
  [[nodiscard]] BodyRecord record() const;

 private:
  struct Watched;
  static void look(Watched& watched);
  static void account(Watched& watched, double elapsed_s);

  std::vector<std::unique_ptr<Watched>> worlds_;
};

/// The world of a dynamic model's state; null: not of rigid bodies.
const server::BodyWorld* body_world(const scene::DynamicModelsNow& dynamic_models, std::size_t dynamic_model);

/// Why a run of rigid bodies is unreliable: energy from nowhere, bodies inside each other, displaced or fallen over
/// compared with the reference, or warnings of MuJoCo. Empty: no fault.
///
/// Energy may grow by 5 % of the energy exchanged with the device and 1 % of that to lift all bodies by their radius,
/// since contacts are springs. A body may lie three times as deep in another as in the reference, and half a
/// millimetre; it may end a quarter of its thickness lower or higher than there, twice its radius away, and lean
/// otherwise by 30 degrees. Half through the thinner body is too deep for a reference as well.
///
/// @param places whether the reference knows where bodies come to rest
std::string body_trouble(const BodyRecord& run, const BodyRecord& reference, bool places = true);

/// The part of it about the bodies' positions.
std::string place_trouble(const BodyRecord& run, const BodyRecord& reference);

}  // namespace forcebound::lab
