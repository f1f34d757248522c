#include "forcebound/server/scene/medium_seat.hpp"

#include <stdexcept>

namespace forcebound::server {

double seconds_between(Nanoseconds from, Nanoseconds to) noexcept {
  const auto elapsed =
      static_cast<std::int64_t>(static_cast<std::uint64_t>(to.count()) - static_cast<std::uint64_t>(from.count()));
  return elapsed > 0 ? static_cast<double>(elapsed) * 1e-9 : 0;
}

void MediumNow::advance_to(Nanoseconds moment) noexcept {
  const double elapsed_s = begun_ ? seconds_between(moment_, moment) : 0;
  if (begun_ && !(elapsed_s > 0)) return;
  begun_ = true;
  moment_ = moment;
  state_->advance(elapsed_s);
}

MediaNow begin_media(const Scene& scene, int clients) {
  MediaNow media;
  media.reserve(scene.media().size());
  for (const SceneMedium& medium : scene.media()) media.push_back(std::make_shared<MediumNow>(medium, clients));
  return media;
}

MediumSeat::MediumSeat(std::shared_ptr<MediumNow> now) : now_(std::move(now)), seat_(now_->state().join()) {
  if (seat_ < 0) throw std::logic_error("no seat left in '" + name() + "'");
}

MediumSeat::~MediumSeat() {
  if (now_ != nullptr) now_->state().leave(seat_);
}

MediumTouch MediumSeat::feel(const Probe& probe, Nanoseconds moment, MediumFaults& faults) noexcept {
  MediumState& state = now_->state();
  if (!state.sound()) return {};
  const MediumFaults before = state.faults();
  state.move(seat_, probe.position_m, probe.velocity_m_per_s);
  now_->advance_to(moment);
  const MediumTouch touch = state.touch(seat_);
  const MediumFaults after = state.faults();
  faults.contacts_left_out += after.contacts_left_out - before.contacts_left_out;
  faults.not_converged += after.not_converged - before.not_converged;
  faults.slipped_s += after.slipped_s - before.slipped_s;
  return touch;
}

}  // namespace forcebound::server
