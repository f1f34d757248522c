#include "forcebound/tissue/elastic_elements.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <stdexcept>

#include "forcebound/text/numbers.hpp"

namespace forcebound::tissue {
namespace {

using Edges = Eigen::Matrix3d;  // of a box from its first corner, in columns

constexpr int kModes = 15;
constexpr int kBoxRows = 24;
using BoxStiffness = Eigen::Matrix<double, kBoxRows, kBoxRows>;
using Strains = Eigen::Matrix<double, 6, Eigen::Dynamic>;  // xx, yy, zz, and twice xy, yz, zx

Edges edges_of(const TetrahedralMesh& mesh, std::size_t box) {
  const auto corner_m = [&](std::size_t k) { return mesh.nodes_m()[mesh.boxes()[box][k]]; };
  Edges edges;
  edges << corner_m(1) - corner_m(0), corner_m(2) - corner_m(0), corner_m(4) - corner_m(0);
  return edges;
}

// Where a corner of a box lies from its middle along each axis: -1 or 1.
Eigen::Array3d side_of(int corner) {
  const auto [x, y, z] = TetrahedralSoup::steps_to(corner);
  return 2 * Eigen::Array3d(x, y, z) - 1;
}

Eigen::Matrix<double, 6, 6> hookes_law_Pa(const ElasticMaterial& material) {
  Eigen::Matrix<double, 6, 6> law = Eigen::Matrix<double, 6, 6>::Zero();
  law.topLeftCorner<3, 3>().setConstant(material.lambda_Pa());
  law.diagonal().array() += material.mu_Pa();
  law.diagonal().head<3>().array() += material.mu_Pa();
  return law;
}

// Of the corners' displacements, at a place from -1 to 1 along each axis.
Strains box_strains(const Eigen::Array3d& size_m, const Eigen::Array3d& at) {
  Strains strains = Strains::Zero(6, kBoxRows);
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Array3d side = side_of(corner);
    const Eigen::Array3d linear = (1 + side * at) / 2;
    const Eigen::Array3d g =
        side / size_m * Eigen::Array3d(linear.y() * linear.z(), linear.z() * linear.x(), linear.x() * linear.y());
    strains.block<6, 3>(0, 3 * corner) << g.x(), 0, 0, 0, g.y(), 0, 0, 0, g.z(), g.y(), g.x(), 0, 0, g.z(), g.y(),
        g.z(), 0, g.x();
  }
  return strains;
}

// Of a box's own modes.
Strains enhanced_strains(const Eigen::Array3d& at) {
  Strains strains = Strains::Zero(6, kModes);
  const double x = at.x();
  const double y = at.y();
  const double z = at.z();
  strains.block<1, 3>(0, 0) << x, x * y, x * z;
  strains.block<1, 3>(1, 3) << y, y * z, y * x;
  strains.block<1, 3>(2, 6) << z, z * x, z * y;
  strains.block<1, 2>(3, 9) << x, y;
  strains.block<1, 2>(4, 11) << y, z;
  strains.block<1, 2>(5, 13) << z, x;
  return strains;
}

// With the box's own modes eliminated.
BoxStiffness box_stiffness(const Edges& edges_m, const ElasticMaterial& material) {
  const Eigen::Array3d size_m = edges_m.colwise().norm().transpose();
  const Eigen::Matrix<double, 6, 6> law_Pa = hookes_law_Pa(material) * size_m.prod() / 8;
  constexpr int kBoth = kBoxRows + kModes;
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(kBoth, kBoth);
  for (int point = 0; point < 8; ++point) {
    const Eigen::Array3d at = side_of(point) / std::sqrt(3.0);
    Strains strains(6, kBoth);
    strains << box_strains(size_m, at), enhanced_strains(at);
    all += strains.transpose() * law_Pa * strains;
  }
  const Eigen::MatrixXd coupled = all.bottomLeftCorner<kModes, kBoxRows>();
  BoxStiffness along = all.topLeftCorner<kBoxRows, kBoxRows>();
  along -= coupled.transpose() * all.bottomRightCorner<kModes, kModes>().ldlt().solve(coupled);
  const Eigen::Matrix3d axes = edges_m * size_m.inverse().matrix().asDiagonal();
  BoxStiffness turned;
  for (int a = 0; a < kBoxRows; a += 3) {
    for (int b = 0; b < kBoxRows; b += 3) {
      turned.block<3, 3>(a, b) = axes * along.block<3, 3>(a, b) * axes.transpose();
    }
  }
  return 0.5 * (turned + turned.transpose());
}

// Of the shape functions of the corners of a tetrahedron, without its middles.
Eigen::Matrix<double, 3, 4> corner_gradients(const TetrahedralMesh& mesh, std::size_t tetrahedron) {
  const auto corner = [&](std::size_t a) { return mesh.nodes_m()[mesh.tetrahedra()[tetrahedron][a]]; };
  const scene::Point b = corner(1) - corner(0);
  const scene::Point c = corner(2) - corner(0);
  const scene::Point d = corner(3) - corner(0);
  const double six_volumes = 6 * mesh.volumes_m3()[tetrahedron];
  Eigen::Matrix<double, 3, 4> gradients;
  gradients << scene::Point::Zero(), c.cross(d) / six_volumes, d.cross(b) / six_volumes, b.cross(c) / six_volumes;
  gradients.col(0) = -gradients.rowwise().sum();
  return gradients;
}

// Of ten nodes, at a place by the weights of the corners.
Eigen::Matrix3Xd quadratic_gradients(const Eigen::Matrix<double, 3, 4>& corners, const Eigen::Vector4d& weight) {
  Eigen::Matrix3Xd gradients(3, 10);
  gradients.leftCols<4>() = corners * (4 * weight.array() - 1).matrix().asDiagonal();
  for (std::size_t e = 0; e < TetrahedralMesh::kEdges.size(); ++e) {
    const auto a = static_cast<Eigen::Index>(TetrahedralMesh::kEdges[e][0]);
    const auto b = static_cast<Eigen::Index>(TetrahedralMesh::kEdges[e][1]);
    gradients.col(static_cast<Eigen::Index>(4 + e)) = 4 * (weight[a] * corners.col(b) + weight[b] * corners.col(a));
  }
  return gradients;
}

// The four places of a quadrature that is exact to the second order, by the weights of the corners.
Eigen::Vector4d quadrature_place(int place) {
  Eigen::Vector4d weight = Eigen::Vector4d::Constant((5 - std::sqrt(5.0)) / 20);
  weight[place] = 1 - 3 * weight[place];
  return weight;
}

// Between nodes a and b, for a volume: v (mu g_b g_a' + mu (g_a . g_b) I).
void add_shear(const Eigen::Matrix3Xd& g, double mu_N_m, Eigen::MatrixXd& stiffness) {
  const Eigen::MatrixXd along = mu_N_m * (g.transpose() * g);
  for (Eigen::Index a = 0; a < g.cols(); ++a) {
    for (Eigen::Index b = 0; b < g.cols(); ++b) {
      stiffness.block<3, 3>(3 * a, 3 * b) += mu_N_m * g.col(b) * g.col(a).transpose();
      stiffness.block<3, 3>(3 * a, 3 * b).diagonal().array() += along(a, b);
    }
  }
}

}  // namespace

void ElasticMaterial::check() const {
  if (!(young_Pa > 0) || !std::isfinite(young_Pa)) {
    throw std::invalid_argument("young_Pa must be > 0, got " + text::to_text(young_Pa));
  }
  if (!(poisson > -1 && poisson < 0.5)) {
    throw std::invalid_argument("poisson must be > -1 and < 0.5 (0.5 is incompressible, which is singular), got " +
                                text::to_text(poisson));
  }
}

ElasticElements::ElasticElements(const TetrahedralMesh& mesh, const ElasticMaterial& material)
    : mesh_(mesh), material_(material) {
  material_.check();
  if (alike()) of_box_ = box_stiffness(edges_of(mesh_, 0), material_);
}

std::size_t ElasticElements::nodes_each() const noexcept {
  if (alike()) return 8;
  return mesh_.middles().empty() ? 4 : 10;
}

std::vector<int> ElasticElements::nodes_of(std::size_t element) const {
  if (alike()) return {mesh_.boxes()[element].begin(), mesh_.boxes()[element].end()};
  std::vector<int> nodes(mesh_.tetrahedra()[element].begin(), mesh_.tetrahedra()[element].end());
  if (!mesh_.middles().empty()) {
    nodes.insert(nodes.end(), mesh_.middles()[element].begin(), mesh_.middles()[element].end());
  }
  return nodes;
}

Eigen::Matrix3Xd ElasticElements::mean_gradients_per_m(std::size_t element) const {
  if (alike()) {
    const Eigen::Matrix3d back = edges_of(mesh_, element).inverse().transpose();
    Eigen::Matrix3Xd gradients(3, 8);
    for (int corner = 0; corner < 8; ++corner) gradients.col(corner) = back * side_of(corner).matrix() / 4;
    return gradients;
  }
  const Eigen::Matrix<double, 3, 4> corners = corner_gradients(mesh_, element);
  if (mesh_.middles().empty()) return corners;
  return quadratic_gradients(corners, Eigen::Vector4d::Constant(0.25));
}

Eigen::MatrixXd ElasticElements::stiffness_N_per_m(std::size_t element) const {
  if (alike()) return of_box_;
  const double volume_m3 = mesh_.volumes_m3()[element];
  const Eigen::Matrix3Xd mean = mean_gradients_per_m(element);
  const Eigen::VectorXd change = mean.reshaped();
  Eigen::MatrixXd stiffness = material_.lambda_Pa() * volume_m3 * change * change.transpose();
  if (mesh_.middles().empty()) {
    add_shear(mean, volume_m3 * material_.mu_Pa(), stiffness);
    return stiffness;
  }
  const Eigen::Matrix<double, 3, 4> corners = corner_gradients(mesh_, element);
  for (int place = 0; place < 4; ++place) {
    add_shear(quadratic_gradients(corners, quadrature_place(place)), volume_m3 / 4 * material_.mu_Pa(), stiffness);
  }
  return stiffness;
}

}  // namespace forcebound::tissue
