#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "forcebound/client/commands/identify/encoder_grid.hpp"
#include "forcebound/client/commands/identify/joint_control.hpp"
#include "forcebound/client/commands/identify/release_fit.hpp"
#include "forcebound/client/commands/identify/slide.hpp"
#include "forcebound/control/device_facts.hpp"
#include "forcebound/device/haptic_device.hpp"

namespace forcebound::client::commands::identify {

using control::Matrix;
using control::Vector;

struct GuideSettings {
  double force_share = 0.3;        ///< of the device's largest force
  double speed_m_per_s_max = 0.5;  ///< of the tip: where it is faster, the slide is given up
  double radius_m = 0.03;          ///< the tip stays about so near to where it was at the beginning
  std::uint64_t seed = 1;          ///< of the places where slides begin
};

/// What the readings at rest and in motion say of the encoders.
struct ReadingFacts {
  std::uint64_t ticks = 0;
  std::uint64_t failed = 0;
  std::uint64_t stale = 0;             ///< said so by the device
  std::uint64_t late = 0;              ///< ticks
  std::uint64_t late_slides = 0;       ///< given up and repeated because of one
  std::uint64_t fast = 0;              ///< ticks in fast motion
  std::uint64_t repeated = 0;          ///< of them with the reading of the tick before
  double rest_steps = 0;               ///< how far readings went apart at rest, before any force
  std::vector<double> encoder_step{};  ///< of each joint, 0: none found
};

/// "axis 2", "joint 2".
[[nodiscard]] std::string joint_name(int joint, bool cartesian);

/// Moves a device through all that is to be measured. One joint after another: a force that grows until the joint
/// moves, then slides to and fro, each a constant force from rest, let go in mid-motion; the other joints are held.
///
///     rest -- for each joint: force grows -- slides: place, push, coast -- more slides for the times
///
/// Every force grows in a ramp, to the largest of its joint in 30 ms. It ends in a step: that of a slide's constant
/// force to zero is what latency and hold time are read from. A button, a tip that is too fast or too far away and
/// readings that fail for a second end all of it; a late tick, during which a device may have let go, repeats the
/// slide.
///
/// Decides from readings and times that it is given, nothing else. Not for a law's tick: it may allocate.
class Guide {
 public:
  /// @param declared what is known already: degrees of freedom, largest force, period
  Guide(const control::DeviceFacts& declared, const GuideSettings& settings);

  /// @param commanded_s when the returned force will be commanded, by the clock of `reading.latched`
  /// @returns the tip force to command now [N]; nothing: command nothing at all
  std::optional<Vector> tick(const device::Reading& reading, double commanded_s);

  /// Fits that take longer than a tick. The caller runs them while it goes on ticking, on any thread, or at once; the
  /// guide holds the joints meanwhile. Empty: there is nothing to do.
  [[nodiscard]] std::function<void()> take_work();

  [[nodiscard]] bool done() const noexcept { return state_ == State::finished || !trouble_.empty(); }
  /// Why it ended early; empty: it did not.
  [[nodiscard]] const std::string& trouble() const noexcept { return trouble_; }
  /// Whether that was a button of the device.
  [[nodiscard]] bool stopped_by_button() const noexcept { return stopped_by_button_; }
  /// Share done, about, and what it is doing.
  [[nodiscard]] double share() const noexcept;
  [[nodiscard]] std::string doing() const;

  /// What was measured at each joint. A joint without slides has its reason.
  struct JointRecord {
    std::vector<Slide> slides{};
    double break_away = 0;  ///< force at which it began to move [N], [N m]
    JointGuess guess{};
    std::string refused{};
  };
  [[nodiscard]] const std::vector<JointRecord>& joints() const noexcept { return records_; }
  [[nodiscard]] ReadingFacts readings() const;
  /// The largest tip force that was commanded [N].
  [[nodiscard]] double force_N_most() const noexcept { return force_N_most_; }

 private:
  enum class State : std::uint8_t { rest, grow, first_push, place, push, coast, wait, finished };
  enum class Work : std::uint8_t { refit, times };
  struct Plan {
    double speed_share = 1;
    bool silent = false;
    bool short_way = false;
  };
  struct Fitted {
    std::optional<JointGuess> guess{};
    int joint = -1;            ///< that tells the times best
    double latency_share = 0;  ///< its standard errors, over those that are sought
    double hold_share = 0;
  };
  struct Axis {
    double home = 0;
    double reach = 0;  ///< range of slides on each side of home
    double speed_max = 0;
    double force_max = 0;  ///< for it alone
    JointWatch watch{};
    EncoderGrid grid{};
  };

  void begin(const device::Reading& reading);
  void watch(const device::Reading& reading, double latched_s);
  void enter(State state) noexcept;
  void fail(const std::string& why) {
    if (trouble_.empty()) trouble_ = why;
  }
  void heed_buttons(const control::Handle& handle);
  void heed_late_tick();
  void heed_limits(const Matrix& jacobian);
  void unusable_tick(double commanded_s);
  void torque_of_state(Vector& torque, const Vector& joint);
  [[nodiscard]] bool sliding() const noexcept { return state_ == State::push || state_ == State::coast; }
  [[nodiscard]] double risen(int joint, double wanted) const noexcept;
  [[nodiscard]] std::optional<Vector> force_of(const Vector& torque, const Matrix& jacobian);
  [[nodiscard]] Vector held() const noexcept;
  void rest_tick();
  void grow_tick(Vector& torque);
  void first_push_tick(Vector& torque);
  void place_tick(Vector& torque);
  void push_tick(Vector& torque);
  void coast_tick(Vector& torque);
  void wait_tick(Vector& torque);
  [[nodiscard]] int some_ticks();
  void begin_push();
  void end_slide();
  void begin_work(Work work);
  [[nodiscard]] Fitted refitted() const;
  [[nodiscard]] Fitted best_for_times() const;
  void plan_joint();
  void next_slide();
  void next_joint();
  void plan_more();
  void give_up_joint(const std::string& why);
  [[nodiscard]] double fastest() const noexcept;
  [[nodiscard]] double step() const noexcept { return axis().grid.step().value_or(0); }
  [[nodiscard]] Axis& axis() noexcept { return axes_[static_cast<std::size_t>(joint_)]; }
  [[nodiscard]] const Axis& axis() const noexcept { return axes_[static_cast<std::size_t>(joint_)]; }
  [[nodiscard]] JointRecord& record() noexcept { return records_[static_cast<std::size_t>(joint_)]; }
  [[nodiscard]] const JointRecord& record() const noexcept { return records_[static_cast<std::size_t>(joint_)]; }
  [[nodiscard]] double progress() const noexcept { return slide_.direction * (axis().watch.position() - start_); }
  [[nodiscard]] double speed() const noexcept { return slide_.direction * axis().watch.speed(); }

  control::DeviceFacts declared_;
  GuideSettings settings_;
  std::mt19937_64 random_;
  State state_ = State::rest;
  std::string trouble_;
  std::vector<Axis> axes_;
  std::vector<JointRecord> records_;
  ReadingFacts readings_;
  Vector rest_low_;
  Vector rest_high_;
  Vector last_joint_;
  double force_N_most_ = 0;
  Vector torque_last_;  ///< of each joint
  std::optional<std::uint32_t> buttons_ignored_{};
  bool stopped_by_button_ = false;

  Work work_ = Work::refit;
  bool work_taken_ = false;
  std::vector<double> work_steps_{};    ///< encoder step of each joint, as known when the work began
  std::atomic<bool> work_done_{false};  ///< by whoever took it
  Fitted fitted_;                       ///< read once it is done

  int joint_ = 0;
  double now_s_ = 0;  ///< of the reading
  double commanded_s_ = 0;
  double since_s_ = 0;  ///< when the state began
  double failed_since_s_ = -1;
  double slow_s_ = 0;  ///< when the tip was last slow enough
  double still_since_s_ = 0;
  double moved_since_s_ = 0;  ///< progress while pushing
  double moved_to_ = 0;

  std::vector<Plan> plan_;
  std::size_t planned_ = 0;
  int extra_joint_ = -1;  ///< more slides for the times: only once all joints are done
  int extra_ = 0;
  bool refit_due_ = false;
  bool joint_done_ = false;  ///< once it rests
  int unmoved_ = 0;          ///< slides in a row
  int trips_ = 0;

  Slide slide_;
  Plan now_;
  double start_ = 0;
  double planned_start_ = 0;
  double travel_ = 0;
  int release_in_ = -1;     ///< ticks, once it is decided
  int end_in_ = -1;         ///< likewise the slide's end
  int constant_ticks_ = 0;  ///< of the push so far, with the same force
  double target_speed_ = 0;
  double push_force_ = 0;
  double release_speed_ = 0;
};

}  // namespace forcebound::client::commands::identify
