#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "forcebound/server/scene/scene.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::server {

using time::Nanoseconds;

/// From one time to another; zero where that is not later. Wrapped around where a stranger's times lie further apart
/// than 64 bits hold.
double seconds_between(Nanoseconds from, Nanoseconds to) noexcept;

/// A medium of a scene as it is now, with the moment that is: of one client, or of all in a shared scene.
class MediumNow {
 public:
  /// @param medium must outlive this
  MediumNow(const SceneMedium& medium, int seats) : medium_(medium), state_(medium.medium->make_state(seats)) {}

  /// Real time. The first moment begins; one that is not later than the last changes nothing.
  void advance_to(Nanoseconds moment) noexcept;

  [[nodiscard]] MediumState& state() noexcept { return *state_; }
  [[nodiscard]] const SceneMedium& medium() const noexcept { return medium_; }

 private:
  const SceneMedium& medium_;
  std::unique_ptr<MediumState> state_;
  Nanoseconds moment_{0};
  bool begun_ = false;
};

/// All media of a scene, in its order.
using MediaNow = std::vector<std::shared_ptr<MediumNow>>;

/// For so many clients. @param scene must outlive them
MediaNow begin_media(const Scene& scene, int clients);

/// One client's probe in a medium, as long as this lives.
class MediumSeat {
 public:
  /// @throws std::logic_error if all seats are taken
  explicit MediumSeat(std::shared_ptr<MediumNow> now);
  ~MediumSeat();
  MediumSeat(MediumSeat&& other) noexcept = default;
  MediumSeat& operator=(MediumSeat&&) = delete;
  MediumSeat(const MediumSeat&) = delete;
  MediumSeat& operator=(const MediumSeat&) = delete;

  /// Moves the probe, lets time pass up to a moment, and asks what is felt then. Real time: no allocation.
  /// @param faults what went wrong meanwhile is added
  [[nodiscard]] MediumTouch feel(const Probe& probe, Nanoseconds moment, MediumFaults& faults) noexcept;

  [[nodiscard]] bool sound() const noexcept { return now_->state().sound(); }
  [[nodiscard]] const std::string& name() const noexcept { return now_->medium().name; }
  [[nodiscard]] const std::shared_ptr<MediumNow>& now() const noexcept { return now_; }

 private:
  std::shared_ptr<MediumNow> now_;
  int seat_;
};

}  // namespace forcebound::server
