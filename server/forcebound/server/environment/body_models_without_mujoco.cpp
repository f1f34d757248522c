// Stands in for body_models.cpp where MuJoCo is missing.
#include <stdexcept>

#include "forcebound/server/environment/body_models.hpp"

namespace forcebound::server {
namespace {

constexpr const char* kMissing =
    "bodies need MuJoCo, and this Forcebound was built without: install it (Debian: libmujoco-dev libqhull-dev "
    "libtinyxml2-dev) and "
    "configure and build again";

}  // namespace

bool has_bodies() noexcept { return false; }

std::unique_ptr<scene::DynamicModel> make_bodies(BodiesDescription) { throw std::runtime_error(kMissing); }

std::unique_ptr<scene::DynamicModel> make_mjcf(const MjcfDescription&) { throw std::runtime_error(kMissing); }

}  // namespace forcebound::server
