#include "forcebound/security/known_servers.hpp"

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <stdexcept>

#include "forcebound/config/config_error.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/lines.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::security {
namespace {

constexpr std::size_t kServersBytesMost = std::size_t{1} << 20U;
constexpr std::string_view kServerLine = "accepted is 'HOST:PORT KEY', KEY being 44 characters of base64";

std::string text_of(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::symlink_status(path, ignored).type() == std::filesystem::file_type::not_found) return {};
  try {
    return text::read_file(path, kServersBytesMost);
  } catch (const std::runtime_error& error) {
    throw config::ConfigError(error.what());
  }
}

}  // namespace

KnownServers KnownServers::from_file(const std::string& path) {
  KnownServers servers;
  servers.path_ = path;
  servers.text_ = text_of(path);
  std::istringstream text(servers.text_);
  text::LineReader lines(text, text::printable(path));
  try {
    while (lines.next()) {
      if (lines.line().empty() || lines.line().starts_with('#')) continue;
      std::vector<std::string_view> words = text::split_at_blanks(lines.line());
      if (words.size() == 3 && words[1] == kPublicKeyWord) words.erase(words.begin() + 1);
      if (words.size() != 2) lines.refuse("no server with its key; " + std::string(kServerLine));
      const std::optional<PublicKey> key = public_key_from(words[1]);
      if (!key) lines.refuse("this is no public key; " + std::string(kServerLine));
      if (servers.find(words[0])) lines.refuse("the server is named above already; accepted is one key for each");
      servers.servers_.push_back({std::string(words[0]), *key});
    }
  } catch (const std::runtime_error& error) {
    throw config::ConfigError(error.what());
  }
  return servers;
}

std::optional<PublicKey> KnownServers::find(std::string_view server) const noexcept {
  const auto found = std::ranges::find(servers_, server, &Server::name);
  if (found == servers_.end()) return std::nullopt;
  return found->key;
}

void KnownServers::expect(const std::string& server, const PublicKey& key, NewServers new_servers) {
  const std::string file = text::printable(path_);
  const std::string name = text::printable(server);
  const std::string offered = to_base64(key.bytes);
  if (const std::optional<PublicKey> known = find(server)) {
    if (*known == key) return;
    throw config::ConfigError(file + ": server " + name + " has the key " + offered + ", but is known with the key " +
                              to_base64(known->bytes) +
                              ": it was given another key, or somebody else answers; if it was, replace its line");
  }
  if (new_servers == NewServers::refused) {
    throw config::ConfigError(file + ": server " + name + " is not named there; it has the key " + offered +
                              "; if its owner says the same, add the line '" + name + " " + offered +
                              "', or give --trust-new");
  }
  if (server.empty() || text::split_at_blanks(server).size() != 1 || server != name || server.starts_with('#')) {
    throw config::ConfigError(file + ": '" + name + "' is no name for a server; accepted is HOST:PORT");
  }
  // Believed from now on, whether or not it can be written down.
  servers_.push_back({server, key});
  // Others may have written there since.
  const KnownServers there = from_file(path_);
  if (const std::optional<PublicKey> known = there.find(server)) {
    if (*known == key) return;
    throw config::ConfigError(file + ": server " + name + " was given another key there meanwhile: " +
                              to_base64(known->bytes) + ", but it has the key " + offered);
  }
  std::string text = there.text_;
  if (!text.empty() && !text.ends_with('\n')) text += '\n';
  text.append(server).append(" ").append(offered).append("\n");
  try {
    text::write_file(path_, text);
  } catch (const std::runtime_error& error) {
    throw config::ConfigError(error.what());
  }
}

}  // namespace forcebound::security
