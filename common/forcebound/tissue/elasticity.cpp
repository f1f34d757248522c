#include "forcebound/tissue/elasticity.hpp"

#include <Eigen/Geometry>
#include <stdexcept>

#include "forcebound/text/numbers.hpp"

namespace forcebound::tissue {
namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;

void add_block(Triplets& triplets, int node_a, int node_b, const Eigen::Matrix3d& block) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      triplets.emplace_back(3 * node_a + row, 3 * node_b + column, block(row, column));
    }
  }
}

// The change of volume at each node, as a linear function of the displacements: the sum over the tetrahedra around it
// of a quarter of theirs. One row per node [m^2].
Eigen::SparseMatrix<double, Eigen::RowMajor> volume_changes(const TetrahedralMesh& mesh,
                                                            const std::vector<ShapeGradients>& gradients) {
  Triplets triplets;
  for (std::size_t t = 0; t < gradients.size(); ++t) {
    for (const int at : mesh.tetrahedra()[t]) {
      for (std::size_t b = 0; b < 4; ++b) {
        const scene::Point change = mesh.volumes_m3()[t] / 4 * gradients[t].col(static_cast<Eigen::Index>(b));
        for (int axis = 0; axis < 3; ++axis) {
          triplets.emplace_back(at, 3 * mesh.tetrahedra()[t][b] + axis, change[axis]);
        }
      }
    }
  }
  const auto nodes = static_cast<Eigen::Index>(mesh.nodes_m().size());
  Eigen::SparseMatrix<double, Eigen::RowMajor> changes(nodes, 3 * nodes);
  changes.setFromTriplets(triplets.begin(), triplets.end());
  return changes;
}

Eigen::VectorXd node_volumes(const TetrahedralMesh& mesh) {
  Eigen::VectorXd volumes = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(mesh.nodes_m().size()));
  for (std::size_t t = 0; t < mesh.tetrahedra().size(); ++t) {
    for (const int node : mesh.tetrahedra()[t]) volumes[node] += mesh.volumes_m3()[t] / 4;
  }
  return volumes;
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

std::vector<ShapeGradients> shape_gradients(const TetrahedralMesh& mesh) {
  std::vector<ShapeGradients> all;
  all.reserve(mesh.tetrahedra().size());
  for (std::size_t t = 0; t < mesh.tetrahedra().size(); ++t) {
    const auto corner = [&](std::size_t a) -> const scene::Point& { return mesh.nodes_m()[mesh.tetrahedra()[t][a]]; };
    const scene::Point b = corner(1) - corner(0);
    const scene::Point c = corner(2) - corner(0);
    const scene::Point d = corner(3) - corner(0);
    const double six_volumes = 6 * mesh.volumes_m3()[t];
    ShapeGradients gradients;
    gradients.col(1) = c.cross(d) / six_volumes;
    gradients.col(2) = d.cross(b) / six_volumes;
    gradients.col(3) = b.cross(c) / six_volumes;
    gradients.col(0) = -(gradients.col(1) + gradients.col(2) + gradients.col(3));
    all.push_back(gradients);
  }
  return all;
}

Eigen::SparseMatrix<double> stiffness_matrix(const TetrahedralMesh& mesh, const ElasticMaterial& material,
                                             VolumeLaw law) {
  material.check();
  const std::vector<ShapeGradients> gradients = shape_gradients(mesh);
  const double lambda_Pa = law == VolumeLaw::per_tetrahedron ? material.lambda_Pa() : 0;
  Triplets triplets;
  triplets.reserve(144 * gradients.size());
  for (std::size_t t = 0; t < gradients.size(); ++t) {
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        const scene::Point ga = gradients[t].col(a);
        const scene::Point gb = gradients[t].col(b);
        const Eigen::Matrix3d per_volume =
            lambda_Pa * ga * gb.transpose() +
            material.mu_Pa() * (gb * ga.transpose() + ga.dot(gb) * Eigen::Matrix3d::Identity());
        add_block(triplets, mesh.tetrahedra()[t][a], mesh.tetrahedra()[t][b], mesh.volumes_m3()[t] * per_volume);
      }
    }
  }
  const auto size = 3 * static_cast<Eigen::Index>(mesh.nodes_m().size());
  Eigen::SparseMatrix<double> stiffness(size, size);
  stiffness.setFromTriplets(triplets.begin(), triplets.end());
  if (law == VolumeLaw::per_tetrahedron) return stiffness;
  const Eigen::SparseMatrix<double, Eigen::RowMajor> changes = volume_changes(mesh, gradients);
  const Eigen::VectorXd weights = material.lambda_Pa() * node_volumes(mesh).cwiseInverse();
  const Eigen::SparseMatrix<double> volume = changes.transpose() * weights.asDiagonal() * changes;
  return stiffness + volume;
}

FreeCoordinates::FreeCoordinates(int nodes, const std::vector<int>& held_nodes) : first_(nodes, 0) {
  for (const int node : held_nodes) {
    if (node < 0 || node >= nodes) {
      throw std::invalid_argument("held node " + std::to_string(node) + " does not exist: expected 0 to " +
                                  std::to_string(nodes - 1));
    }
    first_[node] = kHeld;
  }
  for (int& first : first_) {
    if (first == kHeld) continue;
    first = count_;
    count_ += 3;
  }
}

Eigen::SparseMatrix<double> FreeCoordinates::reduced(const Eigen::SparseMatrix<double>& all) const {
  Triplets triplets;
  triplets.reserve(static_cast<std::size_t>(all.nonZeros()));
  const auto index = [&](Eigen::Index coordinate) {
    const int first = first_of(static_cast<int>(coordinate / 3));
    return first == kHeld ? kHeld : first + static_cast<int>(coordinate % 3);
  };
  for (Eigen::Index column = 0; column < all.outerSize(); ++column) {
    if (index(column) == kHeld) continue;
    for (Eigen::SparseMatrix<double>::InnerIterator entry(all, column); entry; ++entry) {
      if (index(entry.row()) != kHeld) triplets.emplace_back(index(entry.row()), index(column), entry.value());
    }
  }
  Eigen::SparseMatrix<double> free(count_, count_);
  free.setFromTriplets(triplets.begin(), triplets.end());
  return free;
}

}  // namespace forcebound::tissue
