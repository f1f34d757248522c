#include "forcebound/tissue/linear_tissue.hpp"

#include <algorithm>
#include <stdexcept>

#include "forcebound/text/numbers.hpp"
#include "forcebound/tissue/held_stiffness.hpp"

namespace forcebound::tissue {
namespace {

constexpr int kProbedForLocking = 64;

TissueSurface surface_of(const TetrahedralMesh& mesh) {
  std::vector<int> index(mesh.nodes_m().size(), 0);
  std::vector<scene::Point> nodes_m;
  for (const int node : mesh.surface_nodes()) {
    index[node] = static_cast<int>(nodes_m.size());
    nodes_m.push_back(mesh.nodes_m()[node]);
  }
  std::vector<TetrahedralMesh::Triangle> triangles;
  triangles.reserve(mesh.triangles().size());
  for (const auto& [a, b, c] : mesh.triangles()) triangles.push_back({index[a], index[b], index[c]});
  return {std::move(nodes_m), std::move(triangles)};
}

}  // namespace

LinearTissue::LinearTissue(TetrahedralMesh mesh, const ElasticMaterial& material, const std::vector<int>& held_nodes,
                           std::size_t memory_bytes_max)
    : mesh_(std::move(mesh)), material_(material), surface_(surface_of(mesh_)) {
  material_.check();
  const auto side = static_cast<std::size_t>(3 * surface_nodes());
  if (side * side > memory_bytes_max / sizeof(double)) {
    throw std::runtime_error(mesh_.name() + ": the compliance of its " + std::to_string(surface_nodes()) +
                             " surface nodes would take " + std::to_string(side * side * sizeof(double)) +
                             " bytes: expected at most " + std::to_string(memory_bytes_max) + ", so a coarser mesh");
  }
  const FreeCoordinates free(static_cast<int>(mesh_.nodes_m().size()), held_nodes);
  find_compliance(free);
  find_locking(free);
}

void LinearTissue::find_compliance(const FreeCoordinates& free) {
  SparseCholesky cholesky;
  factorise(cholesky, free.reduced(stiffness_matrix(mesh_, material_)), mesh_.name());
  compliance_m_per_N_ = Eigen::MatrixXd::Zero(3 * surface_nodes(), 3 * surface_nodes());
  Eigen::MatrixXd loads = Eigen::MatrixXd::Zero(free.count(), 3);
  for (int column = 0; column < surface_nodes(); ++column) {
    const int loaded = free.first_of(mesh_.surface_nodes()[column]);
    if (loaded == FreeCoordinates::kHeld) continue;
    loads.middleRows<3>(loaded).setIdentity();
    const Eigen::MatrixXd moved = cholesky.solve(loads);
    loads.middleRows<3>(loaded).setZero();
    for (int row = 0; row < surface_nodes(); ++row) {
      const int from = free.first_of(mesh_.surface_nodes()[row]);
      if (from == FreeCoordinates::kHeld) continue;
      compliance_m_per_N_.block<3, 3>(3 * row, 3 * column) = moved.middleRows<3>(from);
    }
  }
  // Symmetric to the last bit, so that a force is exactly the gradient of an energy.
  compliance_m_per_N_ = (0.5 * (compliance_m_per_N_ + compliance_m_per_N_.transpose())).eval();
}

Eigen::Matrix3d LinearTissue::compliance_m_per_N(const SurfacePlace& moved, const SurfacePlace& pushed) const noexcept {
  const auto& at = surface_.triangles()[moved.triangle];
  const auto& by = surface_.triangles()[pushed.triangle];
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) {
      const double weight = moved.weight[a] * pushed.weight[b];
      if (weight > 0) sum += weight * compliance_m_per_N(at[a], by[b]);
    }
  }
  return sum;
}

void LinearTissue::find_locking(const FreeCoordinates& free) {
  SparseCholesky softer;
  factorise(softer, free.reduced(stiffness_matrix(mesh_, material_, VolumeLaw::per_node)), mesh_.name());
  const int stride = 1 + surface_nodes() / kProbedForLocking;
  double soft_m_per_N = 0;
  double ours_m_per_N = 0;
  for (int node = 0; node < surface_nodes(); node += stride) {
    const int first = free.first_of(mesh_.surface_nodes()[node]);
    if (first == FreeCoordinates::kHeld) continue;
    Eigen::VectorXd load = Eigen::VectorXd::Zero(free.count());
    load.segment<3>(first) = surface_.node_normal(node);
    soft_m_per_N += load.dot(softer.solve(load));
    ours_m_per_N += surface_.node_normal(node).dot(compliance_m_per_N(node, node) * surface_.node_normal(node));
  }
  if (ours_m_per_N > 0) locking_ = std::max(1.0, soft_m_per_N / ours_m_per_N);
}

std::string LinearTissue::warning() const {
  if (locking_ < kLocked) return "";
  return mesh_.name() + ": with poisson " + text::to_text(material_.poisson) +
         " the tetrahedra lock: displacements are about " + text::rounded(locking_) +
         " times too small; a smaller ratio or a finer mesh locks less";
}

std::size_t LinearTissue::memory_bytes() const noexcept {
  return static_cast<std::size_t>(compliance_m_per_N_.size()) * sizeof(double) +
         surface_.nodes_m().size() * 2 * sizeof(scene::Point) +
         surface_.triangles().size() * 2 * sizeof(TetrahedralMesh::Triangle) +
         mesh_.nodes_m().size() * sizeof(scene::Point) +
         mesh_.tetrahedra().size() * (sizeof(TetrahedralMesh::Tetrahedron) + sizeof(double));
}

}  // namespace forcebound::tissue
