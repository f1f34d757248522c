#include "forcebound/tissue/tissue_world.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <string>

#include "forcebound/tissue/contact_stiffness.hpp"

namespace forcebound::tissue {
namespace {

// A position farther away than that comes from a faulty or hostile client and must not break what others feel.
constexpr double kFar_m = 100;

// Times that a step is done again without the others' contacts that pull: once is nearly always enough.
constexpr int kDropsMax = 4;

scene::VisiblePart surface_part(const std::string& name, const std::vector<scene::Point>& nodes_m,
                                const std::vector<TetrahedralMesh::Triangle>& triangles) {
  scene::VisiblePart part{.name = name, .kind = scene::VisiblePart::Kind::surface, .vertices_m = nodes_m};
  for (const auto& [a, b, c] : triangles) {
    part.triangles.push_back(
        {static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b), static_cast<std::uint32_t>(c)});
  }
  return part;
}

}  // namespace

TissueWorld::TissueWorld(int seats, const TetrahedralMesh& mesh)
    : seats_(static_cast<std::size_t>(seats)), extent_(mesh), modelled_radius_m_(modelled_radius_m(mesh)) {}

int TissueWorld::join() {
  const auto free = std::ranges::find(seats_, false, &Seat::taken);
  if (free == seats_.end()) return -1;
  *free = {};
  free->taken = true;
  return static_cast<int>(free - seats_.begin());
}

void TissueWorld::leave(int seat) { at(seat) = {}; }

void TissueWorld::move(int seat, const scene::Point& position_m, const scene::Point& /*velocity_m_per_s*/) noexcept {
  const scene::Point probe_m = position_m.cwiseMax(-kFar_m).cwiseMin(kFar_m);
  if (extent_.lets_go(at(seat).state, probe_m)) at(seat).state = {};
  const TissueResult result = step(static_cast<std::size_t>(seat), probe_m);
  sound_ = sound_ && result.finite;
  faults_.contacts_left_out += static_cast<std::uint64_t>(result.contacts_left_out);
  if (!result.converged) ++faults_.not_converged;
  at(seat).result = result;
  if (result.contacts > 0) at(seat).normal = result.normal;
}

void TissueWorld::advance(double /*elapsed_s*/) noexcept {
  // Quasi-static.
}

scene::ModelTouch TissueWorld::touch(int seat) noexcept {
  const Seat& touched = at(seat);
  return {.force_N = touched.result.force_N, .normal = touched.normal, .penetration_m = touched.result.depth_m};
}

bool TissueWorld::describe(int seat, local_model::LocalModel& model) noexcept {
  local_model::Surface surface;
  if (!sound_ || !describe_last(at(seat), surface)) return false;
  surface.radius_m = modelled_radius_m_;
  model.surfaces[0] = surface;
  model.surface_count = 1;
  return true;
}

LinearTissueWorld::LinearTissueWorld(const TissueModel& model, int seats)
    : TissueWorld(seats, model.tissue().mesh()),
      model_(model),
      others_(seats > 1 ? std::make_unique<OtherContacts>(model.tissue(), model.options()) : nullptr) {}

TissueResult LinearTissueWorld::step(std::size_t seat, const scene::Point& probe_m) noexcept {
  return others_ == nullptr ? model_.step(seats()[seat].state, probe_m) : step_among(*others_, seat, probe_m);
}

bool LinearTissueWorld::describe_last(const Seat& seat, local_model::Surface& surface) noexcept {
  return describe_contact(model_, others_.get(), seat.state, seat.result, surface);
}

std::vector<scene::VisiblePart> LinearTissueWorld::visible() const {
  const TissueSurface& surface = model_.tissue().surface();
  return {surface_part(model_.tissue().mesh().name(), surface.nodes_m(), surface.triangles())};
}

std::size_t LinearTissueWorld::sample(std::size_t first, std::span<float> to) const noexcept {
  const std::vector<scene::Point>& nodes_m = model_.tissue().surface().nodes_m();
  if (first >= nodes_m.size()) return 0;
  const std::size_t count = std::min(nodes_m.size() - first, to.size() / scene::kNumbersOfVertex);
  Eigen::Map<Eigen::VectorXf> shown(to.data(), static_cast<Eigen::Index>(count * scene::kNumbersOfVertex));
  for (std::size_t i = 0; i < count; ++i) {
    shown.segment<3>(static_cast<Eigen::Index>(3 * i)) = nodes_m[first + i].cast<float>();
  }
  for (const Seat& seat : seats()) {
    if (!seat.taken || seat.result.contacts == 0) continue;
    const auto at = static_cast<Eigen::Index>(3 * first);
    if (model_.options().radius_m <= 0) {
      add_displacement(place_of(seat.state.contact[0]), -seat.result.force_N, at, shown);
      continue;
    }
    const scene::Point direction = scene::to_point(seat.state.direction);
    const int contacts = std::min(seat.result.contacts, static_cast<int>(seat.state.contacts));
    for (int k = 0; k < contacts; ++k) {
      const auto contact = static_cast<std::size_t>(k);
      add_displacement(place_of(seat.state.contact.at(contact)), -seat.result.push_N.at(contact) * direction, at,
                       shown);
    }
  }
  return count * scene::kNumbersOfVertex;
}

void LinearTissueWorld::add_displacement(const SurfacePlace& place, const scene::Point& force_N, Eigen::Index first,
                                         Eigen::Ref<Eigen::VectorXf> to) const noexcept {
  const LinearTissue& tissue = model_.tissue();
  const auto& corners = tissue.surface().triangles()[static_cast<std::size_t>(place.triangle)];
  for (int corner = 0; corner < 3; ++corner) {
    const Eigen::Index column = 3 * static_cast<Eigen::Index>(corners.at(static_cast<std::size_t>(corner)));
    for (int axis = 0; axis < 3; ++axis) {
      const double force = place.weight[corner] * force_N[axis];
      to += (force * tissue.compliance_m_per_N().col(column + axis).segment(first, to.size())).cast<float>();
    }
  }
}

int LinearTissueWorld::gather(OtherContacts& others, std::size_t seat) noexcept {
  int left_out = 0;
  others.clear();
  for (std::size_t other = 0; other < seats().size(); ++other) {
    if (other != seat) left_out += others.add(seats()[other].state);
  }
  return left_out;
}

TissueResult LinearTissueWorld::step_among(OtherContacts& others, std::size_t seat,
                                           const scene::Point& probe_m) noexcept {
  const int left_out = gather(others, seat);
  TissueState& state = seats()[seat].state;
  const TissueState before = state;
  TissueResult result = model_.step(state, probe_m, others);
  for (int n = 0; others.drop_pulling(); ++n) {
    if (n == kDropsMax) {
      result.converged = false;
      break;
    }
    state = before;
    result = model_.step(state, probe_m, others);
  }
  result.contacts_left_out += left_out;
  return result;
}

CorotationalTissueWorld::CorotationalTissueWorld(const CorotationalTissue& tissue, int seats)
    : TissueWorld(seats, tissue.mesh()),
      tissue_(tissue),
      ties_(tissue.pressure() ? 0 : static_cast<std::size_t>(seats - 1)),
      centers_m_(tissue.pressure() ? static_cast<std::size_t>(seats - 1) : 0),
      body_(tissue.make_body()) {}

TissueResult CorotationalTissueWorld::step(std::size_t seat, const scene::Point& probe_m) noexcept {
  const OtherProbes others = tissue_.pressure() ? spheres_beside(seat) : ties_beside(seat);
  return tissue_.step(seats()[seat].state, body_, probe_m, others);
}

bool CorotationalTissueWorld::describe_last(const Seat& seat, local_model::Surface& surface) noexcept {
  return describe_contact(tissue_, body_, seat.state, seat.result, surface);
}

OtherProbes CorotationalTissueWorld::ties_beside(std::size_t seat) noexcept {
  std::size_t count = 0;
  for (std::size_t other = 0; other < seats().size(); ++other) {
    const TissueState& state = seats()[other].state;
    if (other == seat || state.contacts == 0) continue;
    ties_[count++] = {.place = place_of(state.contact[0]), .probe_m = scene::to_point(state.probe_m)};
  }
  return {.ties = {ties_.data(), count}};
}

OtherProbes CorotationalTissueWorld::spheres_beside(std::size_t seat) noexcept {
  std::size_t count = 0;
  for (std::size_t other = 0; other < seats().size(); ++other) {
    const TissueState& state = seats()[other].state;
    if (other != seat && state.started != 0) centers_m_[count++] = scene::to_point(state.probe_m);
  }
  return {.centers_m = {centers_m_.data(), count}};
}

std::vector<scene::VisiblePart> CorotationalTissueWorld::visible() const {
  const TetrahedralMesh& mesh = tissue_.mesh();
  std::vector<int> number(mesh.nodes_m().size(), 0);
  std::vector<scene::Point> nodes_m;
  for (const int node : mesh.surface_nodes()) {
    number[static_cast<std::size_t>(node)] = static_cast<int>(nodes_m.size());
    nodes_m.push_back(mesh.nodes_m()[static_cast<std::size_t>(node)]);
  }
  std::vector<TetrahedralMesh::Triangle> triangles = mesh.triangles();
  for (TetrahedralMesh::Triangle& triangle : triangles) {
    for (int& node : triangle) node = number[static_cast<std::size_t>(node)];
  }
  return {surface_part(mesh.name(), nodes_m, triangles)};
}

std::size_t CorotationalTissueWorld::sample(std::size_t first, std::span<float> to) const noexcept {
  const TetrahedralMesh& mesh = tissue_.mesh();
  const std::vector<int>& shown = mesh.surface_nodes();
  if (first >= shown.size()) return 0;
  const std::size_t count = std::min(shown.size() - first, to.size() / scene::kNumbersOfVertex);
  for (std::size_t i = 0; i < count; ++i) {
    const int node = shown[first + i];
    const scene::Point now_m = mesh.nodes_m()[static_cast<std::size_t>(node)] +
                               body_.now.displacement_m.segment<3>(3 * static_cast<Eigen::Index>(node));
    for (std::size_t axis = 0; axis < scene::kNumbersOfVertex; ++axis) {
      to[scene::kNumbersOfVertex * i + axis] = static_cast<float>(now_m[static_cast<Eigen::Index>(axis)]);
    }
  }
  return count * scene::kNumbersOfVertex;
}

}  // namespace forcebound::tissue
