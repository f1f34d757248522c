#pragma once

#include "forcebound/local_model/local_model.hpp"
#include "forcebound/tissue/corotational_tissue.hpp"
#include "forcebound/tissue/other_contacts.hpp"
#include "forcebound/tissue/tissue_contact.hpp"

// Local models of a tissue's contact: the plane across its force, in the distance at which the force would end if it
// changed on as it does now, with the slope of the force along its normal,
//
//     F(c) = k n max(0, n . (p - c)),   k = -n . dF/dc n,   p = c + n |F| / k
//
// for a probe at c, where it was in the motion answered: the force there is computed, that of a place ahead would be a
// guess of its own. Across the normal a frictionless contact resists to second order only. Real time: noexcept, no
// allocation.
namespace forcebound::tissue {

/// A probe farther away than this from the tissue has no local model: that is more than a hand moves in the time of an
/// answer.
inline constexpr double kModelledAbove_m = 0.02;

/// How far from a contact its plane holds: some edges of the mesh. O(triangles).
[[nodiscard]] double modelled_radius_m(const TetrahedralMesh& mesh) noexcept;

/// The contact of the last step of `state`, or, without contact, the place that the probe would touch.
/// @param others the other probes as they were in that step; null: there are none
/// @param result of that step
/// @param surface all but its id and radius. @returns whether there is one
[[nodiscard]] bool describe_contact(const TissueModel& model, OtherContacts* others, const TissueState& state,
                                    const TissueResult& result, local_model::Surface& surface) noexcept;

/// The same of a tissue under large motion, with the stiffness that its nodes have turned with.
/// @param body scratch memory of it is used
[[nodiscard]] bool describe_contact(const CorotationalTissue& tissue, CorotationalBody& body, const TissueState& state,
                                    const TissueResult& result, local_model::Surface& surface) noexcept;

}  // namespace forcebound::tissue
