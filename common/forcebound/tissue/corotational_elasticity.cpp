#include "forcebound/tissue/corotational_elasticity.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace forcebound::tissue {
namespace {

// Three rows, a column for each node of an element.
template <int kNodes>
using Columns = Eigen::Matrix<double, 3, kNodes>;

// If the resistance of a stretched element to rotation is below this share of that of an undeformed one, its rotation
// counts as held: its derivative would be large.
constexpr double kLooseElement = 0.1;

Eigen::Matrix3d turn_by_twist_of(const Eigen::Matrix3d& stretch) noexcept {
  const Eigen::Matrix3d hold = hold_on_rotation(stretch);
  if (!(stretch.determinant() > 0 && hold.determinant() > 8 * kLooseElement)) return Eigen::Matrix3d::Zero();
  return hold.inverse();
}

// Relative to the first.
template <int kNodes>
inline Columns<kNodes> gather(const Eigen::VectorXd& all, const Eigen::Index* first) noexcept {
  Columns<kNodes> columns;
  columns.col(0).setZero();
  for (int a = 1; a < kNodes; ++a) columns.col(a) = all.segment<3>(first[a]) - all.segment<3>(first[0]);
  return columns;
}

template <int kNodes>
inline void scatter(const Columns<kNodes>& columns, const Eigen::Index* first, Eigen::VectorXd& all) noexcept {
  for (int a = 0; a < kNodes; ++a) all.segment<3>(first[a]) += columns.col(a);
}

// Sum over the nodes of a x b.
template <int kNodes>
inline Eigen::Vector3d twist(const Columns<kNodes>& a, const Columns<kNodes>& b) noexcept {
  const Eigen::Matrix3d sums = b * a.transpose();
  return {sums(2, 1) - sums(1, 2), sums(0, 2) - sums(2, 0), sums(1, 0) - sums(0, 1)};
}

inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& left) noexcept {
  Eigen::Matrix3d matrix;
  matrix << 0, -left.z(), left.y(), left.z(), 0, -left.x(), -left.y(), left.x(), 0;
  return matrix;
}

}  // namespace

template <int kNodes>
struct CorotationalElasticity::Element {
  static constexpr int kRows = 3 * kNodes;

  const Eigen::Index* first;
  Eigen::Map<const Columns<kNodes>> rest_m;
  Eigen::Map<const Columns<kNodes>> gradients;
  Eigen::Map<const Eigen::Matrix<double, kRows, kRows>> stiffness;

  // K times displacements.
  [[nodiscard]] Columns<kNodes> pushed_by(const Columns<kNodes>& moved_m) const noexcept {
    Columns<kNodes> force_N;
    force_N.reshaped().noalias() = stiffness * moved_m.reshaped();
    return force_N;
  }
};

CorotationalElasticity::CorotationalElasticity(const TetrahedralMesh& mesh, const ElasticMaterial& material)
    : coordinates_(3 * static_cast<Eigen::Index>(mesh.nodes_m().size())) {
  const ElasticElements elements(mesh, material);
  nodes_each_ = elements.nodes_each();
  alike_ = elements.alike();
  const auto columns = static_cast<Eigen::Index>(nodes_each_ * (alike_ ? 1 : elements.count()));
  const auto nodes = static_cast<Eigen::Index>(nodes_each_);
  rest_m_.resize(3, columns);
  gradients_.resize(3, columns);
  stiffness_.resize(3 * nodes, 3 * columns);
  for (std::size_t e = 0; e < elements.count(); ++e) {
    const std::vector<int> at = elements.nodes_of(e);
    for (const int node : at) first_.push_back(3 * static_cast<Eigen::Index>(node));
    if (alike_ && e > 0) continue;
    const Eigen::Index from = static_cast<Eigen::Index>(e) * nodes;
    for (Eigen::Index a = 0; a < nodes; ++a) rest_m_.col(from + a) = mesh.nodes_m()[at[a]] - mesh.nodes_m()[at[0]];
    gradients_.middleCols(from, nodes) = elements.mean_gradients_per_m(e);
    stiffness_.middleCols(3 * from, 3 * nodes) = elements.stiffness_N_per_m(e);
  }
}

template <int kNodes>
CorotationalElasticity::Element<kNodes> CorotationalElasticity::element(std::size_t number) const noexcept {
  const Eigen::Index from = alike_ ? 0 : static_cast<Eigen::Index>(number) * kNodes;
  constexpr Eigen::Index kRows = 3 * kNodes;
  return {.first = &first_[number * kNodes],
          .rest_m = Eigen::Map<const Columns<kNodes>>(rest_m_.data() + 3 * from),
          .gradients = Eigen::Map<const Columns<kNodes>>(gradients_.data() + 3 * from),
          .stiffness = Eigen::Map<const Eigen::Matrix<double, kRows, kRows>>(stiffness_.data() + 3 * kRows * from)};
}

template <typename Do>
void CorotationalElasticity::with_nodes_each(const Do& act) const noexcept {
  if (nodes_each_ == 4) act(std::integral_constant<int, 4>());
  if (nodes_each_ == 8) act(std::integral_constant<int, 8>());
  if (nodes_each_ == 10) act(std::integral_constant<int, 10>());
}

DeformedBody CorotationalElasticity::at_rest() const {
  return {.displacement_m = Eigen::VectorXd::Zero(coordinates_),
          .force_N = Eigen::VectorXd::Zero(coordinates_),
          .energy_J = 0,
          .parts = std::vector<PolarParts>(elements())};
}

LinearisedBody CorotationalElasticity::make_linearised() const {
  const auto columns = static_cast<Eigen::Index>(first_.size());
  return {.frames = std::vector<LinearisedBody::Frame>(elements()),
          .places_m = Eigen::Matrix3Xd::Zero(3, columns),
          .pushes_N = Eigen::Matrix3Xd::Zero(3, columns)};
}

void CorotationalElasticity::evaluate(DeformedBody& body, const DeformedBody& near) const noexcept {
  with_nodes_each([&](auto nodes) { evaluate_each<nodes>(body, near); });
}

template <int kNodes>
void CorotationalElasticity::evaluate_each(DeformedBody& body, const DeformedBody& near) const noexcept {
  body.force_N.setZero();
  body.energy_J = 0;
  for (std::size_t e = 0; e < elements(); ++e) {
    const Element<kNodes> here = element<kNodes>(e);
    const Columns<kNodes> moved_m = gather<kNodes>(body.displacement_m, here.first);
    const Eigen::Matrix3d deformation = Eigen::Matrix3d::Identity() + moved_m * here.gradients.transpose();
    const PolarParts parts = polar_parts(deformation, near.parts[e].rotation);
    const Eigen::Matrix3d rotation = parts.rotation.toRotationMatrix();
    const Columns<kNodes> places_m = rotation.transpose() * (here.rest_m + moved_m);
    const Columns<kNodes> strained_m = places_m - here.rest_m;
    Columns<kNodes> push_N = here.pushed_by(strained_m);
    body.energy_J += 0.5 * strained_m.cwiseProduct(push_N).sum();
    const Eigen::Vector3d twist_N_m = turn_by_twist_of(parts.stretch) * twist<kNodes>(places_m, push_N);
    push_N -= cross_matrix(twist_N_m) * here.gradients;
    scatter<kNodes>(-rotation * push_N, here.first, body.force_N);
    body.parts[e] = parts;
  }
}

void CorotationalElasticity::find_turns(const DeformedBody& body,
                                        std::vector<Eigen::Quaterniond>& of_nodes) const noexcept {
  for (Eigen::Quaterniond& turn : of_nodes) turn.coeffs().setZero();
  for (std::size_t n = 0; n < first_.size(); ++n) {
    const Eigen::Vector4d& turn = body.parts[n / nodes_each_].rotation.coeffs();
    // A quaternion and its opposite are the same rotation.
    auto& sum = of_nodes[static_cast<std::size_t>(first_[n] / 3)].coeffs();
    sum += sum.dot(turn) < 0 ? Eigen::Vector4d(-turn) : turn;
  }
  for (Eigen::Quaterniond& turn : of_nodes) turn.normalize();
}

void CorotationalElasticity::linearise(const DeformedBody& body, LinearisedBody& linearised) const noexcept {
  with_nodes_each([&](auto nodes) { linearise_each<nodes>(body, linearised); });
}

template <int kNodes>
void CorotationalElasticity::linearise_each(const DeformedBody& body, LinearisedBody& linearised) const noexcept {
  for (std::size_t e = 0; e < elements(); ++e) {
    const Element<kNodes> here = element<kNodes>(e);
    const Eigen::Matrix3d rotation = body.parts[e].rotation.toRotationMatrix();
    const Columns<kNodes> places_m =
        rotation.transpose() * (here.rest_m + gather<kNodes>(body.displacement_m, here.first));
    const Columns<kNodes> push_N = here.pushed_by(places_m - here.rest_m);
    const Eigen::Matrix3d turn_by_twist = turn_by_twist_of(body.parts[e].stretch);
    linearised.frames[e] = {.rotation = rotation,
                            .stretch = body.parts[e].stretch,
                            .turn_by_twist = turn_by_twist,
                            .twist_N_m = turn_by_twist * twist<kNodes>(places_m, push_N)};
    const auto from = static_cast<Eigen::Index>(e) * kNodes;
    linearised.places_m.middleCols<kNodes>(from) = places_m;
    linearised.pushes_N.middleCols<kNodes>(from) = push_N;
  }
}

void CorotationalElasticity::resist(const LinearisedBody& linearised, const Eigen::VectorXd& moved_m,
                                    Eigen::VectorXd& force_N) const noexcept {
  force_N.setZero();
  with_nodes_each([&](auto nodes) { resist_each<nodes>(linearised, moved_m, force_N); });
}

template <int kNodes>
void CorotationalElasticity::resist_each(const LinearisedBody& linearised, const Eigen::VectorXd& moved_m,
                                         Eigen::VectorXd& force_N) const noexcept {
  for (std::size_t e = 0; e < elements(); ++e) {
    const Element<kNodes> here = element<kNodes>(e);
    const auto& [rotation, stretch, turn_by_twist, twist_N_m] = linearised.frames[e];
    const auto from = static_cast<Eigen::Index>(e) * kNodes;
    const Columns<kNodes> places_m = linearised.places_m.middleCols<kNodes>(from);
    const Columns<kNodes> push_N = linearised.pushes_N.middleCols<kNodes>(from);
    const Columns<kNodes> moved_here_m = rotation.transpose() * gather<kNodes>(moved_m, here.first);
    const Columns<kNodes> gradients = here.gradients;
    const Eigen::Matrix3d turn = cross_matrix(turn_by_twist * twist<kNodes>(gradients, moved_here_m));
    const Columns<kNodes> strained_m = moved_here_m - turn * places_m;
    const Columns<kNodes> pushed_N = here.pushed_by(strained_m);
    const Eigen::Matrix3d stretched = moved_here_m * gradients.transpose() - turn * stretch;
    const Eigen::Vector3d more_twist =
        twist<kNodes>(strained_m, push_N) + twist<kNodes>(places_m, pushed_N) - hold_on_rotation(stretched) * twist_N_m;
    const Columns<kNodes> change_N = pushed_N + turn * (push_N - cross_matrix(twist_N_m) * gradients) -
                                     cross_matrix(turn_by_twist * more_twist) * gradients;
    scatter<kNodes>(rotation * change_N, here.first, force_N);
  }
}

std::size_t CorotationalElasticity::memory_bytes() const noexcept {
  return first_.size() * sizeof(Eigen::Index) +
         static_cast<std::size_t>(rest_m_.size() + gradients_.size() + stiffness_.size()) * sizeof(double);
}

}  // namespace forcebound::tissue
