#pragma once

#include <cstddef>
#include <vector>

#include "forcebound/tissue/tetrahedral_mesh.hpp"

namespace forcebound::tissue {

/// More tetrahedra than this are refused before anything is made of them: none so fine would answer in a tick.
inline constexpr std::size_t kTetrahedraMost = 100'000;

/// Longest predicted set-up of a tissue in a scene.
inline constexpr double kSetUpMost_s = 30;

/// Predicts how long a tissue takes to set up, the same on every machine: from the operations of its factorisation and
/// solves, which follow from the mesh alone, at a rate of about what a server's processor has when they no longer fit
/// its caches. Small ones take less.
///
/// @param held_nodes of the mesh, which do not move
/// @param large_motion of CorotationalTissue; otherwise of LinearTissue
/// @throws std::invalid_argument for a node that does not exist
[[nodiscard]] double predicted_set_up_s(const TetrahedralMesh& mesh, const std::vector<int>& held_nodes,
                                        bool large_motion);

/// @throws std::runtime_error beginning with the mesh's name, if that is more than kSetUpMost_s
void check_set_up(const TetrahedralMesh& mesh, double set_up_s);

/// @throws std::runtime_error for more than kTetrahedraMost
void check_tetrahedra(double tetrahedra);

}  // namespace forcebound::tissue
