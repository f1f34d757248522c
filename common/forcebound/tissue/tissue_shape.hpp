#pragma once

#include <vector>

#include "forcebound/scene/part.hpp"
#include "forcebound/tissue/tissue_contact.hpp"

// Linear tissue under one probe, as an object that a client is handed once and then runs by itself. What it is made of
// travels, not its compliance: with the same arithmetic the client's is the server's to the bit, and symmetric and
// positive whoever sent it.
namespace forcebound::tissue {

/// What a client gives for one tissue; more is neither handed over nor made.
inline constexpr std::size_t kShapeElementsMost = 8000;                ///< tetrahedra or boxes
inline constexpr std::size_t kShapeBytesMost = std::size_t{1} << 27U;  ///< of the compliance
inline constexpr double kShapeSetUpMost_s = 10;                        ///< predicted
inline constexpr double kShapeStepMost_ns = 200e3;                     ///< predicted, of a tick

/// TissueModel as the shape of an object: of a force F the depth below the surface is |F| / K and the normal F / |F|,
/// with K of its contacts, so that the effect `surface` of stiffness K gives F. Not for scene files: who is handed a
/// scene knows it.
[[nodiscard]] scene::ShapeKind tissue_shape();

/// Whether it takes no more than the bounds above.
/// @param set_up_s predicted
[[nodiscard]] bool fits_client(const TissueModel& model, double set_up_s) noexcept;

/// The object, without a name.
/// @param held_nodes of the mesh
[[nodiscard]] scene::PartDescription tissue_part(const TissueModel& model, const std::vector<int>& held_nodes);

}  // namespace forcebound::tissue
