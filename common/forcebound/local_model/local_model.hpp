#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <limits>

/// What a server says of its environment near a device, so that a client can render it at its own rate until the next
/// answer comes. Lengths in metres, in the scene's frame; forces on the device. Plain values, of bounded size.
namespace forcebound::local_model {

using Point = Eigen::Vector3d;

/// A surface that moves by itself and is touched from one side. A device at x, so long after the state told of,
///
///     p(t) = p + v t + a t^2 / 2,    r = x - p(t),    d = -n . r
///     f = -K r - B (n . (x' - p')) n + g n    while d > 0 and f . n > 0,    else zero
///     g' = K_1 d' - g / T                     a spring K_1 in series with a damper K_1 T, along the normal
///     |f_t| <= mu (f . n)                     along the surface, besides f: dry friction, sticking by a spring n.Kn
///
/// with p where a device at rest would begin to feel it. A contact of tissue without friction has K = k n n'. The
/// tissue of scenes is quasi-static, and tells of no damping, motion or relaxation; an environment of one's own may.
/// The friction is the elastoplastic bristle of scene/effects/bristle.hpp (Kikuuwe and others 2005).
struct Surface {
  std::uint32_t id = 0;  ///< the same in answers about the same contact: the client keeps its g, and where it sticks
  Point force_N = Point::Zero();                                ///< of it in the answer, at the answer's position
  Point place_m = Point::Zero();                                ///< p
  Point normal = Point::UnitX();                                ///< n, unit, out of it
  Eigen::Matrix3d stiffness_N_per_m = Eigen::Matrix3d::Zero();  ///< K, symmetric, no eigenvalue below zero
  double damping_N_s_per_m = 0;                                 ///< B
  Point velocity_m_per_s = Point::Zero();                       ///< v
  Point acceleration_m_per_s2 = Point::Zero();                  ///< a
  double relaxing_N_per_m = 0;                                  ///< K_1; 0, as g is then: it does not relax
  double relaxation_s = 0;                                      ///< T
  double relaxed_N = 0;                                         ///< g when it was told
  double friction = 0;  ///< mu; where the contact sticks is the client's, as g is, and no part of `force_N`
  double radius_m = 0;  ///< it holds this far from p, with no claim beyond
  /// Someone else may move or press it as well: at rest now, it may be elsewhere when the server is silent.
  bool others_move_it = false;
};

/// How a body moves under a force f at one point of it, near the state told of: the point goes by z from there,
///
///     z'' = b + W (f - k z - c z' + d),    |d| <= F, against z'
///
/// with the springs and dampers of its joints along the way that it is pushed, and dry friction on what stands still.
struct Body {
  Point velocity_m_per_s = Point::Zero();                     ///< z' when it was told
  Point bias_m_per_s2 = Point::Zero();                        ///< b: by gravity, and by its springs where it was
  Eigen::Matrix3d mobility_per_kg = Eigen::Matrix3d::Zero();  ///< W, with all that it carries along; symmetric, >= 0
  double spring_N_per_m = 0;                                  ///< k
  double damper_N_s_per_m = 0;                                ///< c
  double dry_friction_N = 0;                                  ///< F
};

/// What a mass touches or may soon meet. With r the gap, r' = n . (y' - z'), the force on the mass is n l + t,
///
///     l (n . (W_y + W_z) n + R) = -d r' - s r - a,  l >= 0    while r < 0
///     t (... + R) = -d v_t - a_t,  |t| <= mu l                along the surface
///
/// where a is the acceleration of r without l, and v_t the speed along the surface: MuJoCo's contact, which has the
/// reference acceleration -d r' - s r.
struct Contact {
  Point normal = Point::UnitX();                              ///< n, unit, out of what is met
  double gap_m = 0;                                           ///< r; below zero: in it
  double compliance_per_kg = 0;                               ///< R
  double stiffness_per_s2 = 0;                                ///< s
  double damping_per_s = 0;                                   ///< d
  double friction = 0;                                        ///< mu
  double radius_m = std::numeric_limits<double>::infinity();  ///< it is there so far along the surface, no farther
  double travel_m = std::numeric_limits<double>::infinity();  ///< so far along -n what is met goes: there it is stopped
  double return_m = std::numeric_limits<double>::infinity();  ///< and so far along n
  Body met{};                                                 ///< there

  [[nodiscard]] bool moves() const noexcept { return !met.mobility_per_kg.isZero(0); }
};

/// A mass that the device drags through a virtual coupling, and what it touches. Its place is y, moved as a Body by
///
///     f_c = K (x - y) + B (x' - y')    of the coupling, -f_c on the device
///
/// and by its contacts. In the coupling x - y counts up to kReachMost_m, x' and y' up to kSpeedMost_m_per_s: more than
/// any hand, and less than what makes bodies fly apart.
struct Mass {
  static constexpr double kReachMost_m = 0.2;
  static constexpr double kSpeedMost_m_per_s = 5;
  static constexpr std::uint32_t kContactsMax = 3;

  std::uint32_t id = 0;
  Point force_N = Point::Zero();  ///< of it in the answer
  Point place_m = Point::Zero();  ///< y when it was told
  double stiffness_N_per_m = 0;   ///< K of the coupling
  double damping_N_s_per_m = 0;   ///< B of the coupling
  Body body{};
  std::array<Contact, kContactsMax> contacts{};
  std::uint32_t contact_count = 0;
  double radius_m = 0;          ///< it holds for devices this far from `place_m`
  bool others_move_it = false;  ///< as of a surface
};

/// A force with its first derivative:    f = f_0 + J (x - x_0).
struct Field {
  Point force_N = Point::Zero();  ///< f_0, of it in the answer
  Point place_m = Point::Zero();  ///< x_0
  Eigen::Matrix3d jacobian_N_per_m = Eigen::Matrix3d::Zero();
  double radius_m = 0;  ///< it holds this far from x_0
};

/// The models of one answer. The forces in it are parts of the answer's force, which is held where there is no model
/// of it.
struct LocalModel {
  static constexpr std::uint32_t kSurfacesMax = 3;

  static constexpr std::chrono::nanoseconds kBeforeReadingMost = std::chrono::seconds{1};

  /// The state told of is that at the reading of the motion that is answered, or so long before it (below zero: after
  /// it), where the server plays the device's path later than it comes; else that at the motion's arrival.
  bool by_device_clock = false;
  std::chrono::nanoseconds before_reading{0};
  std::array<Surface, kSurfacesMax> surfaces{};
  std::uint32_t surface_count = 0;
  bool has_mass = false;
  Mass mass{};
  bool has_field = false;
  Field field{};

  /// When the state told of was, by the device's clock, if the models go by that. @param read of the motion answered
  [[nodiscard]] std::chrono::nanoseconds state_time(std::chrono::nanoseconds read) const noexcept {
    return read - std::clamp<std::chrono::nanoseconds>(before_reading, -kBeforeReadingMost, kBeforeReadingMost);
  }

  [[nodiscard]] bool empty() const noexcept { return surface_count == 0 && !has_mass && !has_field; }

  /// What of the answer's force the models tell of. Of a sound model.
  [[nodiscard]] Point force_N() const noexcept;
};

/// Whether it is what the definitions above ask for: finite, within bounds far beyond what is real, with unit normals
/// and with stiffness whose least eigenvalue is above -1e-4 of the largest, and mobility whose is above -1e-6: the
/// numbers travel with 24 bits. Real time: noexcept, no allocation.
[[nodiscard]] bool is_sound(const LocalModel& model) noexcept;

/// Adds the models of another part of the environment. False, with nothing done, if there is no room for all of them:
/// their forces are then held. Real time.
[[nodiscard]] bool add(const LocalModel& part, LocalModel& to) noexcept;

}  // namespace forcebound::local_model
