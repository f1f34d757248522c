#include "forcebound/server/simulator/touch.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "forcebound/control/classic_text.hpp"
#include "forcebound/local_model/no_longer_than.hpp"

namespace forcebound::server {
namespace {

// The contact of a probe: a reference acceleration of critical damping, and a little softer than the bodies are light.
constexpr double kContact_s = 0.004;
constexpr double kSoftness = 0.02;
// Beyond any gravity and spring of what a hand can touch.
constexpr double kBias_m_per_s2_most = 1000;
constexpr double kUnit = 1e-3;
constexpr double kFar_m = 100;
constexpr double kMobility_per_kg_most = 1e4;
constexpr double kStiffness_N_per_m_most = 1e6;
constexpr double kDamper_N_s_per_m_most = 1e5;
constexpr double kForce_N_most = 1e5;

template <class Value>
void expect(bool fits, const std::string& field, const std::string& accepted, const Value& got) {
  if (!fits) throw std::invalid_argument(control::joined(field, " must be ", accepted, ", got ", got));
}

template <class Numbers>
auto in_a_line(const Eigen::MatrixBase<Numbers>& numbers) {
  return numbers.format(Eigen::IOFormat(Eigen::StreamPrecision, Eigen::DontAlignCols, " ", "; "));
}

bool is_between(double value, double most) noexcept { return value >= 0 && value <= most; }

bool is_mobility(const Eigen::Matrix3d& matrix) {
  if (!matrix.allFinite() || matrix.cwiseAbs().maxCoeff() > kMobility_per_kg_most) return false;
  const double rounding = 1e-6 * matrix.cwiseAbs().maxCoeff();
  if ((matrix - matrix.transpose()).cwiseAbs().maxCoeff() > rounding) return false;
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(matrix, Eigen::EigenvaluesOnly).eigenvalues().minCoeff() >=
         -rounding;
}

void expect_sound(const Touch& touch, const std::string& name) {
  const auto within = [&](const char* field, const Point& vector, double most, const char* accepted) {
    expect(vector.allFinite() && vector.norm() <= most, name + field, accepted, in_a_line(vector.transpose()));
  };
  const auto between = [&](const char* field, double value, double most, const char* accepted) {
    expect(is_between(value, most), name + field, accepted, value);
  };
  within("place_m", touch.place_m, kFar_m, "finite, within 100 m of the origin");
  expect(touch.normal.allFinite() && std::abs(touch.normal.norm() - 1) <= kUnit, name + "normal", "of length 1",
         in_a_line(touch.normal.transpose()));
  within("velocity_m_per_s", touch.velocity_m_per_s, kFar_m, "finite, within 100 m/s");
  expect(is_mobility(touch.mobility_per_kg), name + "mobility_per_kg",
         "symmetric, without an eigenvalue below zero, at most 1e4 1/kg", in_a_line(touch.mobility_per_kg));
  within("others_N", touch.others_N, kForce_N_most, "finite, within 1e5 N");
  between("spring_N_per_m", touch.spring_N_per_m, kStiffness_N_per_m_most, "0 to 1e6 N/m");
  between("damper_N_s_per_m", touch.damper_N_s_per_m, kDamper_N_s_per_m_most, "0 to 1e5 N s/m");
  between("dry_friction_N", touch.dry_friction_N, kForce_N_most, "0 to 1e5 N");
  between("friction", touch.friction, 10, "0 to 10");
  expect(touch.spring_N_per_m == 0 || !touch.mobility_per_kg.isZero(0), name + "spring_N_per_m",
         "0 where mobility_per_kg is 0: what stands does not give way", touch.spring_N_per_m);
  expect(touch.radius_m > 0, name + "radius_m", "above 0 m", touch.radius_m);
}

}  // namespace

Point bias_m_per_s2(const Eigen::Matrix3d& mobility_per_kg, const Point& others_N) noexcept {
  return local_model::no_longer_than<Point>(mobility_per_kg * others_N, kBias_m_per_s2_most);
}

local_model::Mass mass_of(const ProbeFacts& probe, const Point& place_m, const Point& velocity_m_per_s,
                          std::span<const Touch> touches) noexcept {
  local_model::Mass mass{
      .place_m = place_m,
      .stiffness_N_per_m = probe.stiffness_N_per_m,
      .damping_N_s_per_m = probe.damping_N_s_per_m,
      .body = {.velocity_m_per_s = velocity_m_per_s, .mobility_per_kg = Eigen::Matrix3d::Identity() / probe.mass_kg},
      .radius_m = 2 * local_model::Mass::kReachMost_m};
  for (const Touch& touch : touches.first(std::min(touches.size(), kTouchesMost))) {
    const Point normal = touch.normal.normalized();
    const double gap_m = normal.dot(place_m - touch.place_m) - probe.radius_m;
    const double bodies_per_kg = 1 / probe.mass_kg + normal.dot(touch.mobility_per_kg * normal);
    mass.contacts.at(mass.contact_count++) = {
        .normal = normal,
        .gap_m = std::max(gap_m, -kDeepest_m),
        .compliance_per_kg = kSoftness * bodies_per_kg,
        .stiffness_per_s2 = 1 / (kContact_s * kContact_s),
        .damping_per_s = 2 / kContact_s,
        .friction = touch.friction,
        .radius_m = touch.radius_m,
        .met = {.velocity_m_per_s = touch.velocity_m_per_s,
                .bias_m_per_s2 = bias_m_per_s2(touch.mobility_per_kg, touch.others_N),
                .mobility_per_kg = touch.mobility_per_kg,
                .spring_N_per_m = touch.spring_N_per_m,
                .damper_N_s_per_m = touch.damper_N_s_per_m,
                .dry_friction_N = touch.dry_friction_N}};
  }
  return mass;
}

void expect_sound(std::span<const Touch> touches) {
  expect(touches.size() <= kTouchesMost, "touches", "at most " + std::to_string(kTouchesMost) + " of a probe",
         touches.size());
  for (std::size_t i = 0; i < touches.size(); ++i) expect_sound(touches[i], "touches[" + std::to_string(i) + "].");
}

void expect_sound(const ProbeFacts& probe) {
  expect(is_between(probe.radius_m, 1), "probe_radius_m", "0 to 1 m", probe.radius_m);
  expect(probe.mass_kg >= 1e-3 && probe.mass_kg <= 100, "probe_mass_kg", "0.001 to 100 kg", probe.mass_kg);
  expect(probe.stiffness_N_per_m > 0 && probe.stiffness_N_per_m <= 1e5, "probe_stiffness_N_per_m",
         "above 0, up to 1e5 N/m", probe.stiffness_N_per_m);
  expect(is_between(probe.damping_N_s_per_m, 1e4), "probe_damping_N_s_per_m", "0 to 1e4 N s/m",
         probe.damping_N_s_per_m);
}

}  // namespace forcebound::server
