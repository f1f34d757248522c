#pragma once

#include "forcebound/server/security/key_files.hpp"

namespace CLI {
class App;
}  // namespace CLI

namespace forcebound::server {

/// The options --key, --clients, --psk and --insecure.
void add_key_options(CLI::App& app, KeyFiles& keys);

}  // namespace forcebound::server
