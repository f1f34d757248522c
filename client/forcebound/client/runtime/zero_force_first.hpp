#pragma once

#include "forcebound/client/session/session.hpp"
#include "forcebound/control/assertion.hpp"
#include "forcebound/device/haptic_device.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::client {

/// A client's reaction to a failed assertion: zero force first, then the message.
class ZeroForceFirst final : public control::LastResort {
 public:
  /// All must outlive it.
  ZeroForceFirst(device::HapticDevice& device, const Session& session, const time::Clock& clock, std::uint64_t seed)
      : device_(device), session_(session), clock_(clock), seed_(seed) {}

  void make_safe() noexcept override { device_.stop(clock_.now()); }

  /// "state active, seed 7"
  [[nodiscard]] std::size_t describe(std::span<char> words) const noexcept override;

 private:
  device::HapticDevice& device_;
  const Session& session_;
  const time::Clock& clock_;
  std::uint64_t seed_;
};

}  // namespace forcebound::client
