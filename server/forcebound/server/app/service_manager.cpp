#include "forcebound/server/app/service_manager.hpp"

#include <systemd/sd-daemon.h>

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <stdexcept>

namespace forcebound::server {

ServiceManager::ServiceManager() {
  std::uint64_t watchdog_us = 0;
  // A third of it: two may be late.
  if (sd_watchdog_enabled(0, &watchdog_us) > 0) alive_period_ = std::chrono::microseconds(watchdog_us / 3);
}

bool ServiceManager::started_this() noexcept { return std::getenv("NOTIFY_SOCKET") != nullptr; }

std::optional<net::UdpLink> ServiceManager::take_socket() {
  const int sockets = sd_listen_fds(1);
  if (sockets <= 0) return std::nullopt;
  if (sockets > 1) {
    throw std::runtime_error("the service manager handed over " + std::to_string(sockets) +
                             " sockets; accepted is one, ListenDatagram=HOST:PORT");
  }
  return net::UdpLink::adopt(SD_LISTEN_FDS_START, net::UdpLink::Stamps::left_out);
}

void ServiceManager::report_ready(const std::string& status) { sd_notify(0, ("READY=1\nSTATUS=" + status).c_str()); }

void ServiceManager::report_reloading() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  const auto us = static_cast<long long>(now.tv_sec) * 1'000'000 + now.tv_nsec / 1000;
  sd_notify(0, ("RELOADING=1\nMONOTONIC_USEC=" + std::to_string(us)).c_str());
}

void ServiceManager::report_stopping(const std::string& status) {
  sd_notify(0, ("STOPPING=1\nSTATUS=" + status).c_str());
}

void ServiceManager::report_alive(time::Nanoseconds now) {
  if (alive_period_ == time::Nanoseconds{0} || now < next_alive_) return;
  next_alive_ = now + alive_period_;
  sd_notify(0, "WATCHDOG=1");
}

}  // namespace forcebound::server
