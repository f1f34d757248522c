#include "forcebound/local_model/local_model.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

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
constexpr double kRough = 100;
constexpr double kDeep_m = 1;
constexpr double kCompliant_per_kg = 1e6;
constexpr double kStiff_per_s2 = 1e9;
constexpr double kDamped_per_s = 1e5;

// Numbers travel with 24 bits, and a normal may have been rounded before.
constexpr double kRounding = 1e-4;
constexpr double kRoundingOfNumbers = 1e-6;

bool is_within(const Point& point, double most) noexcept { return point.allFinite() && point.norm() <= most; }

bool is_from_zero_to(double value, double most) noexcept { return value >= 0 && value <= most; }

bool is_unit(const Point& direction) noexcept {
  return direction.allFinite() && std::abs(direction.norm() - 1) <= kRounding;
}

/// Symmetric, and no eigenvalue below zero or above the most.
bool is_between_zero_and(const Eigen::Matrix3d& matrix, double most, double rounding = kRounding) noexcept {
  if (!matrix.allFinite()) return false;
  const double size = matrix.cwiseAbs().maxCoeff();
  if (!(size <= most)) return false;
  if (size == 0) return true;
  if ((matrix - matrix.transpose()).cwiseAbs().maxCoeff() > kRounding * size) return false;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(matrix / size, Eigen::EigenvaluesOnly);
  if (solver.info() != Eigen::Success) return false;
  return solver.eigenvalues().minCoeff() >= -rounding && solver.eigenvalues().maxCoeff() * size <= most;
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

bool is_right(const Body& body) noexcept {
  return is_within(body.velocity_m_per_s, kFast_m_per_s) && is_within(body.bias_m_per_s2, kHard_m_per_s2) &&
         is_between_zero_and(body.mobility_per_kg, 1 / kLightest_kg, kRoundingOfNumbers) &&
         is_from_zero_to(body.spring_N_per_m, kStiff_N_per_m) &&
         is_from_zero_to(body.damper_N_s_per_m, kDamped_N_s_per_m) && is_from_zero_to(body.dry_friction_N, kStrong_N);
}

bool is_right(const Contact& contact) noexcept {
  return is_unit(contact.normal) && contact.gap_m >= -kDeep_m && contact.gap_m <= kFar_m &&
         is_from_zero_to(contact.compliance_per_kg, kCompliant_per_kg) &&
         is_from_zero_to(contact.stiffness_per_s2, kStiff_per_s2) &&
         is_from_zero_to(contact.damping_per_s, kDamped_per_s) && is_from_zero_to(contact.friction, kRough) &&
         is_right(contact.met) && contact.radius_m > 0 && contact.travel_m >= 0 && contact.return_m >= 0;
}

bool is_right(const Mass& mass) noexcept {
  return is_within(mass.force_N, kStrong_N) && is_within(mass.place_m, kFar_m) &&
         is_from_zero_to(mass.stiffness_N_per_m, kStiff_N_per_m) &&
         is_from_zero_to(mass.damping_N_s_per_m, kDamped_N_s_per_m) && is_right(mass.body) &&
         mass.contact_count <= Mass::kContactsMax &&
         std::all_of(mass.contacts.begin(), mass.contacts.begin() + mass.contact_count,
                     [](const Contact& contact) { return is_right(contact); }) &&
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
