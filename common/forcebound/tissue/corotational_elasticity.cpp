#include "forcebound/tissue/corotational_elasticity.hpp"

#include <Eigen/LU>

namespace forcebound::tissue {
namespace {

using First = std::array<Eigen::Index, 4>;

// If the resistance of a stretched tetrahedron to rotation is below this share of that of an undeformed one, its second
// derivative would be large and negative.
constexpr double kLooseGradient = 0.1;

// Of the last three corners beside the first, in columns.
inline Eigen::Matrix3d beside_first(const Eigen::VectorXd& all, const First& first) noexcept {
  Eigen::Matrix3d columns;
  for (int corner = 0; corner < 3; ++corner) {
    columns.col(corner) = all.segment<3>(first[corner + 1]) - all.segment<3>(first[0]);
  }
  return columns;
}

inline void add_forces(const Eigen::Matrix3d& on_last_three_N, const First& first, Eigen::VectorXd& force_N) noexcept {
  for (int corner = 0; corner < 3; ++corner) force_N.segment<3>(first[corner + 1]) += on_last_three_N.col(corner);
  force_N.segment<3>(first[0]) -= on_last_three_N.rowwise().sum();
}

// The stress's twist that resists a twist of the displacement's gradient in a stretched tetrahedron.
Eigen::Matrix3d turning_Pa(const Eigen::Matrix3d& stretch, double mu_Pa, double lambda_Pa) noexcept {
  const Eigen::Matrix3d hold = hold_on_rotation(stretch);
  if (!(stretch.determinant() > 0 && hold.determinant() > 8 * kLooseGradient)) return Eigen::Matrix3d::Zero();
  Eigen::Matrix3d turning = (lambda_Pa * (stretch.trace() - 3) - 2 * mu_Pa) * hold.inverse();
  turning.diagonal().array() += mu_Pa;
  return turning;
}

}  // namespace

CorotationalElasticity::CorotationalElasticity(const TetrahedralMesh& mesh, const ElasticMaterial& material)
    : coordinates_(3 * static_cast<Eigen::Index>(mesh.nodes_m().size())),
      mu_Pa_(material.mu_Pa()),
      lambda_Pa_(material.lambda_Pa()) {
  const std::vector<ShapeGradients> gradients = shape_gradients(mesh);
  elements_.reserve(gradients.size());
  for (std::size_t t = 0; t < gradients.size(); ++t) {
    Element element{.first = {}, .gradients = gradients[t].rightCols<3>(), .volume_m3 = mesh.volumes_m3()[t]};
    for (std::size_t corner = 0; corner < 4; ++corner) element.first[corner] = 3 * mesh.tetrahedra()[t][corner];
    elements_.push_back(element);
  }
}

DeformedBody CorotationalElasticity::at_rest() const {
  return {.displacement_m = Eigen::VectorXd::Zero(coordinates_),
          .force_N = Eigen::VectorXd::Zero(coordinates_),
          .energy_J = 0,
          .parts = std::vector<PolarParts>(elements_.size())};
}

void CorotationalElasticity::evaluate(DeformedBody& body, const DeformedBody& near) const noexcept {
  body.force_N.setZero();
  body.energy_J = 0;
  for (std::size_t t = 0; t < elements_.size(); ++t) {
    const Element& element = elements_[t];
    const Eigen::Matrix3d deformation =
        Eigen::Matrix3d::Identity() + beside_first(body.displacement_m, element.first) * element.gradients.transpose();
    const PolarParts parts = polar_parts(deformation, near.parts[t].rotation);
    const double volume_change = parts.stretch.trace() - 3;
    Eigen::Matrix3d stress_Pa = 2 * mu_Pa_ * (parts.stretch - Eigen::Matrix3d::Identity());
    body.energy_J +=
        element.volume_m3 * (stress_Pa.squaredNorm() / (4 * mu_Pa_) + 0.5 * lambda_Pa_ * volume_change * volume_change);
    stress_Pa.diagonal().array() += lambda_Pa_ * volume_change;
    const Eigen::Matrix3d turned_N_m = parts.rotation.toRotationMatrix() * (-element.volume_m3 * stress_Pa);
    add_forces(turned_N_m * element.gradients, element.first, body.force_N);
    body.parts[t] = parts;
  }
}

void CorotationalElasticity::find_turns(const DeformedBody& body,
                                        std::vector<Eigen::Quaterniond>& of_nodes) const noexcept {
  for (Eigen::Quaterniond& turn : of_nodes) turn.coeffs().setZero();
  for (std::size_t t = 0; t < elements_.size(); ++t) {
    const Eigen::Vector4d& turn = body.parts[t].rotation.coeffs();
    for (const Eigen::Index first : elements_[t].first) {
      // A quaternion and its opposite are the same rotation.
      auto& sum = of_nodes[static_cast<std::size_t>(first / 3)].coeffs();
      sum += sum.dot(turn) < 0 ? Eigen::Vector4d(-turn) : turn;
    }
  }
  for (Eigen::Quaterniond& turn : of_nodes) turn.normalize();
}

void CorotationalElasticity::linearise(const DeformedBody& body,
                                       std::vector<LinearisedTetrahedron>& linearised) const noexcept {
  for (std::size_t t = 0; t < elements_.size(); ++t) {
    const Eigen::Matrix3d rotation = body.parts[t].rotation.toRotationMatrix();
    const Eigen::Matrix3d turning = turning_Pa(body.parts[t].stretch, mu_Pa_, lambda_Pa_);
    linearised[t].gradients = rotation * elements_[t].gradients;
    linearised[t].turning_N_m = rotation * (elements_[t].volume_m3 * turning) * rotation.transpose();
  }
}

void CorotationalElasticity::resist(const std::vector<LinearisedTetrahedron>& linearised,
                                    const Eigen::VectorXd& moved_m, Eigen::VectorXd& force_N) const noexcept {
  force_N.setZero();
  for (std::size_t t = 0; t < elements_.size(); ++t) {
    const Element& element = elements_[t];
    const LinearisedTetrahedron& here = linearised[t];
    const Eigen::Matrix3d strain = beside_first(moved_m, element.first) * here.gradients.transpose();
    const Eigen::Vector3d twist(strain(2, 1) - strain(1, 2), strain(0, 2) - strain(2, 0), strain(1, 0) - strain(0, 1));
    const Eigen::Vector3d back = here.turning_N_m * twist;
    Eigen::Matrix3d stress = element.volume_m3 * mu_Pa_ * (strain + strain.transpose());
    stress.diagonal().array() += element.volume_m3 * lambda_Pa_ * strain.trace();
    stress(2, 1) += back.x();
    stress(1, 2) -= back.x();
    stress(0, 2) += back.y();
    stress(2, 0) -= back.y();
    stress(1, 0) += back.z();
    stress(0, 1) -= back.z();
    add_forces(stress * here.gradients, element.first, force_N);
  }
}

}  // namespace forcebound::tissue
