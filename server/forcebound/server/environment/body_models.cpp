#include "forcebound/server/environment/body_models.hpp"

#include "forcebound/server/dynamics/bodies/body_dynamic_model.hpp"

namespace forcebound::server {

bool has_bodies() noexcept { return true; }

std::unique_ptr<scene::DynamicModel> make_bodies(BodiesDescription description) {
  return std::make_unique<BodyDynamicModel>(std::move(description), "bodies");
}

std::unique_ptr<scene::DynamicModel> make_mjcf(const MjcfDescription& mjcf) {
  const bool is_file = !mjcf.path.empty();
  return std::make_unique<BodyDynamicModel>(
      is_file ? load_mjcf(mjcf.path) : compile_foreign_mjcf(mjcf.text, "mjcf_text"), mjcf.probes, mjcf.coupling,
      is_file ? mjcf.path : "mjcf_text", mjcf.solver);
}

}  // namespace forcebound::server
