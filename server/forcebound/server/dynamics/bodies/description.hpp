#pragma once

#include <array>
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
  std::string name;
  std::string shape = "box";                        ///< in scene files and in MJCF alike; or sphere, capsule, cylinder
  scene::Point size_m = scene::Point::Zero();       ///< box: its edges; else: three times its diameter
  scene::Point half_axis_m = scene::Point::Zero();  ///< capsule, cylinder: from the middle to an end
  double mass_kg = 0;                               ///< > 0; 0: fixed
  scene::Point position_m = scene::Point::Zero();   ///< of its middle
  double friction = 0.5;                            ///< coefficient
};

/// The probe: a small ball with a mass of its own, coupled to the device.
struct ProbeDescription {
  double radius_m = 0.004;
  double mass_kg = 0.03;
};

/// How a probe takes hold of a body: while the button of its device is pressed, of the first body that moves which it
/// touches. It holds that as it is, without a turn, and the body slips out of a hold that carries more than
/// `force_N_max` for longer than a blow; then not before the button was let go.
struct GraspDescription {
  int button = 0;
  double force_N_max = 10;
};

/// Bounds of MuJoCo's time step: shorter ones would need more steps than a motion has time for, longer ones are too
/// slow for haptics.
inline constexpr double kTimestepLeast_s = 1e-4;
inline constexpr double kTimestepMost_s = 0.01;

/// How MuJoCo finds the forces of contacts and joints in each step. Values not given stay as in the model.
///
/// An iteration of `pgs` goes through all contacts once (projected Gauss-Seidel), one of `cg` and `newton` through all
/// of them at once (conjugate gradients, Newton's method); `newton`'s costs most and needs the fewest.
struct SolverOptions {
  enum class Kind : std::uint8_t { newton, cg, pgs };

  std::optional<Kind> kind{};
  std::optional<int> iterations{};    ///< at most, from 1 to kIterationsMost
  std::optional<double> tolerance{};  ///< stops at the first iteration that improves less; 0: always runs `iterations`
};

/// Bounds the time of a step.
inline constexpr int kIterationsMost = 1000;
inline constexpr double kToleranceMost = 1;

/// The names in scene files, in the order of SolverOptions::Kind.
inline constexpr std::array<std::string_view, 3> kSolverNames{"newton", "cg", "pgs"};

constexpr std::string_view name_of(SolverOptions::Kind kind) noexcept {
  return kSolverNames[static_cast<std::size_t>(kind)];
}

/// All rigid bodies of a scene, how they are simulated, and the probe that touches them.
struct BodiesDescription {
  std::vector<BodyDescription> bodies{};
  scene::Point gravity_m_per_s2 = scene::Point(0, 0, -9.80665);
  double timestep_s = 1e-3;
  SolverOptions solver{};
  /// Time in which a contact pushes overlapping bodies apart; shorter is harder. A fifth of this still carries a stack
  /// of twenty boxes, but a body a thousand times as heavy as its support would press through.
  double contact_time_s = 0.02;
  ProbeDescription probe{};
  Coupling coupling{};
  std::optional<GraspDescription> grasp{};  ///< none: the probe only pushes
};

/// "probe 0", "probe 1", ...
std::string name_of_probe(int number);

/// "grasp 0", ...: what couples the probe to the body that it holds, at first to none.
std::string name_of_grasp(int number);

/// As MJCF, with the bodies in their order and then `probes` probes: each a ball that moves along three slides and
/// touches bodies, but no other probe; with a grasp, each can be welded to a body. A body keeps its name, except for
/// reserved names: 'world', names that begin with "probe ", and names that begin with "body " get the prefix "body ".
/// The integrator is implicit in velocity, which keeps a tumbling body from gaining energy.
std::string to_mjcf(const BodiesDescription& description, int probes);

/// The position of a probe without a client, away from all bodies.
scene::Point parking_m(int probe) noexcept;

}  // namespace forcebound::server
