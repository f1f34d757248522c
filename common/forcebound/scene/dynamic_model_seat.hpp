#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "forcebound/scene/scene.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::scene {

using time::Nanoseconds;

/// Time from one to the other; zero where that is negative. Wraps around where an untrusted client's times lie further
/// apart than 64 bits hold.
double seconds_between(Nanoseconds from, Nanoseconds to) noexcept;

/// A dynamic model of a scene with its current state and time: of one client, or of all clients of a shared scene.
class DynamicModelNow {
 public:
  /// @param dynamic_model must outlive this
  DynamicModelNow(const SceneDynamicModel& dynamic_model, int seats)
      : dynamic_model_(dynamic_model), state_(dynamic_model.dynamic_model->make_state(seats)) {}

  /// Real time. The first call sets the start; a time that is not later than the last one changes nothing.
  void advance_to(Nanoseconds moment) noexcept;

  [[nodiscard]] DynamicModelState& state() noexcept { return *state_; }
  [[nodiscard]] const SceneDynamicModel& dynamic_model() const noexcept { return dynamic_model_; }

 private:
  const SceneDynamicModel& dynamic_model_;
  std::unique_ptr<DynamicModelState> state_;
  Nanoseconds moment_{0};
  bool begun_ = false;
};

/// All dynamic models of a scene, in its order.
using DynamicModelsNow = std::vector<std::shared_ptr<DynamicModelNow>>;

/// For that number of clients. @param scene must outlive them
DynamicModelsNow begin_dynamic_models(const Scene& scene, int clients);

/// One client's probe in a dynamic model, for the lifetime of this object.
class DynamicModelSeat {
 public:
  /// @throws std::logic_error if all seats are taken
  explicit DynamicModelSeat(std::shared_ptr<DynamicModelNow> now);
  ~DynamicModelSeat();
  DynamicModelSeat(DynamicModelSeat&& other) noexcept = default;
  DynamicModelSeat& operator=(DynamicModelSeat&&) = delete;
  DynamicModelSeat(const DynamicModelSeat&) = delete;
  DynamicModelSeat& operator=(const DynamicModelSeat&) = delete;

  /// Moves the probe, advances time to `moment`, and returns the force then. Real time: no allocation.
  /// @param faults faults since the last call are added
  [[nodiscard]] ModelTouch feel(const Probe& probe, Nanoseconds moment, DynamicModelFaults& faults) noexcept;

  [[nodiscard]] bool sound() const noexcept { return now_->state().sound(); }
  [[nodiscard]] const std::string& name() const noexcept { return now_->dynamic_model().name; }
  [[nodiscard]] const std::shared_ptr<DynamicModelNow>& now() const noexcept { return now_; }

 private:
  std::shared_ptr<DynamicModelNow> now_;
  int seat_;
};

}  // namespace forcebound::scene
