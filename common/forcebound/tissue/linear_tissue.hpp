#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "forcebound/tissue/elasticity.hpp"
#include "forcebound/tissue/tissue_surface.hpp"

namespace forcebound::tissue {

/// A linearly elastic body, held at some nodes, in the form that contact needs at a kilohertz: the displacement of each
/// node of its surface under a force on each other one.
///
///     u = C f,   C = rows and columns of the surface in K^-1       [m/N, symmetric]
///
/// K is the stiffness of the elements without the held nodes; a sparse Cholesky factorisation (L D L') gives C
/// at set-up, many columns at a time. Small displacements and rotations; for large ones see CorotationalTissue.
///
/// A model takes 72 bytes per pair of surface nodes: 1.2 MB for 130 nodes, 65 MB for 950, 650 MB for 3000.
///
/// Immutable after set-up, hence shared by any number of sessions.
class LinearTissue {
 public:
  /// @param held_nodes of the mesh, which do not move
  /// @param memory_bytes_max for the compliance
  /// @throws std::invalid_argument for a material that `check` refuses, and for a node that does not exist
  /// @throws std::runtime_error beginning with the mesh's name, if the held nodes leave the body free to move, if no
  /// node is free, and if the compliance would not fit.
  LinearTissue(TetrahedralMesh mesh, const ElasticMaterial& material, const std::vector<int>& held_nodes,
               std::size_t memory_bytes_max = std::size_t{1} << 29U);

  [[nodiscard]] const TetrahedralMesh& mesh() const noexcept { return mesh_; }
  [[nodiscard]] const ElasticMaterial& material() const noexcept { return material_; }

  /// At rest. Its nodes count from 0, in the order of TetrahedralMesh::surface_nodes.
  [[nodiscard]] const TissueSurface& surface() const noexcept { return surface_; }
  [[nodiscard]] int surface_nodes() const noexcept { return static_cast<int>(surface_.nodes_m().size()); }

  /// C: 3 rows and columns per node of the surface; those of held nodes are zero.
  [[nodiscard]] const Eigen::MatrixXd& compliance_m_per_N() const noexcept { return compliance_m_per_N_; }

  /// The displacement of one node of the surface under a force on another.
  [[nodiscard]] auto compliance_m_per_N(int moved, int pushed) const noexcept {
    return compliance_m_per_N_.block<3, 3>(3 * static_cast<Eigen::Index>(moved), 3 * static_cast<Eigen::Index>(pushed));
  }

  /// The same between places.
  [[nodiscard]] Eigen::Matrix3d compliance_m_per_N(const SurfacePlace& moved,
                                                   const SurfacePlace& pushed) const noexcept;

  [[nodiscard]] std::size_t memory_bytes() const noexcept;

 private:
  void find_compliance(const FreeCoordinates& free);

  TetrahedralMesh mesh_;
  ElasticMaterial material_;
  TissueSurface surface_;
  Eigen::MatrixXd compliance_m_per_N_;
};

}  // namespace forcebound::tissue
