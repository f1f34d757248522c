#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "forcebound/scene/geometry/point.hpp"
#include "forcebound/server/dynamics/bodies/mujoco.hpp"

namespace forcebound::server {

/// How a body answers a force at its centre of mass, as of the last step: the change of its acceleration,
///
///     W = J (M + c J_a' D J_a)^-1 J'        [1/kg]
///
/// with the Jacobian J of its centre of mass, the mass matrix M, the Jacobian J_a of the constraints that acted, and
/// their weights D in MuJoCo's convex problem of the accelerations. c is 1 for MuJoCo's own answer in one step, in
/// which a contact gives way first and is pushed back later, and large here: over the time of an answer a contact
/// holds.
///
/// Memory for a model's size is taken at the start. Real time: noexcept, no allocation, O(nv^3).
class BodyMobility {
 public:
  /// Models with more degrees of freedom would take too long for each answer.
  static constexpr int kDegreesMost = 60;

  explicit BodyMobility(const mjModel_& model);

  [[nodiscard]] static bool can_do(const mjModel_& model) noexcept;

  /// Estimate for one `per_kg` with as many constraints as degrees of freedom [ns].
  [[nodiscard]] static double predicted_cost_ns(const mjModel_& model) noexcept;

  /// Whether a constraint acted in the last step: without, `per_kg` with constraints is that without.
  [[nodiscard]] static bool is_constrained(const mjData_& data) noexcept;

  /// Constraints that count: none leaves what joints alone leave free; equalities are what MuJoCo calls so, as the
  /// welds of probes to what they hold.
  enum class With : std::uint8_t { none, equalities, all };

  /// Nothing if it cannot be solved.
  [[nodiscard]] std::optional<Eigen::Matrix3d> per_kg(const mjModel_& model, const mjData_& data, int body,
                                                      With constraints) noexcept;

  /// Of its centre of mass in the last step, or what it would have been without the other constraints.
  [[nodiscard]] scene::Point acceleration_m_per_s2(const mjModel_& model, const mjData_& data, int body,
                                                   With constraints) noexcept;

 private:
  void read_row(const mjModel_& model, const mjData_& data, int row) noexcept;
  [[nodiscard]] bool factor(const mjModel_& model, const mjData_& data, With constraints) noexcept;

  std::vector<double> inertia_;   // and constraints, row by row
  std::vector<double> jacobian_;  // of the centre of mass, 3 rows
  std::vector<double> row_;       // of a constraint
  std::vector<double> pulled_;    // by forces without constraints, and by those that were factored
  std::vector<double> moved_;
};

/// How far a body can go along a direction before it meets something that cannot move [m]; infinite if nothing is in
/// its way. Looks along the line through its centre of mass. Real time.
/// @param direction unit
[[nodiscard]] double travel_m(const mjModel_& model, const mjData_& data, int body,
                              const scene::Point& direction) noexcept;

/// Estimate for one `travel_m` [ns]: a ray there and one back, past every geom and through every triangle of a mesh.
[[nodiscard]] double predicted_travel_cost_ns(const mjModel_& model) noexcept;

}  // namespace forcebound::server
