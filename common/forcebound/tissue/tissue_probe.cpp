#include "forcebound/tissue/tissue_probe.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>
#include <string>

#include "forcebound/text/numbers.hpp"

namespace forcebound::tissue {

SurfacePlace place_of(const TissueState::Contact& contact) noexcept {
  return {.triangle = static_cast<int>(contact.triangle), .weight = scene::to_point(contact.weight)};
}

TissueExtent::TissueExtent(const TetrahedralMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const scene::Point& node : mesh.nodes_m()) box.extend(node);
  middle_m_ = box.center();
  size_m_ = box.diagonal().norm();
}

bool TissueExtent::lets_go(const TissueState& state, const scene::Point& probe_m) const noexcept {
  if (state.started == 0) return false;
  return (probe_m - scene::to_point(state.probe_m)).norm() > size_m_ || (probe_m - middle_m_).norm() > 1.5 * size_m_;
}

std::optional<SurfacePlace> came_in(const TissueSurface& surface, const TissueState& last,
                                    const scene::Point& probe_m) noexcept {
  if (last.started == 0) return std::nullopt;
  return surface.entry(scene::to_point(last.probe_m) - scene::to_point(last.shift_m), probe_m);
}

std::optional<SurfacePlace> touched_place(const TissueSurface& surface, const TissueState& last,
                                          const scene::Point& probe_m) noexcept {
  if (last.contacts > 0) return place_of(last.contact[0]);
  if (last.started != 0) return came_in(surface, last, probe_m);
  const TissueSurface::Nearest nearest = surface.nearest(probe_m);
  return nearest.height_m < 0 ? std::optional(nearest.place) : std::nullopt;
}

bool is_way_clear(const TissueSurface& surface, const TissueState& last, const scene::Point& probe_m,
                  double reach_m) noexcept {
  const scene::Point from_m = last.started != 0 ? scene::to_point(last.probe_m) : probe_m;
  return surface.is_clear_of(from_m.cwiseMin(probe_m).array() - reach_m, from_m.cwiseMax(probe_m).array() + reach_m);
}

void ProbeOptions::check() const {
  const auto refuse = [](const std::string& what, double value) {
    throw std::invalid_argument(what + ", got " + text::to_text(value));
  };
  if (!(radius_m >= 0) || !std::isfinite(radius_m)) refuse("radius_m must be >= 0", radius_m);
  if (!(contact_stiffness_N_per_m > 0) || !std::isfinite(contact_stiffness_N_per_m)) {
    refuse("contact_stiffness_N_per_m must be > 0", contact_stiffness_N_per_m);
  }
  if (contacts_max < 1 || contacts_max > kContactsMax) {
    refuse("contacts_max must be from 1 to " + std::to_string(kContactsMax), contacts_max);
  }
  if (iterations_max < 1) refuse("iterations_max must be >= 1", iterations_max);
  if (!(tolerance > 0 && tolerance < 1)) refuse("tolerance must be > 0 and < 1", tolerance);
}

}  // namespace forcebound::tissue
