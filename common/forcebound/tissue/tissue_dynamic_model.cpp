#include "forcebound/tissue/tissue_dynamic_model.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "forcebound/text/numbers.hpp"
#include "forcebound/tissue/set_up.hpp"
#include "forcebound/tissue/tissue_shape.hpp"
#include "forcebound/tissue/tissue_world.hpp"

namespace forcebound::tissue {
namespace {

using text::rounded;
using text::to_text;

// A sphere pressed in by half its radius is too stiff by this share on edges as long as the radius, and by the square
// of less on shorter ones: within a quarter of it as measured for blocks, on edges from half the radius to 1.2 of it.
constexpr double kTooStiff = 0.36;

// Nodes lower than the highest by less than this share of the body's height count as highest.
constexpr double kAsHigh = 1e-3;

// Estimates of the cost of a step.
constexpr double kCorotationalTetrahedron_ns = 120;
constexpr double kCorotationalBlock_ns = 45;
constexpr double kPressedTriangle_ns = 500;

// A probe deep below the surface takes that many times what one takes that comes and goes: a point as it slides, and
// snaps over edges, a sphere as it moves.
constexpr double kPointDeep = 3;
constexpr double kSphereDeep = 2;

// A place on top: the middle one of the highest free nodes.
scene::Point top_of(const TetrahedralMesh& mesh, const std::vector<bool>& held) {
  double highest_m = -std::numeric_limits<double>::infinity();
  double lowest_m = std::numeric_limits<double>::infinity();
  for (const int node : mesh.surface_nodes()) {
    const double height_m = mesh.nodes_m()[node].z();
    lowest_m = std::min(lowest_m, height_m);
    if (!held[node]) highest_m = std::max(highest_m, height_m);
  }
  std::vector<int> high;
  scene::Point middle_m = scene::Point::Zero();
  for (const int node : mesh.surface_nodes()) {
    if (held[node] || mesh.nodes_m()[node].z() < highest_m - kAsHigh * (highest_m - lowest_m)) continue;
    high.push_back(node);
    middle_m += mesh.nodes_m()[node];
  }
  if (high.empty()) return mesh.nodes_m()[mesh.surface_nodes().front()];
  middle_m /= static_cast<double>(high.size());
  const auto from_middle_m = [&](int node) { return (mesh.nodes_m()[node] - middle_m).squaredNorm(); };
  return mesh.nodes_m()[*std::ranges::min_element(high, {}, from_middle_m)];
}

struct Range {
  double least = 0;
  double most = 0;
};

// Of one contact at each free node, the tissue and the contact in series, along the direction in which that is
// stiffest.
Range stiffness_of(const LinearTissue& tissue, const std::vector<bool>& held, double contact_N_per_m) {
  Range range{.least = contact_N_per_m};
  for (int node = 0; node < tissue.surface_nodes(); ++node) {
    if (held[tissue.mesh().surface_nodes()[node]]) continue;
    const Eigen::Matrix3d compliance = tissue.compliance_m_per_N(node, node);
    const double least_m_per_N = compliance.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff();
    const double series_N_per_m = 1 / (std::max(least_m_per_N, 0.0) + 1 / contact_N_per_m);
    range.least = std::min(range.least, series_N_per_m);
    range.most = std::max(range.most, series_N_per_m);
  }
  return range;
}

double checked_set_up_s(const TissueDescription& tissue) {
  const double set_up_s = predicted_set_up_s(tissue.mesh, tissue.held_nodes, tissue.large_motion);
  check_set_up(tissue.mesh, set_up_s);
  return set_up_s;
}

const ProbeOptions& checked(const ProbeOptions& probe) {
  probe.check();
  return probe;
}

// Along z at a place, of the tissue at rest under a load spread over what is within a radius of it.
double stiffness_N_per_m_at(const scene::Point& place_m, double radius_m, const CorotationalTissue& tissue) {
  const TetrahedralMesh& mesh = tissue.mesh();
  const auto coordinates = 3 * static_cast<Eigen::Index>(mesh.nodes_m().size());
  Eigen::VectorXd load = Eigen::VectorXd::Zero(coordinates);
  for (const int node : mesh.surface_nodes()) {
    if ((mesh.nodes_m()[node] - place_m).norm() <= radius_m) load[3 * node + 2] = 1;
  }
  load /= load.sum();
  Eigen::VectorXd moved_m = Eigen::VectorXd::Zero(coordinates);
  Eigen::VectorXd scratch = moved_m;
  const std::vector<Eigen::Quaterniond> unturned(mesh.nodes_m().size(), Eigen::Quaterniond::Identity());
  tissue.factors().solve(unturned, load, moved_m, scratch);
  return 1 / load.dot(moved_m);
}

std::string elements_in_words(const TetrahedralMesh& mesh) {
  const std::string elements = std::to_string(mesh.elements());
  if (!mesh.boxes().empty()) return elements + " boxes";
  return elements + " tetrahedra of " + (mesh.middles().empty() ? "4" : "10") + " nodes";
}

std::string coarseness_in_words(const TetrahedralMesh& mesh, double radius_m) {
  const double edge_m = mesh.mean_edge_m();
  const double share = kTooStiff * edge_m * edge_m / (radius_m * radius_m);
  constexpr double kWell = 0.1;
  std::string text = "the mesh makes a sphere half its radius deep about " + rounded(100 * share, 2) +
                     " % too stiff: edges of its surface are " + rounded(1e3 * edge_m, 2) + " mm long";
  if (share > kWell)
    text += ", " + rounded(1e3 * radius_m * std::sqrt(kWell / kTooStiff), 2) + " mm would make it 10 %";
  return text;
}

}  // namespace

TissueDynamicModel::TissueDynamicModel(TissueDescription description)
    : held_nodes_(description.held_nodes),
      probe_(checked(description.probe)),
      material_(description.material),
      set_up_s_(checked_set_up_s(description)),
      law_(law_of(std::move(description), probe_)) {}

TissueDynamicModel::Law TissueDynamicModel::law_of(TissueDescription&& description, const ProbeOptions& probe) {
  if (!description.large_motion) {
    return TissueModel(LinearTissue(std::move(description.mesh), description.material, description.held_nodes), probe);
  }
  return CorotationalTissue(std::move(description.mesh), description.material, description.held_nodes,
                            {.contact_stiffness_N_per_m = probe.contact_stiffness_N_per_m,
                             .radius_m = probe.radius_m,
                             .contact_stiffness_Pa_per_m = description.skin_Pa_per_m});
}

std::unique_ptr<scene::DynamicModelState> TissueDynamicModel::make_state(int seats) const {
  if (seats < 1) throw std::invalid_argument("a tissue has at least one seat, got " + std::to_string(seats));
  if (const auto* linear = std::get_if<TissueModel>(&law_)) return std::make_unique<LinearTissueWorld>(*linear, seats);
  return std::make_unique<CorotationalTissueWorld>(std::get<CorotationalTissue>(law_), seats);
}

bool TissueDynamicModel::fits_client() const noexcept {
  const auto* linear = std::get_if<TissueModel>(&law_);
  return linear != nullptr && tissue::fits_client(*linear, set_up_s_);
}

scene::PartDescription TissueDynamicModel::part_at_client() const {
  return tissue_part(std::get<TissueModel>(law_), held_nodes_);
}

scene::DynamicModelFacts TissueDynamicModel::facts() const {
  const auto* linear = std::get_if<TissueModel>(&law_);
  const TetrahedralMesh& mesh = linear != nullptr ? linear->tissue().mesh() : std::get<CorotationalTissue>(law_).mesh();
  std::vector<bool> held(mesh.nodes_m().size(), false);
  for (const int node : held_nodes_) held[node] = true;
  scene::DynamicModelFacts facts;
  facts.on_surface_m = top_of(mesh, held) + probe_.radius_m * scene::Point::UnitZ();
  for (const scene::Point& node_m : mesh.nodes_m()) facts.bounds_m.extend(node_m);
  facts.stiffness_N_per_m = probe_.contact_stiffness_N_per_m;
  facts.describes_itself = true;
  facts.lines = {
      std::to_string(mesh.nodes_m().size()) + " nodes, " + elements_in_words(mesh) + ", " +
          std::to_string(mesh.surface_nodes().size()) + " nodes on the surface, " +
          std::to_string(std::ranges::count(held, true)) + " held" + pieces_in_words(mesh),
      "elastic: Young's modulus " + to_text(material_.young_Pa) + " Pa, Poisson's ratio " + to_text(material_.poisson)};
  if (linear != nullptr) {
    describe(*linear, held, facts);
  } else {
    describe(std::get<CorotationalTissue>(law_), facts);
  }
  if (probe_.radius_m > 0) facts.lines.push_back(coarseness_in_words(mesh, probe_.radius_m));
  facts.lines.push_back("set up in about " + rounded(set_up_s_, 1) + " s, or less");
  return facts;
}

void TissueDynamicModel::describe(const TissueModel& model, const std::vector<bool>& held,
                                  scene::DynamicModelFacts& facts) const {
  const LinearTissue& tissue = model.tissue();
  facts.memory_bytes = tissue.memory_bytes();
  facts.state_bytes = sizeof(LinearTissueWorld) + sizeof(TissueWorld::Seat);
  facts.cost_ns = model.step_ns();
  const Range stiffness = stiffness_of(tissue, held, probe_.contact_stiffness_N_per_m);
  if (std::ranges::none_of(tissue.mesh().surface_nodes(), [&](int node) { return held[node]; })) {
    facts.stiffness_N_per_m = stiffness.most;
  }
  constexpr int kPointRows = 3;
  facts.seats_max = 1 + OtherContacts::kRowsMax / (probe_.radius_m > 0 ? probe_.contacts_max : kPointRows);
  facts.lines.emplace_back("linear: small displacements and rotations, no inertia");
  facts.lines.push_back((probe_.radius_m > 0 ? "felt by a sphere of " + to_text(probe_.radius_m) + " m, at most " +
                                                   std::to_string(probe_.contacts_max) + " contacts of "
                                             : std::string("felt by a point, a contact of ")) +
                        to_text(probe_.contact_stiffness_N_per_m) + " N/m: at nodes of the surface " +
                        rounded(stiffness.least) + " to " + rounded(stiffness.most) +
                        " N/m with the tissue, where it is held the contact alone");
  facts.lines.push_back("shared, by at most " + std::to_string(facts.seats_max) + " clients, it takes " +
                        std::to_string(OtherContacts::memory_bytes(tissue.surface_nodes())) +
                        " bytes more, and more time the more of them touch it");
}

void TissueDynamicModel::describe(const CorotationalTissue& tissue, scene::DynamicModelFacts& facts) const {
  const auto tetrahedra = tissue.mesh().tetrahedra().size();
  facts.memory_bytes = tissue.memory_bytes();
  facts.state_bytes = sizeof(CorotationalTissueWorld) + tissue.make_body().memory_bytes();
  facts.cost_ns = kCorotationalTetrahedron_ns * static_cast<double>(tetrahedra) +
                  kCorotationalBlock_ns * static_cast<double>(tissue.factors().blocks());
  facts.lines.emplace_back("corotational: large motion, small strain, no inertia");
  if (tissue.pressure()) {
    describe(tissue, *tissue.pressure(), facts);
  } else {
    facts.lines.push_back("felt by a point, tied to the tissue by " + to_text(probe_.contact_stiffness_N_per_m) +
                          " N/m: the largest stiffness");
  }
  const double deep = tissue.pressure() ? kSphereDeep : kPointDeep;
  facts.lines.push_back((tissue.pressure() ? "moving" : "sliding") + std::string(" deep takes about ") +
                        rounded(deep * facts.cost_ns * 1e-6) +
                        " ms a motion of the 1 ms of a tick; iterations beyond it continue at the next one");
}

void TissueDynamicModel::describe(const CorotationalTissue& tissue, const SpherePressure& pressure,
                                  scene::DynamicModelFacts& facts) const {
  const double radius_m = pressure.radius_m();
  // Where nothing gives way but the skin, with all that the sphere is wide.
  facts.stiffness_N_per_m = pressure.stiffness_Pa_per_m() * std::numbers::pi * radius_m * radius_m;
  const scene::Point top_m = facts.on_surface_m - radius_m * scene::Point::UnitZ();
  const double tissue_N_per_m = stiffness_N_per_m_at(top_m, radius_m, tissue);
  facts.cost_ns += kPressedTriangle_ns * static_cast<double>(tissue.mesh().triangles().size());
  facts.lines.push_back("felt by a sphere of " + to_text(radius_m) + " m through a skin of " +
                        rounded(pressure.stiffness_Pa_per_m()) + " Pa/m, at " + std::to_string(pressure.places()) +
                        " places of the surface: on top about " +
                        rounded(1 / (1 / tissue_N_per_m + 1 / facts.stiffness_N_per_m)) +
                        " N/m with the tissue, where it is held the skin alone, " + rounded(facts.stiffness_N_per_m) +
                        " N/m as deep as it is wide");
}

}  // namespace forcebound::tissue
