#pragma once

#include <optional>
#include <string>

#include "forcebound/net/udp_link.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::server {

/// What this process and the service manager that started it (systemd) tell each other: sd_listen_fds(3), sd_notify(3),
/// sd_watchdog_enabled(3). Where nobody did, nothing is told and nothing is there.
class ServiceManager {
 public:
  ServiceManager();

  /// Whether it is there.
  [[nodiscard]] static bool started_this() noexcept;

  /// The socket that the service manager has bound for this process. To be called once.
  /// @throws std::runtime_error if it handed over several, or something else
  [[nodiscard]] static std::optional<net::UdpLink> take_socket();

  /// The service works. @param status for people, in one line
  static void report_ready(const std::string& status);
  static void report_reloading();
  static void report_stopping(const std::string& status);

  /// The loop runs; told to the watchdog, if there is one, as often as it wants.
  void report_alive(time::Nanoseconds now);

 private:
  time::Nanoseconds alive_period_{0};  ///< 0: no watchdog
  time::Nanoseconds next_alive_{0};
};

}  // namespace forcebound::server
