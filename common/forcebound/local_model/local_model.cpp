#include "forcebound/local_model/local_model.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "forcebound/local_model/eigenvalues.hpp"

namespace forcebound::local_model {
namespace {

// Bounds, so that sums and products of what is told stay finite.
constexpr double kFar_m = 1e3;
constexpr double kFast_m_per_s = 1e2;
constexpr double kHard_m_per_s2 = 1e4;
constexpr double kStrong_N = 1e6;
constexpr double kStiff_N_per_m = 1e7;
constexpr double kDamped_N_s_per_m = 1e5;
constexpr double kLightest_kg = 1e-4;
constexpr double kShortest_s = 1e-4;
constexpr double kLongest_s = 1e4;
constexpr double kStep_s = 1e-3;
constexpr double kRough = 100;

// Numbers travel with 24 bits, and a normal may have been rounded before.
constexpr double kRounding = 1e-4;

bool is_within(const Point& point, double most) noexcept { return point.allFinite() && point.norm() <= most; }

bool is_from_zero_to(double value, double most) noexcept { return value >= 0 && value <= most; }

bool is_unit(const Point& direction) noexcept {
  return direction.allFinite() && std::abs(direction.norm() - 1) <= kRounding;
}

/// Symmetric, and no eigenvalue below zero or above the most.
bool is_between_zero_and(const Eigen::Matrix3d& matrix, double most) noexcept {
  if (!matrix.allFinite()) return false;
  const double size = matrix.cwiseAbs().maxCoeff();
  if (!(size <= most)) return false;
  if (size == 0) return true;
  if ((matrix - matrix.transpose()).cwiseAbs().maxCoeff() > kRounding * size) return false;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(matrix / size, Eigen::EigenvaluesOnly);
  if (solver.info() != Eigen::Success) return false;
  return solver.eigenvalues().minCoeff() >= -kRounding && solver.eigenvalues().maxCoeff() * size <= most;
}

bool is_stable(const Mass& mass, double most_per_kg) noexcept {
  return kStep_s * (kStep_s * mass.stiffness_N_per_m + 2 * mass.damping_N_s_per_m) * most_per_kg < 4;
}

bool is_right(const Surface& surface) noexcept {
  const bool relaxes = surface.relaxing_N_per_m != 0;
  const bool relaxes_soundly = is_from_zero_to(surface.relaxing_N_per_m, kStiff_N_per_m) &&
                               surface.relaxation_s >= kShortest_s && surface.relaxation_s <= kLongest_s &&
                               std::abs(surface.relaxed_N) <= kStrong_N;
  return is_within(surface.force_N, kStrong_N) && is_within(surface.place_m, kFar_m) && is_unit(surface.normal) &&
         is_between_zero_and(surface.stiffness_N_per_m, kStiff_N_per_m) &&
         is_from_zero_to(surface.damping_N_s_per_m, kDamped_N_s_per_m) &&
         is_within(surface.velocity_m_per_s, kFast_m_per_s) &&
         is_within(surface.acceleration_m_per_s2, kHard_m_per_s2) &&
         (relaxes ? relaxes_soundly : surface.relaxed_N == 0) && is_from_zero_to(surface.friction, kRough) &&
         surface.radius_m > 0 && surface.radius_m <= kFar_m;
}

bool is_right(const Mass& mass) noexcept {
  const bool placed = is_within(mass.force_N, kStrong_N) && is_within(mass.place_m, kFar_m) &&
                      is_within(mass.velocity_m_per_s, kFast_m_per_s) && is_within(mass.bias_m_per_s2, kHard_m_per_s2);
  const bool coupled = is_from_zero_to(mass.stiffness_N_per_m, kStiff_N_per_m) &&
                       is_from_zero_to(mass.damping_N_s_per_m, kDamped_N_s_per_m) &&
                       is_between_zero_and(mass.free_per_kg, 1 / kLightest_kg);
  if (!placed || !coupled) return false;
  const double most_per_kg = eigenvalues(mass.free_per_kg).maxCoeff();
  const bool pushes = mass.push.allFinite() && (mass.push.isZero(0) || is_unit(mass.push));
  return is_stable(mass, most_per_kg) && pushes &&
         is_between_zero_and(mass.mobility_per_kg, (1 + 100 * kRounding) * most_per_kg) && mass.travel_m >= 0 &&
         mass.radius_m > 0 && mass.radius_m <= kFar_m;
}

bool is_right(const Field& field) noexcept {
  return is_within(field.force_N, kStrong_N) && is_within(field.place_m, kFar_m) &&
         field.jacobian_N_per_m.allFinite() && field.jacobian_N_per_m.cwiseAbs().maxCoeff() <= kStiff_N_per_m &&
         field.radius_m > 0 && field.radius_m <= kFar_m;
}

}  // namespace

Point LocalModel::force_N() const noexcept {
  Point sum_N = Point::Zero();
  for (std::uint32_t i = 0; i < surface_count; ++i) sum_N += surfaces.at(i).force_N;
  if (has_mass) sum_N += mass.force_N;
  if (has_field) sum_N += field.force_N;
  return sum_N;
}

bool is_sound(const LocalModel& model) noexcept {
  if (model.surface_count > LocalModel::kSurfacesMax) return false;
  if (model.before_reading > LocalModel::kBeforeReadingMost || model.before_reading < -LocalModel::kBeforeReadingMost) {
    return false;
  }
  for (std::uint32_t i = 0; i < model.surface_count; ++i) {
    if (!is_right(model.surfaces.at(i))) return false;
  }
  return (!model.has_mass || is_right(model.mass)) && (!model.has_field || is_right(model.field));
}

bool is_stable(const Mass& mass) noexcept { return is_stable(mass, eigenvalues(mass.free_per_kg).maxCoeff()); }

bool add(const LocalModel& part, LocalModel& to) noexcept {
  const bool fits = part.surface_count <= LocalModel::kSurfacesMax - to.surface_count &&
                    !(part.has_mass && to.has_mass) && !(part.has_field && to.has_field);
  if (!fits) return false;
  for (std::uint32_t i = 0; i < part.surface_count; ++i) to.surfaces.at(to.surface_count++) = part.surfaces.at(i);
  if (part.has_mass) to.mass = part.mass;
  if (part.has_field) to.field = part.field;
  to.has_mass = to.has_mass || part.has_mass;
  to.has_field = to.has_field || part.has_field;
  return true;
}

}  // namespace forcebound::local_model
