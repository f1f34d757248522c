#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace forcebound::client::commands {

struct CheckDeviceRequest {
  std::string device;  ///< as for --device
  double force_share = 0.3;
  double speed_m_per_s_max = 0.5;
  bool guided = false;  ///< by a person at this terminal
};

/// Checks a device in a process of its own, so that whatever its driver does costs no more than that process: it ends
/// by itself, and with zero force as far as the driver's `stop` goes, if a call does not return. SIGINT, SIGTERM and
/// SIGHUP end it likewise, and so does the end of this process.
///
/// @returns an array of the checks, each with check, verdict (passed, failed, not checked), measured and accepted; the
/// last one says how the process ended if that was not by itself
/// @throws std::invalid_argument for a device that there cannot be
[[nodiscard]] nlohmann::json check_in_process(const CheckDeviceRequest& request);

}  // namespace forcebound::client::commands
