#pragma once

#include <memory>
#include <string>
#include <vector>

#include "forcebound/scene/dynamic_model.hpp"
#include "forcebound/server/dynamics/bodies/description.hpp"

namespace forcebound::server {

/// Whether Forcebound was built with MuJoCo. If not, the functions below throw std::runtime_error.
[[nodiscard]] bool has_bodies() noexcept;

/// Bodies from their description. @throws std::runtime_error
[[nodiscard]] std::unique_ptr<scene::DynamicModel> make_bodies(BodiesDescription description);

/// An MJCF model, and the devices' coupling to its bodies.
struct MjcfDescription {
  std::string path{};  ///< empty: `text` is the model
  std::string text{};
  std::vector<std::string> probes{};  ///< the bodies that devices drag
  Coupling coupling{};
  SolverOptions solver{};
};

/// @throws std::runtime_error
[[nodiscard]] std::unique_ptr<scene::DynamicModel> make_mjcf(const MjcfDescription& description);

}  // namespace forcebound::server
