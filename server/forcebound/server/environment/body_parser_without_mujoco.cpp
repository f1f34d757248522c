// Stands in for body_parser.cpp where MuJoCo is missing.
#include "forcebound/server/environment/body_parser.hpp"

namespace forcebound::server {
namespace {

constexpr const char* kMissing =
    "bodies need MuJoCo, and this Forcebound was built without: install it (Debian: libmujoco-dev libqhull-dev) and "
    "configure and build again";

}  // namespace

bool has_bodies() noexcept { return false; }

std::vector<scene::SceneDynamicModel> parse_bodies(CheckedTable& file) {
  file.each("body", [&](const toml::table& body) -> std::string {
    CheckedTable table(body, file.file(), "body");
    table.fail(kMissing);
  });
  if (const toml::node* setting = file.find("bodies")) file.fail(*setting, kMissing);
  return {};
}

}  // namespace forcebound::server
