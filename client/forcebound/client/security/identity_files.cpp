#include "forcebound/client/security/identity_files.hpp"

#include <cstdlib>
#include <filesystem>
#include <stdexcept>

#include "forcebound/config/config_error.hpp"
#include "forcebound/security/key_file.hpp"

namespace forcebound::client {
namespace {

security::KeyPair new_key_pair(const Handshaker::FillRandom& fill) {
  security::SecretKey random;
  fill(*random);
  return security::key_pair_from(*random);
}

/// Of new files: their folder must be there before a server can be added.
void make_folder_of(const std::string& file) {
  std::error_code failed;
  std::filesystem::create_directories(std::filesystem::path(file).parent_path(), failed);
}

void read_known(const IdentityFiles& files, Identity& identity) {
  const bool own = files.known_servers.empty();
  const std::string path = own ? default_known_servers() : files.known_servers;
  if (path.empty()) {
    throw std::invalid_argument(
        "HOME is not set, so there is no file of known servers; accepted are --known-servers FILE and --server-key");
  }
  if (own && files.trust_new) make_folder_of(path);
  identity.known = security::KnownServers::from_file(path);
  identity.new_servers = files.trust_new ? security::NewServers::trusted : security::NewServers::refused;
}

}  // namespace

std::string default_known_servers() {
  const char* const settings = std::getenv("XDG_CONFIG_HOME");
  if (settings != nullptr && *settings != 0) return std::string(settings) + "/forcebound/known_servers";
  const char* const home = std::getenv("HOME");
  return home != nullptr && *home != 0 ? std::string(home) + "/.config/forcebound/known_servers" : std::string();
}

Identity read_identity(const IdentityFiles& files, const std::string& server, const Handshaker::FillRandom& random) {
  if (!files.server_key.empty() && (files.trust_new || !files.known_servers.empty())) {
    throw std::invalid_argument("--server-key says the server's key; --known-servers and --trust-new go without it");
  }
  Identity identity{.server = server};
  if (!files.shared_key.empty()) identity.shared = security::read_shared_key(files.shared_key);
  IdentityFiles others = files;
  others.shared_key.clear();
  if (!others.any()) {
    identity.pattern = security::Pattern::nn_psk0;
    return identity;
  }
  identity.own = files.key.empty() ? new_key_pair(random) : security::read_key_pair(files.key);
  if (!files.server_key.empty()) {
    identity.server_key = security::read_public_key(files.server_key);
  } else {
    read_known(files, identity);
  }
  return identity;
}

}  // namespace forcebound::client
