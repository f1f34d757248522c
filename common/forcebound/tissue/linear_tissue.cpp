#include "forcebound/tissue/linear_tissue.hpp"

#include <stdexcept>

#include "forcebound/tissue/held_stiffness.hpp"

namespace forcebound::tissue {
namespace {

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
}

void LinearTissue::find_compliance(const FreeCoordinates& free) {
  SparseCholesky cholesky;
  factorise(cholesky, free.reduced(stiffness_matrix(mesh_, material_)), mesh_.name());
  compliance_m_per_N_ = StiffnessFactors(cholesky, free).compliance_m_per_N(mesh_.surface_nodes());
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

std::size_t LinearTissue::memory_bytes() const noexcept {
  return static_cast<std::size_t>(compliance_m_per_N_.size()) * sizeof(double) +
         surface_.nodes_m().size() * 2 * sizeof(scene::Point) +
         surface_.triangles().size() * 2 * sizeof(TetrahedralMesh::Triangle) +
         mesh_.nodes_m().size() * sizeof(scene::Point) +
         mesh_.tetrahedra().size() * (sizeof(TetrahedralMesh::Tetrahedron) + sizeof(double));
}

}  // namespace forcebound::tissue
