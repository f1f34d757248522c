#pragma once

#include "forcebound/client/security/identity_files.hpp"

namespace CLI {
class App;
}  // namespace CLI

namespace forcebound::client {

/// Adds --key, --server-key, --known-servers, --trust-new and --psk. Both must outlive the parsing.
void add_identity_options(CLI::App& app, IdentityFiles& files);

}  // namespace forcebound::client
