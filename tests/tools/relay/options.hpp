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
  std::string trace;  ///< file, empty: none
  std::string log;    ///< file, empty: none
  std::uint64_t seed = 0;
};

/// The program ends after the command line: help, version or wrong use.
struct CommandLineEnd {
  int exit_code;
  std::string text;  ///< for stdout if the exit code is 0, else for stderr
};

/// Reads the command line. `random_seed` is the seed if none is given.
///
/// @throws CommandLineEnd
Options read_command_line(int argc, const char* const* argv, std::uint64_t random_seed);

}  // namespace forcebound::relay
