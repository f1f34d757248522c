#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <string_view>
#include <type_traits>
#include <vector>

#include "forcebound/config/parameter.hpp"
#include "forcebound/control/handle.hpp"
#include "forcebound/scene/geometry/point.hpp"

namespace forcebound::scene {

using config::ChoiceParameter;
using config::FlagParameter;
using config::NumberParameter;
using config::Parameter;
using config::PointParameter;
using config::positive_number;
using config::Values;
using control::Handle;

/// Inputs of an effect beside position, contact and handle. The plan computes an input only if an effect of the scene
/// uses it.
struct Inputs {
  bool velocity = false;
  bool time = false;      ///< since the session's first motion, and since the previous one
  bool pressure = false;  ///< normal force of the object's other effects; such an effect runs after them

  [[nodiscard]] Inputs with(const Inputs& other) const noexcept {
    return {velocity || other.velocity, time || other.time, pressure || other.pressure};
  }
};

/// Input of an effect: the device's point and handle. All numbers are finite.
struct Probe {
  Point position_m = Point::Zero();
  Point velocity_m_per_s = Point::Zero();  ///< Inputs::velocity: mean since the previous motion; zero on the first
  double time_s = 0;                       ///< Inputs::time: by the device's clock
  double interval_s = 0;                   ///< Inputs::time: since the previous motion, >= 0; zero on the first
  Point normal = Point::UnitX();           ///< of an object: unit, out of its surface where it is nearest
  double penetration_m = 0;                ///< of an object: depth below that surface, < 0 the distance above it
  double pressure_N = 0;                   ///< Inputs::pressure: along the normal, >= 0
  Handle handle{};                         ///< what the device has of it: buttons, gripper, orientation
};

/// Ripples that the client renders at the device, because a force from the server would be too late and too slow:
///
///     f = n A mean_i sin(k_i . x),    x the device's own position at its own rate
struct Texture {
  double amplitude_N = 0;  ///< A >= 0; zero: no texture
  int waves = 0;
  std::array<Point, 2> waves_rad_per_m{};  ///< k_i, in the tangent plane; 2 pi over the wavelength
};

/// The force and texture of an object or field on the device.
struct Reaction {
  Point force_N = Point::Zero();  ///< on the device, scene frame
  Texture texture{};
  Point fading_N = Point::Zero();  ///< of it, that of effects that fade without a server; not for effects to set
};

/// Facts of an effect with the scene's parameters, for the plan and for `--explain`.
struct EffectFacts {
  Inputs inputs{};
  std::size_t state_bytes = 0;     ///< per session; zeroed at the start and after contact is lost
  double reach_m = 0;              ///< > 0: acts up to this far above the surface; else only within
  double stiffness_N_per_m = 0;    ///< K, largest slope of the force over depth
  double stiffening_N_per_m2 = 0;  ///< increase of K per metre of depth
  double damping_N_s_per_m = 0;    ///< B, largest slope of the force over velocity
  bool drives = false;             ///< an energy source: no damping makes it passive
  bool solid = false;              ///< pushes out of the object: no body goes in

  /// Whether its force fades while the server is silent, where a client renders it: so should what moves the device on
  /// and on. What is felt as a thing that is there stays: a surface with its ripples, a spring, a weight.
  bool fades_without_server = false;

  double cost_ns = 5;  ///< estimate for one motion
};

/// The law of one effect of an object or field: motion in, force out. One file per effect.
///
/// Real time: `act` is noexcept, allocates nothing and takes bounded time. Immutable, so that every client's scene
/// state shares it; its memory of a client lies in `state`, EffectFacts::state_bytes long, aligned for a double.
class Effect {
 public:
  virtual ~Effect() = default;

  /// Adds to `reaction`.
  virtual void act(const Probe& probe, std::byte* state, Reaction& reaction) const noexcept = 0;

  [[nodiscard]] virtual EffectFacts facts() const { return {}; }
};

/// The state of an effect or shape, in the bytes kept for it. All bytes zero must be its initial state.
template <class State>
State& state_as(std::byte* bytes) noexcept {
  static_assert(std::is_trivially_copyable_v<State> && alignof(State) <= alignof(double));
  return *std::launder(reinterpret_cast<State*>(bytes));
}

/// Where an effect may be used: on the surface of an [[object]]; or in space, that is in a [[field]] everywhere and in
/// an object within it.
enum class EffectPlace : std::uint8_t { surface, space };

/// Registration of an effect for scene files.
struct EffectKind {
  std::string_view name;     ///< in `effects = [...]`, and of its own table
  std::string_view purpose;  ///< what a hand feels, in one line
  std::string_view law;      ///< its equation in one line
  EffectPlace place = EffectPlace::surface;
  std::vector<Parameter> parameters{};  ///< every key its table may have
  /// @throws std::invalid_argument where values, each in range, contradict each other
  std::function<std::unique_ptr<Effect>(const Values& values)> make;
};

}  // namespace forcebound::scene
