#pragma once

#include "forcebound/control/law.hpp"

namespace forcebound::control {

/// The part of a law that runs at the server: stands between the motions that come and the environment.
///
/// For each motion that is answered, in the order of their sequence: `place`, then the environment is asked there, then
/// `answer`. Motions get lost, so an interval may span several ticks. Whatever parameters both ends must share come
/// with the device's numbers, so that the server needs to be told nothing. A server-side law may begin in the middle of
/// its law's life, after a restart of the server: it takes the first sums it hears as where it begins.
///
/// Real time: noexcept, no allocation, O(dof). Not thread-safe.
class ServerSideLaw {
 public:
  virtual ~ServerSideLaw() = default;

  struct Received {
    const Vector& position;           ///< of the device [m]
    const ServerLawNumbers& numbers;  ///< from the law at the device; any finite numbers, of any count
    double interval_s;                ///< by the device's clock since the motion before; 0 at first
  };

  struct Reply {
    Vector force;              ///< [N] for the law at the device, `dof` rows
    ServerLawNumbers numbers;  ///< for the law at the device
  };

  /// Where the environment is to be asked [m], `dof` rows.
  [[nodiscard]] virtual Vector place(const Received& received) noexcept = 0;

  /// @param force_N what the environment answered there
  [[nodiscard]] virtual Reply answer(const Vector& force_N) noexcept = 0;
};

}  // namespace forcebound::control
