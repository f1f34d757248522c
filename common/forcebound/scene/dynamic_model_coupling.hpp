#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "forcebound/scene/device_path.hpp"
#include "forcebound/scene/scene.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::scene {

using time::Nanoseconds;

/// Time from one to the other; zero where that is negative. Wraps around where an untrusted client's times lie further
/// apart than 64 bits hold.
double seconds_between(Nanoseconds from, Nanoseconds to) noexcept;

/// When a probe was where it is, and until when time goes on.
struct FeltAt {
  Nanoseconds moment{0};                 ///< of the model's clock
  std::optional<Nanoseconds> reading{};  ///< of the device's clock, to play its path by, where the model plays paths
};

/// A dynamic model of a scene with its current state and time: of one client, or of all clients of a shared scene.
///
/// Of one client it follows the device's own clock: between two motions the device went straight. Of several the clock
/// is the server's, and motions come when their networks let them. Where what moves has a time of its own (bodies, not
/// tissue, which is quasi-static), the paths of all devices can therefore be played (DevicePath), in beats of a
/// millisecond: each beat moves every device whose path is played to where it was, and the model steps by that. A
/// motion thus moves its device in the model later than it came, by about the jitter on its way. A device whose path is
/// not played goes to where it is at 2 m/s at most, so that nobody's hand is struck by somebody else's jump.
class DynamicModelNow {
 public:
  /// How far all devices go at once; what is due beyond eight of them is gone in one.
  static constexpr Nanoseconds kBeat = std::chrono::milliseconds{1};
  static constexpr std::int64_t kBeatsMost = 8;
  static constexpr double kFollows_m_per_s = 2;
  static constexpr double kFollowsAtOnce_m = 0.004;  ///< without time going on

  /// @param dynamic_model must outlive this
  /// @param shared the clock is the server's, and paths can be played; else it is the one device's
  DynamicModelNow(const SceneDynamicModel& dynamic_model, int seats, bool shared = false);

  /// A seat for one more probe; -1 if all are taken.
  [[nodiscard]] int join();
  void leave(int seat);

  /// The probe's device was there: at once, in a shared model as far as its speed allows, or when its path is played as
  /// far. Real time.
  void move_probe(int seat, const Probe& probe, const FeltAt& at) noexcept;

  /// Real time. The first call sets the start; a time that is not later than the last one changes nothing.
  void advance_to(Nanoseconds moment) noexcept;

  /// The path that is played; null: it is not.
  [[nodiscard]] const DevicePath* path_of(int seat) const noexcept;

  [[nodiscard]] DynamicModelState& state() noexcept { return *state_; }
  [[nodiscard]] const SceneDynamicModel& dynamic_model() const noexcept { return dynamic_model_; }

 private:
  /// A device in a shared model.
  struct Device {
    bool placed = false;
    Point reported_m = Point::Zero();
    Point reported_m_per_s = Point::Zero();
    std::uint32_t reported_buttons = 0;
    Point at_m = Point::Zero();  ///< in the model
    double may_move_m = 0;
  };

  [[nodiscard]] bool plays() const noexcept;
  void place(std::size_t seat, const DevicePath::Place& place) noexcept;
  void follow(std::size_t seat) noexcept;
  void move_devices(Nanoseconds moment) noexcept;
  void play_until(Nanoseconds moment) noexcept;
  void step_to(Nanoseconds moment) noexcept;

  const SceneDynamicModel& dynamic_model_;
  std::unique_ptr<DynamicModelState> state_;
  std::vector<Device> devices_;    ///< of all seats; empty: not shared
  std::vector<DevicePath> paths_;  ///< of all seats; empty: none can be played
  Nanoseconds moment_{0};
  bool begun_ = false;
};

/// All dynamic models of a scene, in its order.
using DynamicModelsNow = std::vector<std::shared_ptr<DynamicModelNow>>;

/// For that number of clients. @param scene must outlive them
DynamicModelsNow begin_dynamic_models(const Scene& scene, int clients);

/// Couples one client's probe to a dynamic model, for the lifetime of this object.
class DynamicModelCoupling {
 public:
  /// @throws std::logic_error if all seats are taken
  explicit DynamicModelCoupling(std::shared_ptr<DynamicModelNow> now);
  ~DynamicModelCoupling();
  DynamicModelCoupling(DynamicModelCoupling&& other) noexcept = default;
  DynamicModelCoupling& operator=(DynamicModelCoupling&&) = delete;
  DynamicModelCoupling(const DynamicModelCoupling&) = delete;
  DynamicModelCoupling& operator=(const DynamicModelCoupling&) = delete;

  /// Moves the probe, advances time, and returns the force then. Real time: no allocation.
  /// @param faults faults since the last call are added
  [[nodiscard]] ModelTouch feel(const Probe& probe, const FeltAt& at, DynamicModelFaults& faults) noexcept;

  /// How long before a time of the device's clock the probe was where it is now in the model; none: it was moved there
  /// as its motion came. Real time.
  [[nodiscard]] std::optional<Nanoseconds> played_before(Nanoseconds device_time) const noexcept;

  /// A local model of what was felt last; see DynamicModelState::describe. Real time.
  [[nodiscard]] bool describe(local_model::LocalModel& model) noexcept { return now_->state().describe(seat_, model); }

  [[nodiscard]] bool sound() const noexcept { return now_->state().sound(); }
  [[nodiscard]] const std::string& name() const noexcept { return now_->dynamic_model().name; }
  [[nodiscard]] const std::shared_ptr<DynamicModelNow>& now() const noexcept { return now_; }

 private:
  std::shared_ptr<DynamicModelNow> now_;
  int seat_;
};

}  // namespace forcebound::scene
