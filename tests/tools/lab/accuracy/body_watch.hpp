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

/// Where a body came to rest.
struct BodyPlace {
  std::string name;
  scene::Point center_m = scene::Point::Zero();
  scene::Point up = scene::Point::UnitZ();  ///< what pointed upwards of it in the beginning
  double radius_m = 0;                      ///< of the sphere around its largest part
  double thickness_m = 0;                   ///< half of the least that its thinnest part measures
  bool is_round = false;                    ///< it may roll
};

/// What rigid bodies did along a way.
struct BodyRecord {
  double gained_J = 0;       ///< the most that they held above what they had in the beginning and what was put in
  double drift_J = 0;        ///< the same in the end: below zero by what friction and contacts took
  double turned_over_J = 0;  ///< that the device put in and took out
  double weight_J = 0;       ///< to lift each body by its own radius
  bool is_driven = false;    ///< by actuators, which put in energy of their own
  double deepest_m = 0;      ///< of any body in another
  double deepest_of_thickness = 0;        ///< the most of that as a share of half the thinner one's thickness
  int ticks = 0;                          ///< on which the bodies made a step
  int exhausted = 0;                      ///< of them: on which the solver took all iterations it had
  std::map<std::string, int> warnings{};  ///< of MuJoCo
  std::vector<BodyPlace> places{};        ///< in the end
};

/// Looks at the bodies of a scene, if it has some, without touching them.
///
/// They hold kinetic and potential energy. What comes from outside are the forces at their centres of mass, of
/// couplings and of what bears a probe's weight:
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

/// The world of a dynamic model's state; null: it is no rigid bodies.
const server::BodyWorld* body_world(const scene::DynamicModelsNow& dynamic_models, std::size_t dynamic_model);

/// Why a run of rigid bodies is unreliable: energy that nothing put in, bodies in each other, out of place or fallen
/// over against the reference, or what MuJoCo warned of. Empty: nothing is wrong.
///
/// Energy may grow by 5 % of what the device turned over and 1 % of what lifts all bodies by their radius, since
/// contacts are springs. A body may lie three times as deep in another as in the reference, and half a millimetre; it
/// may end a quarter of its thickness lower or higher than there, twice its radius away, and lean otherwise by 30
/// degrees. Half through the thinner body is too deep for a reference as well.
///
/// @param places whether the reference knows where bodies come to rest
std::string body_trouble(const BodyRecord& run, const BodyRecord& reference, bool places = true);

/// The part of it that is about where bodies are.
std::string place_trouble(const BodyRecord& run, const BodyRecord& reference);

}  // namespace forcebound::lab
