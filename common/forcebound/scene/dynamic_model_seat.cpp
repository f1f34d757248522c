#include "forcebound/scene/dynamic_model_seat.hpp"

#include <stdexcept>

namespace forcebound::scene {

double seconds_between(Nanoseconds from, Nanoseconds to) noexcept {
  const auto elapsed =
      static_cast<std::int64_t>(static_cast<std::uint64_t>(to.count()) - static_cast<std::uint64_t>(from.count()));
  return elapsed > 0 ? static_cast<double>(elapsed) * 1e-9 : 0;
}

void DynamicModelNow::advance_to(Nanoseconds moment) noexcept {
  const double elapsed_s = begun_ ? seconds_between(moment_, moment) : 0;
  if (begun_ && !(elapsed_s > 0)) return;
  begun_ = true;
  moment_ = moment;
  state_->advance(elapsed_s);
}

DynamicModelsNow begin_dynamic_models(const Scene& scene, int clients) {
  DynamicModelsNow dynamic_models;
  dynamic_models.reserve(scene.dynamic_models().size());
  for (const SceneDynamicModel& dynamic_model : scene.dynamic_models())
    dynamic_models.push_back(std::make_shared<DynamicModelNow>(dynamic_model, clients));
  return dynamic_models;
}

DynamicModelSeat::DynamicModelSeat(std::shared_ptr<DynamicModelNow> now)
    : now_(std::move(now)), seat_(now_->state().join()) {
  if (seat_ < 0) throw std::logic_error("no seat left in '" + name() + "'");
}

DynamicModelSeat::~DynamicModelSeat() {
  if (now_ != nullptr) now_->state().leave(seat_);
}

ModelTouch DynamicModelSeat::feel(const Probe& probe, Nanoseconds moment, DynamicModelFaults& faults) noexcept {
  DynamicModelState& state = now_->state();
  if (!state.sound()) return {};
  const DynamicModelFaults before = state.faults();
  state.move(seat_, probe.position_m, probe.velocity_m_per_s);
  now_->advance_to(moment);
  const ModelTouch touch = state.touch(seat_);
  const DynamicModelFaults after = state.faults();
  faults.contacts_left_out += after.contacts_left_out - before.contacts_left_out;
  faults.not_converged += after.not_converged - before.not_converged;
  faults.slipped_s += after.slipped_s - before.slipped_s;
  return touch;
}

}  // namespace forcebound::scene
