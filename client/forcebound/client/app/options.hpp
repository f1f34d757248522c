#pragma once

#include <optional>
#include <string>

#include "forcebound/client/app/allocation.hpp"
#include "forcebound/client/security/identity_files.hpp"
#include "forcebound/client/session/late_force_policy.hpp"
#include "forcebound/client/session/motion_schedule.hpp"
#include "forcebound/control/law_registry.hpp"
#include "forcebound/device/device_registry.hpp"
#include "forcebound/page/listen_address.hpp"

namespace forcebound::client {

/// The command line of forcebound-client.
struct Options {
  std::string server;     ///< with an allocation: where it fails; may be empty
  Allocation allocation;  ///< who is asked for a server
  IdentityFiles identity;
  bool insecure = false;
  std::string scene;
  device::DeviceRequest device;  ///< the hand is the operator's specification
  std::string law = "fba-exact";
  std::string law_parameters;  ///< file with the law's parameters; empty: standard values
  std::string law_help;        ///< law to explain instead of running
  control::LawOptions law_options;
  double duration_s = 0;  ///< 0: until interrupted
  unsigned long long seed = 1;
  std::string record;
  std::string summary;
  LateForcePolicy policy;
  std::string rendering = "local";
  std::string scene_cache;  ///< folder, or "none"
  double force_slew_N_per_s = 0;
  double torque_slew_N_m_per_s = 0;
  SendRate send_rate;
  std::optional<page::ListenAddress> page;  ///< where the live page is served; none: nowhere
  std::string relay_control;                ///< whom the page tells what network to emulate; empty: nobody
  bool once = false;
  bool quiet = false;
};

inline constexpr const char* kProgram = "forcebound-client";

/// Parses and completes the options: a device that suits the operator, or the reverse. --law-help needs no server.
/// @throws program::End for help, version and wrong use; std::invalid_argument for wrong use.
Options parse_options(int argc, const char* const* argv);

}  // namespace forcebound::client
