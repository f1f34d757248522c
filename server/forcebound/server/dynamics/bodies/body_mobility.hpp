#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "forcebound/local_model/local_model.hpp"
#include "forcebound/scene/geometry/point.hpp"
#include "forcebound/server/dynamics/bodies/mujoco.hpp"

namespace forcebound::server {

/// How bodies answer forces near their state in the last step, as local_model::Body says it: a point of one moves by
///
///     W = J (M + c J_a' D J_a)^-1 J'        [1/kg]
///
/// with the Jacobian J of the point, the mass matrix M, the Jacobian J_a of the constraints that acted and count, and
/// their weights D in MuJoCo's convex problem of the accelerations. c is 1 for MuJoCo's own answer in one step, in
/// which a contact gives way first and is pushed back later, and large here: over the time of an answer a contact
/// holds, two bodies that move stick to each other where friction bears it, and what stands still slows them.
/// Velocities are M (M + c J_a' D J_a)^-1 of those that the joints have: without what goes into a contact.
///
/// Not as constraints, which act both ways, count limits of joints and dry friction on what stands still: the former
/// are `room_of_joints_m`, the latter is a force of its own.
///
/// Memory for a model's size is taken at the start. Real time: noexcept, no allocation, O(nv^3).
class BodyMobility {
 public:
  /// Models with more degrees of freedom would take too long for each answer.
  static constexpr int kDegreesMost = 60;
  /// Those beyond do not count.
  static constexpr std::size_t kContactsMost = 256;

  explicit BodyMobility(const mjModel_& model);

  [[nodiscard]] static bool can_do(const mjModel_& model) noexcept;

  /// Estimate for one `consider` with as many constraints as degrees of freedom, and for one `answer` [ns].
  [[nodiscard]] static double predicted_cost_ns(const mjModel_& model) noexcept;

  /// Those that count, but for those of some bodies.
  struct Contacts {
    std::span<const mjContact_> contacts{};
    std::array<int, 2> but_of{-1, -1};
  };

  /// What `answer` is to count from now on. False if it cannot be solved. @param contacts must outlive all answers
  [[nodiscard]] bool consider(const mjModel_& model, const mjData_& data, const Contacts& contacts) noexcept;

  /// A body at a point, with the springs and dampers of joints along a direction, and its dry friction. Nothing if
  /// numbers are not finite. @param direction unit; zero: along which it moves most easily
  [[nodiscard]] std::optional<local_model::Body> answer(const mjModel_& model, const mjData_& data, int body,
                                                        const scene::Point& at_m, const scene::Point& direction,
                                                        const scene::Point& pushed_N) noexcept;

  /// How far the point of the last `answer` can go along its direction, and against it, by the limits of joints [m].
  struct Room {
    scene::Point way;  ///< that direction, unit; zero: nothing moves it along that
    double along_m;
    double against_m;
  };
  [[nodiscard]] Room room_of_joints_m(const mjModel_& model, const mjData_& data) const noexcept;

 private:
  void read_row(const mjModel_& model, const mjData_& data, int row) noexcept;
  [[nodiscard]] bool counts(const mjModel_& model, const mjContact_& contact) const noexcept;
  void hold(double weight_kg) noexcept;
  void hold(const mjModel_& model, const mjData_& data, const mjContact_& contact, bool slips) noexcept;
  [[nodiscard]] bool factor(const mjModel_& model, const mjData_& data) noexcept;
  void look_at(const mjModel_& model, const mjData_& data, const mjContact_& contact) noexcept;
  [[nodiscard]] scene::Point apart(const std::vector<double>& joints) const noexcept;
  [[nodiscard]] double bearing_N(const mjModel_& model, const mjContact_& contact) const noexcept;
  [[nodiscard]] bool find_slips(const mjModel_& model, const mjData_& data, double pushed_N) noexcept;
  [[nodiscard]] std::optional<local_model::Body> answer_once(const mjModel_& model, const mjData_& data, int body,
                                                             const scene::Point& at_m, const scene::Point& direction,
                                                             const scene::Point& pushed_N) noexcept;
  [[nodiscard]] double dry_friction_N(const mjModel_& model, const mjData_& data,
                                      const scene::Point& pushed_N) noexcept;

  Contacts contacts_{};
  std::array<bool, kContactsMost> slips_{};  // of those: its bodies slip on each other
  std::vector<double> inertia_;              // and constraints, row by row
  std::vector<double> jacobian_;             // of the point, 3 rows
  std::vector<double> row_;                  // of a constraint
  std::vector<double> pulled_;
  std::vector<double> going_;  // velocities of the joints, less what the constraints do not let go on
  std::vector<double> moved_;  // what forces at the point along each axis add to accelerations, 3 rows
  scene::Point way_ = scene::Point::Zero();
  std::vector<double> borne_;     // accelerations under what pulls and pushes, as far as contacts give way
  std::vector<double> loaded_;    // accelerations while the point is pushed as hard as friction bears
  std::vector<double> apart_;     // Jacobian of a contact: of its second body less of its first, 3 rows
  std::vector<double> of_first_;  // 3 rows
  std::vector<double> along_;     // how joints move while the point moves by 1 along the direction
};

/// How far a body can go along a direction before it meets something that cannot move [m]; infinite if nothing is in
/// its way. Looks along the line through its centre of mass. Real time.
/// @param direction unit
[[nodiscard]] double travel_m(const mjModel_& model, const mjData_& data, int body,
                              const scene::Point& direction) noexcept;

/// Estimate for one `travel_m` [ns]: a ray there and one back, past every geom and through every triangle of a mesh.
[[nodiscard]] double predicted_travel_cost_ns(const mjModel_& model) noexcept;

}  // namespace forcebound::server
