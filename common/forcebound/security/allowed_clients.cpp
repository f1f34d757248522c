#include "forcebound/security/allowed_clients.hpp"

#include <algorithm>
#include <stdexcept>

#include "forcebound/config/checked_table.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/names.hpp"

namespace forcebound::security {
namespace {

constexpr std::size_t kClientsBytesMost = std::size_t{4} << 20U;

std::vector<std::string> scenes_of(config::CheckedTable& client, const std::vector<std::string>& known) {
  constexpr std::string_view kAccepted = "a list of at least one scene's name, or left out for all scenes";
  std::vector<std::string> scenes;
  const config::Node* const given = client.find("scenes");
  if (given == nullptr) return scenes;
  const auto* const list = given->as<config::Node::List>();
  if (list == nullptr || list->empty()) client.refuse("scenes", std::string(kAccepted));
  scenes.reserve(list->size());
  for (const config::Node& scene : *list) {
    const auto* const name = scene.as<std::string>();
    if (name == nullptr || name->empty()) client.refuse("scenes", std::string(kAccepted));
    if (!known.empty() && std::ranges::find(known, *name) == known.end()) {
      client.fail(scene, "scenes: no scene '" + *name + "'" + text::suggestion(*name, known));
    }
    scenes.push_back(*name);
  }
  return scenes;
}

}  // namespace

bool AllowedClient::may_use(std::string_view scene) const noexcept {
  return scenes.empty() || std::ranges::find(scenes, scene) != scenes.end();
}

AllowedClients AllowedClients::parse(std::string_view toml_text, const std::string& place,
                                     const std::vector<std::string>& scenes) {
  constexpr double kRateMost_per_s = 1e6;
  constexpr double kSessionsMost = 1e6;
  const config::Node node = config::parse_toml(toml_text, place);
  config::CheckedTable file(node, place, "allowed clients");
  AllowedClients allowed;
  file.each("client", [&](config::CheckedTable& table, const std::string& name) {
    AllowedClient client{
        .name = name, .key = {}, .scenes = scenes_of(table, scenes), .rate_per_s_max = {}, .sessions_max = {}};
    const std::optional<PublicKey> key = public_key_from(table.text("public_key"));
    if (!key) table.refuse("public_key", "a public key: 44 characters of base64, as forcebound keygen prints them");
    client.key = *key;
    if (const AllowedClient* const same = allowed.find(*key)) {
      table.refuse("public_key", "another for each client; client '" + same->name + "' has this one");
    }
    if (table.find("rate_per_s_max") != nullptr) {
      client.rate_per_s_max =
          table.number({.key = "rate_per_s_max", .least = 0, .least_excluded = true, .most = kRateMost_per_s});
    }
    if (table.find("sessions_max") != nullptr) {
      client.sessions_max =
          static_cast<std::size_t>(table.whole({.key = "sessions_max", .least = 1, .most = kSessionsMost}));
    }
    table.refuse_unknown_keys();
    allowed.clients_.push_back(std::move(client));
  });
  file.refuse_unknown_keys();
  return allowed;
}

AllowedClients AllowedClients::from_file(const std::string& path, const std::vector<std::string>& scenes) {
  std::string text;
  try {
    text = text::read_file(path, kClientsBytesMost);
  } catch (const std::runtime_error& error) {
    throw config::ConfigError(error.what());
  }
  return parse(text, path, scenes);
}

const AllowedClient* AllowedClients::find(const PublicKey& key) const noexcept {
  const auto found = std::ranges::find(clients_, key, &AllowedClient::key);
  return found == clients_.end() ? nullptr : &*found;
}

}  // namespace forcebound::security
