#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "forcebound/net/endpoint.hpp"
#include "tests/tools/netem/impairment.hpp"
#include "tests/tools/netem/netem_parameters.hpp"

namespace forcebound::relay {

inline constexpr const char* kProgram = "forcebound-relay";

/// The command line's options. Files are not opened yet.
struct Options {
  net::Endpoint listen;
  net::Endpoint upstream;
  netem::NetemParameters up;
  netem::NetemParameters down;
  std::string up_words;
  std::string down_words;
  std::vector<netem::Blackhole> up_blackholes;
  std::vector<netem::Blackhole> down_blackholes;
  std::optional<net::Endpoint> control{};  ///< where new impairments come from while it runs
  std::string trace;                       ///< file, empty: none
  std::string log;                         ///< file, empty: none
  std::uint64_t seed = 0;
};

/// Reads the command line. `random_seed` is the seed if none is given.
///
/// @throws program::End for help, version and wrong use; std::invalid_argument for wrong use.
Options read_command_line(int argc, const char* const* argv, std::uint64_t random_seed);

}  // namespace forcebound::relay
