#include "forcebound/tissue/corotational_tissue.hpp"

#include <cmath>
#include <stdexcept>

#include "forcebound/tissue/pressed_step.hpp"
#include "forcebound/tissue/tied_step.hpp"

namespace forcebound::tissue {
namespace {

template <typename Step>
TissueResult run(Step step, TissueState& state) noexcept {
  const TissueResult result = step.run(state);
  if (!result.force_N.allFinite() || !std::isfinite(result.energy_J)) return {.finite = false};
  state = step.state();
  return result;
}

}  // namespace

CorotationalTissue::CorotationalTissue(TetrahedralMesh mesh, const ElasticMaterial& material,
                                       const std::vector<int>& held_nodes, const CorotationalOptions& options)
    : mesh_(std::move(mesh)),
      options_(options),
      surface_(mesh_.nodes_m(), mesh_.triangles()),
      elasticity_(mesh_, material),
      tolerance_m_(options.tolerance * mesh_.mean_edge_m()) {
  material.check();
  options_.check(material);
  const FreeCoordinates free(static_cast<int>(mesh_.nodes_m().size()), held_nodes);
  SparseCholesky cholesky;
  factorise(cholesky, free.reduced(stiffness_matrix(mesh_, material)), mesh_.name());
  factors_ = StiffnessFactors(cholesky, free);
  if (options_.radius_m > 0) {
    pressure_.emplace(surface_, options_.radius_m, options_.skin_Pa_per_m(material), mesh_.name());
  }
}

std::size_t CorotationalTissue::memory_bytes() const noexcept {
  return elasticity_.memory_bytes() + factors_.memory_bytes() + surface_.nodes_m().size() * 3 * sizeof(scene::Point) +
         surface_.triangles().size() * 2 * sizeof(TetrahedralMesh::Triangle) +
         (pressure_ ? pressure_->memory_bytes() : 0) +
         mesh_.tetrahedra().size() * (sizeof(TetrahedralMesh::Tetrahedron) + sizeof(double));
}

CorotationalBody CorotationalTissue::make_body() const {
  const DeformedBody rest = elasticity_.at_rest();
  const Eigen::VectorXd zeros = Eigen::VectorXd::Zero(rest.displacement_m.size());
  return {.now = rest,
          .trial = rest,
          .linearised = elasticity_.make_linearised(),
          .turns = std::vector<Eigen::Quaterniond>(mesh_.nodes_m().size(), Eigen::Quaterniond::Identity()),
          .direction = zeros,
          .residual = zeros,
          .preconditioned = zeros,
          .search = zeros,
          .product = zeros,
          .scratch = zeros,
          .pressed = PressedTriangles(pressure_ ? mesh_.triangles().size() : 0)};
}

void CorotationalTissue::deform(CorotationalBody& body, const Eigen::VectorXd& displacement_m) const noexcept {
  body.now.displacement_m = displacement_m;
  elasticity_.evaluate(body.now, body.now);
}

TissueResult CorotationalTissue::step(TissueState& state, CorotationalBody& body, const scene::Point& probe_m,
                                      const OtherProbes& others) const noexcept {
  if (!probe_m.allFinite()) return {.finite = false};
  const CorotationalSetting setting{surface_, elasticity_, factors_, options_, tolerance_m_};
  if (pressure_) return run(PressedStep(setting, *pressure_, body, probe_m, others.centers_m), state);
  return run(TiedStep(setting, body, probe_m, others.ties), state);
}

}  // namespace forcebound::tissue
