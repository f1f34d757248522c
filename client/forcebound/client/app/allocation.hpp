#pragma once

#include <chrono>
#include <string>

#include "forcebound/http/client.hpp"

namespace CLI {
class App;
}

namespace forcebound::client {

/// Where to ask for a server: the allocator service of Agones, by its REST interface.
struct Allocation {
  std::string url{};    ///< empty: nobody is asked
  std::string fleet{};  ///< the server is to be of this fleet; empty: of any
  std::string name_space{"default"};
  http::Certificates certificates{};
  double wait_s = 5;
};

void add_allocation_options(CLI::App& app, Allocation& allocation);

/// To be called once the options are read. @throws std::invalid_argument for what does not go together
void expect_complete(const Allocation& allocation);

/// The request's body, JSON.
[[nodiscard]] std::string request_text(const Allocation& allocation);

/// The server in the allocator's answer, HOST:PORT: of its ports the one named "forcebound", else the first.
/// @throws std::runtime_error with what it said instead
[[nodiscard]] std::string server_of(const http::Response& answer);

/// Asks for a server, HOST:PORT. Waits `wait_s` at most.
/// @throws std::runtime_error with the reason why there is none
[[nodiscard]] std::string allocate(const Allocation& allocation);

}  // namespace forcebound::client
