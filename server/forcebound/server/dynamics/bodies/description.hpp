#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/scene/geometry/point.hpp"
#include "forcebound/server/dynamics/bodies/coupling.hpp"

namespace forcebound::server {

/// One rigid body of a scene, a solid of one density.
struct BodyDescription {
  enum class Shape { box, sphere, capsule, cylinder };

  std::string name;
  Shape shape = Shape::box;
  scene::Point size_m = scene::Point::Zero();       ///< box: its edges; else: its diameter thrice
  scene::Point half_axis_m = scene::Point::Zero();  ///< capsule, cylinder: from the middle to an end
  double mass_kg = 0;                               ///< > 0; 0: fixed
  scene::Point position_m = scene::Point::Zero();   ///< of its middle
  double friction = 0.5;                            ///< coefficient
};

/// How the device's point takes part: as a small ball of its own mass, coupled to it.
struct ProbeDescription {
  double radius_m = 0.004;
  double mass_kg = 0.03;
};

/// Of MuJoCo's: shorter ones would be more than a motion has time for, a longer one is no haptics.
inline constexpr double kTimestepLeast_s = 1e-4;
inline constexpr double kTimestepMost_s = 0.01;

/// How MuJoCo finds the forces of contacts and joints in each step. What is not said stays as the model has it.
///
/// An iteration of `pgs` goes through all contacts once (projected Gauss-Seidel), one of `cg` and `newton` through all
/// of them at once (conjugate gradients, Newton's method); `newton`'s is the dearest and needs the fewest.
struct SolverOptions {
  enum class Kind : std::uint8_t { newton, cg, pgs };

  std::optional<Kind> kind{};
  std::optional<int> iterations{};    ///< at most, from 1 to kIterationsMost
  std::optional<double> tolerance{};  ///< it ends with the first iteration that improves less; 0: never before the last
};

/// A step must end.
inline constexpr int kIterationsMost = 1000;
inline constexpr double kToleranceMost = 1;

/// As scenes write them.
std::string_view name_of(SolverOptions::Kind kind) noexcept;

struct BodiesDescription {
  std::vector<BodyDescription> bodies{};
  scene::Point gravity_m_per_s2 = scene::Point(0, 0, -9.80665);
  double timestep_s = 1e-3;
  SolverOptions solver{};
  /// In which a contact pushes apart what has sunk in. The less the harder: a fifth of this still carries a stack of
  /// twenty boxes, but a body a thousand times as heavy as what bears it would press through.
  double contact_time_s = 0.02;
  ProbeDescription probe{};
  Coupling coupling{};
};

/// "probe 0", "probe 1", ...
std::string name_of_probe(int number);

/// As MJCF, with the bodies in their order and then `probes` probes: each a ball that is moved along three slides and
/// meets bodies, but no other probe. A body keeps its name but for those that are taken there, 'world' and those that
/// begin with "probe ": it is put after "body ", and so is one that begins with this. The integrator is implicit in
/// velocity, which keeps a body that tumbles from gaining.
std::string to_mjcf(const BodiesDescription& description, int probes);

/// Where a probe without a client waits, where nothing else is.
scene::Point parking_m(int probe) noexcept;

}  // namespace forcebound::server
