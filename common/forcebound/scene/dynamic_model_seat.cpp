#include "forcebound/scene/dynamic_model_seat.hpp"

#include <algorithm>
#include <stdexcept>

namespace forcebound::scene {

double seconds_between(Nanoseconds from, Nanoseconds to) noexcept {
  return std::max(0.0, time::to_seconds(wrapped_difference(to, from)));
}

DynamicModelNow::DynamicModelNow(const SceneDynamicModel& dynamic_model, int seats, bool shared)
    : dynamic_model_(dynamic_model), state_(dynamic_model.dynamic_model->make_state(seats)) {
  if (shared && dynamic_model.dynamic_model->facts().inputs.time) paths_.resize(static_cast<std::size_t>(seats));
}

int DynamicModelNow::join() {
  const int seat = state_->join();
  const bool has_no_path = !paths_.empty() && seat >= static_cast<int>(paths_.size());
  if (!has_no_path) return seat;
  state_->leave(seat);
  return -1;
}

void DynamicModelNow::leave(int seat) {
  if (!paths_.empty()) paths_[static_cast<std::size_t>(seat)].forget();
  state_->leave(seat);
}

void DynamicModelNow::take(int seat, const Probe& probe, const FeltAt& at) noexcept {
  if (paths_.empty()) {
    state_->move(seat, probe.position_m, probe.velocity_m_per_s);
    return;
  }
  DevicePath& path = paths_[static_cast<std::size_t>(seat)];
  if (!at.reading) path.forget();
  // Also with a path, a probe needs a place to begin at.
  if (!path.begun()) state_->move(seat, probe.position_m, probe.velocity_m_per_s);
  if (at.reading) path.note({.position_m = probe.position_m, .read = *at.reading, .arrived = at.moment});
}

const DevicePath* DynamicModelNow::path_of(int seat) const noexcept {
  if (paths_.empty()) return nullptr;
  const DevicePath& path = paths_[static_cast<std::size_t>(seat)];
  return path.begun() ? &path : nullptr;
}

bool DynamicModelNow::plays() const noexcept { return std::ranges::any_of(paths_, &DevicePath::begun); }

void DynamicModelNow::advance_to(Nanoseconds moment) noexcept {
  const double elapsed_s = begun_ ? seconds_between(moment_, moment) : 0;
  if (begun_ && !(elapsed_s > 0)) return;
  if (begun_ && plays()) {
    play_until(moment);
    return;
  }
  begun_ = true;
  moment_ = moment;
  state_->advance(elapsed_s);
}

/// In whole beats; the rest of the time stays due.
void DynamicModelNow::play_until(Nanoseconds moment) noexcept {
  const std::int64_t beats = (moment - moment_) / kBeat;
  if (beats > kBeatsMost) step_to(moment_ + (beats - kBeatsMost) * kBeat);
  for (std::int64_t left = std::min(beats, kBeatsMost); left > 0; --left) step_to(moment_ + kBeat);
}

void DynamicModelNow::step_to(Nanoseconds moment) noexcept {
  for (std::size_t i = 0; i < paths_.size(); ++i) {
    if (!paths_[i].begun()) continue;
    const DevicePath::Place& place = paths_[i].play(moment);
    state_->move(static_cast<int>(i), place.position_m, place.velocity_m_per_s);
  }
  state_->advance(time::to_seconds(moment - moment_));
  moment_ = moment;
}

DynamicModelsNow begin_dynamic_models(const Scene& scene, int clients) {
  DynamicModelsNow dynamic_models;
  dynamic_models.reserve(scene.dynamic_models().size());
  for (const SceneDynamicModel& dynamic_model : scene.dynamic_models())
    dynamic_models.push_back(std::make_shared<DynamicModelNow>(dynamic_model, clients, scene.facts().shared));
  return dynamic_models;
}

DynamicModelSeat::DynamicModelSeat(std::shared_ptr<DynamicModelNow> now) : now_(std::move(now)), seat_(now_->join()) {
  if (seat_ < 0) throw std::logic_error("no seat left in '" + name() + "'");
}

DynamicModelSeat::~DynamicModelSeat() {
  if (now_ != nullptr) now_->leave(seat_);
}

ModelTouch DynamicModelSeat::feel(const Probe& probe, const FeltAt& at, DynamicModelFaults& faults) noexcept {
  DynamicModelState& state = now_->state();
  if (!state.sound()) return {};
  const DynamicModelFaults before = state.faults();
  now_->take(seat_, probe, at);
  now_->advance_to(at.moment);
  const ModelTouch touch = state.touch(seat_);
  const DynamicModelFaults after = state.faults();
  faults.contacts_left_out += after.contacts_left_out - before.contacts_left_out;
  faults.not_converged += after.not_converged - before.not_converged;
  faults.slipped_s += after.slipped_s - before.slipped_s;
  return touch;
}

std::optional<Nanoseconds> DynamicModelSeat::played_before(Nanoseconds device_time) const noexcept {
  const DevicePath* const path = now_->path_of(seat_);
  if (path == nullptr) return std::nullopt;
  return path->played_before(device_time);
}

}  // namespace forcebound::scene
