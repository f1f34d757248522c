#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/security/keys.hpp"

namespace forcebound::security {

/// One whom a server lets in.
struct AllowedClient {
  std::string name;
  PublicKey key;
  std::vector<std::string> scenes;          ///< by name; empty: all that the server has
  std::optional<double> rate_per_s_max;     ///< motions; nothing: the server's own limit
  std::optional<std::size_t> sessions_max;  ///< at once; nothing: one more while as many places are free as it has
  [[nodiscard]] bool may_use(std::string_view scene) const noexcept;
};

/// A server's file of the clients that it lets in. A file without a client lets nobody in.
///
///     [[client]]
///     name = "anna"
///     public_key = "mDdhKl+gZ1ZbZ0fQhZ1sV8oM7wSO5xUjqkBbVvHZ0Dk="
///     scenes = ["wall", "palpation"]   # left out: all
///     rate_per_s_max = 1000            # motions; left out: the server's limit
///     sessions_max = 2                 # at once; left out: one more while as many places are free as it has
///
/// For set-up, and for handshakes, which never run on the tick's thread.
class AllowedClients {
 public:
  /// @param place the file's name, for errors
  /// @param scenes that the server has; empty: any may be named
  /// @throws config::ConfigError in one line, also for a name or a key that is there twice
  [[nodiscard]] static AllowedClients parse(std::string_view toml_text, const std::string& place,
                                            const std::vector<std::string>& scenes = {});
  [[nodiscard]] static AllowedClients from_file(const std::string& path, const std::vector<std::string>& scenes = {});

  /// Null if nobody has this key.
  [[nodiscard]] const AllowedClient* find(const PublicKey& key) const noexcept;

  [[nodiscard]] std::span<const AllowedClient> all() const noexcept { return clients_; }

 private:
  std::vector<AllowedClient> clients_;
};

}  // namespace forcebound::security
