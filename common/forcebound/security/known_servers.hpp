#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/security/keys.hpp"

namespace forcebound::security {

/// What a client does about a server that its file does not name.
enum class NewServers : std::uint8_t { refused, trusted };

/// A client's file of servers and their public keys, one in each line: "HOST:PORT KEY", KEY in base64; lines that begin
/// with '#' are comments. A file that is not there yet is empty.
///
/// For set-up only.
class KnownServers {
 public:
  /// @throws config::ConfigError `FILE:LINE: ...` for what is no such line, or a server that is named twice
  [[nodiscard]] static KnownServers from_file(const std::string& path);

  /// The server's key, if the file has one.
  [[nodiscard]] std::optional<PublicKey> find(std::string_view server) const noexcept;

  /// Returns if this is the server's key. One of an unknown server is added to the file if `new_servers` says so.
  /// @param server HOST:PORT as the user wrote it
  /// @throws config::ConfigError in one line if the server is unknown or has another key
  void expect(const std::string& server, const PublicKey& key, NewServers new_servers);

 private:
  struct Server {
    std::string name;
    PublicKey key;
  };

  std::string path_;
  std::string text_;
  std::vector<Server> servers_;
};

}  // namespace forcebound::security
