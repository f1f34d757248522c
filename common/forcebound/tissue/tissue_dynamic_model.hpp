#pragma once

#include <memory>
#include <variant>
#include <vector>

#include "forcebound/scene/dynamic_model.hpp"
#include "forcebound/scene/part_at_client.hpp"
#include "forcebound/tissue/corotational_tissue.hpp"
#include "forcebound/tissue/tissue_contact.hpp"

namespace forcebound::tissue {

/// Settings of a soft tissue and of its probe.
struct TissueDescription {
  TetrahedralMesh mesh;
  ElasticMaterial material;
  std::vector<int> held_nodes;  ///< of the mesh, which do not move
  ProbeOptions probe{};         ///< under large motion the radius counts, and a point's stiffness
  /// CorotationalTissue instead of TissueModel: some milliseconds a thousand tetrahedra, and a contact no stiffer than
  /// CorotationalOptions allow.
  bool large_motion = false;
  double skin_Pa_per_m = 0;  ///< of a sphere under large motion; 0: as CorotationalOptions preset it
};

/// Soft tissue, and probes on it.
///
/// Quasi-static: the force depends on the probe's position, not on time. `move` does the step, `touch` returns its
/// result.
///
/// Immutable; states keep a reference to it and must not outlive it.
class TissueDynamicModel final : public scene::DynamicModel, public scene::RunsAtClient {
 public:
  /// @throws std::invalid_argument for a material, an invalid probe or held node, and for too stiff a
  /// contact under large motion
  /// @throws std::runtime_error beginning with the mesh's name, for what LinearTissue, TissueModel or
  /// CorotationalTissue refuse, and at once if setting them up would take too long: see set_up.hpp
  explicit TissueDynamicModel(TissueDescription description);

  [[nodiscard]] std::unique_ptr<scene::DynamicModelState> make_state(int seats) const override;
  [[nodiscard]] scene::DynamicModelFacts facts() const override;

  /// Never under large motion: the client's step would take too long.
  [[nodiscard]] bool fits_client() const noexcept override;
  [[nodiscard]] scene::PartDescription part_at_client() const override;

 private:
  using Law = std::variant<TissueModel, CorotationalTissue>;

  static Law law_of(TissueDescription&& description, const ProbeOptions& probe);
  void describe(const TissueModel& model, const std::vector<bool>& held, scene::DynamicModelFacts& facts) const;
  void describe(const CorotationalTissue& tissue, scene::DynamicModelFacts& facts) const;
  void describe(const CorotationalTissue& tissue, const SpherePressure& pressure,
                scene::DynamicModelFacts& facts) const;

  std::vector<int> held_nodes_;
  ProbeOptions probe_;
  ElasticMaterial material_;
  double set_up_s_;  // predicted
  Law law_;
};

}  // namespace forcebound::tissue
