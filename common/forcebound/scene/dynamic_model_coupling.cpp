#include "forcebound/scene/dynamic_model_coupling.hpp"

#include <algorithm>
#include <stdexcept>

namespace forcebound::scene {

double seconds_between(Nanoseconds from, Nanoseconds to) noexcept {
  return std::max(0.0, time::to_seconds(wrapped_difference(to, from)));
}

DynamicModelNow::DynamicModelNow(const SceneDynamicModel& dynamic_model, int seats, bool shared)
    : dynamic_model_(dynamic_model), state_(dynamic_model.dynamic_model->make_state(seats)) {
  if (!shared) return;
  devices_.resize(static_cast<std::size_t>(seats));
  if (dynamic_model.dynamic_model->facts().inputs.time) paths_.resize(static_cast<std::size_t>(seats));
}

int DynamicModelNow::join() {
  const int seat = state_->join();
  const bool has_no_place = !devices_.empty() && seat >= static_cast<int>(devices_.size());
  if (!has_no_place) return seat;
  state_->leave(seat);
  return -1;
}

void DynamicModelNow::leave(int seat) {
  const auto i = static_cast<std::size_t>(seat);
  if (!paths_.empty()) paths_[i].forget();
  if (!devices_.empty()) devices_[i] = {};
  state_->leave(seat);
}

void DynamicModelNow::move_probe(int seat, const Probe& probe, const FeltAt& at) noexcept {
  const std::uint32_t buttons = probe.handle.buttons.value_or(0);
  if (devices_.empty()) {
    state_->press(seat, buttons);
    state_->move(seat, probe.position_m, probe.velocity_m_per_s);
    return;
  }
  const auto i = static_cast<std::size_t>(seat);
  Device& device = devices_[i];
  device.reported_m = probe.position_m.cwiseMax(-DevicePath::kFar_m).cwiseMin(DevicePath::kFar_m);
  device.reported_m_per_s = probe.velocity_m_per_s;
  device.reported_buttons = buttons;
  if (!device.placed) place(i, {device.reported_m, device.reported_m_per_s, buttons});
  const bool goes_by_path = !paths_.empty() && at.reading;
  if (!goes_by_path) {
    if (!paths_.empty()) paths_[i].forget();
    follow(i);
    return;
  }
  DevicePath& path = paths_[i];
  if (!path.begun()) path.place_at(device.at_m);
  path.receive({.position_m = probe.position_m, .read = *at.reading, .arrived = at.moment, .buttons = buttons});
}

void DynamicModelNow::place(std::size_t seat, const DevicePath::Place& place) noexcept {
  devices_[seat].placed = true;
  devices_[seat].at_m = place.position_m;
  state_->press(static_cast<int>(seat), place.buttons);
  state_->move(static_cast<int>(seat), place.position_m, place.velocity_m_per_s);
}

const DevicePath* DynamicModelNow::path_of(int seat) const noexcept {
  if (paths_.empty()) return nullptr;
  const DevicePath& path = paths_[static_cast<std::size_t>(seat)];
  return path.begun() ? &path : nullptr;
}

bool DynamicModelNow::plays() const noexcept { return std::ranges::any_of(paths_, &DevicePath::begun); }

void DynamicModelNow::advance_to(Nanoseconds moment) noexcept {
  if (!begun_) {
    begun_ = true;
    moment_ = moment;
    state_->advance(0);
    return;
  }
  if (!(seconds_between(moment_, moment) > 0)) return;
  if (plays()) {
    play_until(moment);
  } else {
    step_to(moment);
  }
}

/// In whole beats; the rest of the time stays due.
void DynamicModelNow::play_until(Nanoseconds moment) noexcept {
  const std::int64_t beats = (moment - moment_) / kBeat;
  if (beats > kBeatsMost) step_to(moment_ + (beats - kBeatsMost) * kBeat);
  for (std::int64_t left = std::min(beats, kBeatsMost); left > 0; --left) step_to(moment_ + kBeat);
}

void DynamicModelNow::step_to(Nanoseconds moment) noexcept {
  move_devices(moment);
  state_->advance(seconds_between(moment_, moment));
  moment_ = moment;
}

/// To where they are by then.
void DynamicModelNow::move_devices(Nanoseconds moment) noexcept {
  const double more_m = kFollows_m_per_s * seconds_between(moment_, moment);
  for (std::size_t i = 0; i < devices_.size(); ++i) {
    Device& device = devices_[i];
    if (!device.placed) continue;
    device.may_move_m = std::min(device.may_move_m + more_m, std::max(more_m, kFollowsAtOnce_m));
    if (!paths_.empty() && paths_[i].begun()) {
      place(i, paths_[i].play(moment));
    } else {
      follow(i);
    }
  }
}

/// To where it was told to be, as far as it may.
void DynamicModelNow::follow(std::size_t seat) noexcept {
  Device& device = devices_[seat];
  const Point left_m = device.reported_m - device.at_m;
  const double left = left_m.norm();
  if (left > device.may_move_m) {
    const double share = device.may_move_m / left;
    device.may_move_m = 0;
    place(seat, {device.at_m + share * left_m, left_m * (kFollows_m_per_s / left), device.reported_buttons});
  } else {
    device.may_move_m -= left;
    place(seat, {device.reported_m, device.reported_m_per_s, device.reported_buttons});
  }
}

DynamicModelsNow begin_dynamic_models(const Scene& scene, int clients) {
  DynamicModelsNow dynamic_models;
  dynamic_models.reserve(scene.dynamic_models().size());
  for (const SceneDynamicModel& dynamic_model : scene.dynamic_models())
    dynamic_models.push_back(std::make_shared<DynamicModelNow>(dynamic_model, clients, scene.facts().shared));
  return dynamic_models;
}

DynamicModelCoupling::DynamicModelCoupling(std::shared_ptr<DynamicModelNow> now)
    : now_(std::move(now)), seat_(now_->join()) {
  if (seat_ < 0) throw std::logic_error("no seat left in '" + name() + "'");
}

DynamicModelCoupling::~DynamicModelCoupling() {
  if (now_ != nullptr) now_->leave(seat_);
}

ModelTouch DynamicModelCoupling::feel(const Probe& probe, const FeltAt& at, DynamicModelFaults& faults) noexcept {
  DynamicModelState& state = now_->state();
  if (!state.sound()) return {};
  const DynamicModelFaults before = state.faults();
  now_->move_probe(seat_, probe, at);
  now_->advance_to(at.moment);
  const ModelTouch touch = state.touch(seat_);
  const DynamicModelFaults after = state.faults();
  faults.contacts_left_out += after.contacts_left_out - before.contacts_left_out;
  faults.not_converged += after.not_converged - before.not_converged;
  faults.slipped_s += after.slipped_s - before.slipped_s;
  return touch;
}

std::optional<Nanoseconds> DynamicModelCoupling::played_before(Nanoseconds device_time) const noexcept {
  const DevicePath* const path = now_->path_of(seat_);
  if (path == nullptr) return std::nullopt;
  return path->played_before(device_time);
}

}  // namespace forcebound::scene
