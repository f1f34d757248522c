#pragma once

#include <optional>
#include <string>

#include "forcebound/client/app/allocation.hpp"
#include "forcebound/client/runtime/client.hpp"
#include "forcebound/control/law_registry.hpp"
#include "forcebound/device/device_registry.hpp"
#include "forcebound/page/listen_address.hpp"

namespace forcebound::client {

/// The command line of forcebound-client.
struct Options {
  Client::Settings client;       ///< its server, with an allocation: where that fails; may be empty
  Allocation allocation;         ///< who is asked for a server
  device::DeviceRequest device;  ///< the hand is the operator's specification
  std::string law_parameters;    ///< file with the law's parameters; empty: standard values
  std::string law_help;          ///< law to explain instead of running
  control::LawOptions law_options;
  std::string summary;
  std::optional<page::ListenAddress> page;  ///< where the live page is served; none: nowhere
  std::string relay_control;                ///< whom the page tells what network to emulate; empty: nobody
  bool quiet = false;
};

inline constexpr const char* kProgram = "forcebound-client";

/// Parses and completes the options: a device that suits the operator, or the reverse. --law-help needs no server.
/// @throws program::End for help, version and wrong use; std::invalid_argument for wrong use.
Options parse_options(int argc, const char* const* argv);

}  // namespace forcebound::client
