#include "forcebound/device/kinematics/geometry.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace forcebound::device {
namespace {

struct Make {
  std::unique_ptr<const Kinematics> operator()(std::monostate) const { return std::make_unique<CartesianKinematics>(); }
  std::unique_ptr<const Kinematics> operator()(const ArmGeometry& g) const {
    return std::make_unique<ArmKinematics>(g);
  }
  std::unique_ptr<const Kinematics> operator()(const FiveBarGeometry& g) const {
    return std::make_unique<FiveBarKinematics>(g);
  }
  std::unique_ptr<const Kinematics> operator()(const DeltaGeometry& g) const {
    return std::make_unique<DeltaKinematics>(g);
  }
  std::unique_ptr<const Kinematics> operator()(const ChainGeometry& g) const {
    return std::make_unique<ChainKinematics>(g);
  }
};

struct Words {
  std::string operator()(std::monostate) const { return "Cartesian"; }
  std::string operator()(const ArmGeometry&) const { return "serial arm"; }
  std::string operator()(const FiveBarGeometry&) const { return "five-bar linkage"; }
  std::string operator()(const DeltaGeometry&) const { return "delta"; }
  std::string operator()(const ChainGeometry& g) const {
    return "serial arm of " + std::to_string(g.joints.size()) + (g.joints.size() == 1 ? " joint" : " joints");
  }
};

}  // namespace

std::unique_ptr<const Kinematics> make_kinematics(const Geometry& geometry) { return std::visit(Make{}, geometry); }

std::string refusal_of_origin(const Kinematics& kinematics, int degrees_of_freedom) {
  constexpr double kNear_m = 1e-6;
  constexpr double kSingularShare = 1e-3;
  const Vector origin = Vector::Zero(std::min(degrees_of_freedom, kTranslations));
  const Vector joints = kinematics.joints_at(origin);
  if (!(kinematics.position(joints).norm() < kNear_m)) return "the tip does not reach the scene's origin";
  Matrix jacobian = kinematics.jacobian(joints);
  // Rotations count with an arm of 0.1 m, the size of such devices: the singular values of mixed units mean nothing.
  constexpr double kArm_m = 0.1;
  if (degrees_of_freedom > kTranslations) jacobian.bottomRows(degrees_of_freedom - kTranslations) *= kArm_m;
  const Vector squares =
      Eigen::SelfAdjointEigenSolver<Matrix>(jacobian * jacobian.transpose(), Eigen::EigenvaluesOnly).eigenvalues();
  const double largest = squares[degrees_of_freedom - 1];
  if (squares[0] > kSingularShare * kSingularShare * largest) return {};
  return degrees_of_freedom > kTranslations
             ? "singular at the scene's origin: there the tip does not move and turn every way"
             : "singular at the scene's origin: there the tip does not move every way";
}

std::string in_words(const Geometry& geometry) { return std::visit(Words{}, geometry); }

}  // namespace forcebound::device
