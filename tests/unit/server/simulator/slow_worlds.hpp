#pragma once

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <utility>

#include "forcebound/server/simulator/simulator_environment.hpp"

namespace forcebound::server {

/// A simulator under test, which steps by itself. A hand comes from where z is above what it touches.
class SlowWorld {
 public:
  virtual ~SlowWorld() = default;
  struct Pushed {
    Point place_m = Point::Zero();  ///< that was told of
    Point force_N = Point::Zero();
  };
  virtual void step(double step_s, const Pushed& pushed) = 0;
  /// Where a probe there meets it.
  [[nodiscard]] virtual Touch touch(const Point& probe_m) const = 0;
};

/// Stands at z = 0.
class SlowWall final : public SlowWorld {
 public:
  void step(double /*step_s*/, const Pushed& /*pushed*/) override {}
  [[nodiscard]] Touch touch(const Point& probe_m) const override {
    return {.place_m = {probe_m.x(), probe_m.y(), 0}, .normal = Point::UnitZ(), .friction = 0.3};
  }
};

/// A box that is pushed along -z on a table, with dry friction.
class SlowSled final : public SlowWorld {
 public:
  explicit SlowSled(double mass_kg = 0.6, double dry_N = 1.8) : mass_kg_(mass_kg), dry_N_(dry_N) {}

  void step(double step_s, const Pushed& pushed) override {
    const double free = speed_m_per_s_ + step_s * pushed.force_N.z() / mass_kg_;
    const double rubbed = std::min(std::abs(free), step_s * dry_N_ / mass_kg_);
    speed_m_per_s_ = free - std::copysign(rubbed, free);
    face_m_ += step_s * speed_m_per_s_;
  }
  [[nodiscard]] Touch touch(const Point& probe_m) const override {
    Touch touch{.place_m = {probe_m.x(), probe_m.y(), face_m_},
                .normal = Point::UnitZ(),
                .velocity_m_per_s = {0, 0, speed_m_per_s_},
                .dry_friction_N = dry_N_};
    touch.mobility_per_kg(2, 2) = 1 / mass_kg_;
    return touch;
  }
  [[nodiscard]] double momentum_Ns() const { return mass_kg_ * speed_m_per_s_; }

 private:
  double mass_kg_;
  double dry_N_;
  double face_m_ = 0;
  double speed_m_per_s_ = 0;
};

/// A column of six masses of 10 g on springs of 3000 N/m, which its own solver steps at the step's end; it tells what
/// its top gives way by: the spring of all of it, and the mass that moves with the top.
class SlowColumn final : public SlowWorld {
 public:
  void step(double step_s, const Pushed& pushed) override {
    using Square = Eigen::Matrix<double, kNodes, kNodes>;
    Square stiffness = Square::Zero();
    for (int i = 0; i < kNodes; ++i) {
      stiffness(i, i) += kSpring_N_per_m;
      if (i + 1 == kNodes) continue;
      stiffness(i, i) += kSpring_N_per_m;
      stiffness(i, i + 1) = stiffness(i + 1, i) = -kSpring_N_per_m;
    }
    const Square damping = kDamping_s * stiffness;
    Nodes force_N = -stiffness * (moved_m_ + step_s * speed_m_per_s_) - damping * speed_m_per_s_;
    force_N[kNodes - 1] += pushed.force_N.z();
    const Square effective = kMass_kg * Square::Identity() + step_s * damping + step_s * step_s * stiffness;
    speed_m_per_s_ += step_s * effective.inverse() * force_N;
    moved_m_ += step_s * speed_m_per_s_;
  }
  [[nodiscard]] Touch touch(const Point& probe_m) const override {
    constexpr double kAll_N_per_m = kSpring_N_per_m / kNodes;
    const double top_m = moved_m_[kNodes - 1];
    Touch touch{.place_m = {probe_m.x(), probe_m.y(), top_m},
                .normal = Point::UnitZ(),
                .velocity_m_per_s = {0, 0, speed_m_per_s_[kNodes - 1]},
                .others_N = {0, 0, -kAll_N_per_m * top_m},
                .spring_N_per_m = kAll_N_per_m,
                .damper_N_s_per_m = kDamping_s * kAll_N_per_m};
    touch.mobility_per_kg(2, 2) = 3 / (kNodes * kMass_kg);
    return touch;
  }

 private:
  static constexpr int kNodes = 6;
  static constexpr double kMass_kg = 0.01;
  static constexpr double kSpring_N_per_m = 3000;
  static constexpr double kDamping_s = 0.01;
  using Nodes = Eigen::Matrix<double, kNodes, 1>;
  Nodes moved_m_ = Nodes::Zero();
  Nodes speed_m_per_s_ = Nodes::Zero();
};

/// The steps of a simulator, in the time of the motions that come.
class Beats {
 public:
  explicit Beats(double step_s) : step_s_(step_s) {}

  [[nodiscard]] double step_s() const { return step_s_; }

  template <class Step>
  void until(Nanoseconds now, const Step& step) {
    if (!begun_) next_ = now;
    begun_ = true;
    for (; now >= next_; next_ += time::from_seconds(step_s_)) step();
  }

 private:
  double step_s_;
  bool begun_ = false;
  Nanoseconds next_{0};
};

/// Steps a world in the time of the motions that come, each step's report being there when the next step begins: as of
/// a simulator that is busy all the time.
class SteppedBeside final : public Environment {
 public:
  SteppedBeside(std::unique_ptr<Environment> felt, std::shared_ptr<Simulator> simulator,
                std::shared_ptr<SlowWorld> world, double step_s)
      : felt_(std::move(felt)), simulator_(std::move(simulator)), world_(std::move(world)), beats_(step_s) {}

  Answer respond(const Motion& motion) noexcept override {
    beats_.until(motion.server_time, [&] { step(); });
    return felt_->respond(motion);
  }

 private:
  void step() {
    if (asked_.client != 0) (void)simulator_->report(asked_.client, std::array{world_->touch(asked_.place_m)});
    if (simulator_->probes({&asked_, 1}) == 0) return;
    SlowWorld::Pushed pushed;
    for (const Simulator::Push& push : std::span(asked_.pushes).first(asked_.push_count)) {
      pushed.place_m = push.place_m;
      pushed.force_N += push.impulse_Ns / beats_.step_s();
    }
    world_->step(beats_.step_s(), pushed);
  }

  std::unique_ptr<Environment> felt_;
  std::shared_ptr<Simulator> simulator_;
  std::shared_ptr<SlowWorld> world_;
  Beats beats_;
  Simulator::Probe asked_{};
};

/// What people do without: a spring to the surface, whose force is worked out at each step and held until the next.
class HeldBeside final : public Environment {
 public:
  HeldBeside(std::shared_ptr<SlowWorld> world, double step_s) : world_(std::move(world)), beats_(step_s) {}

  Answer respond(const Motion& motion) noexcept override {
    beats_.until(motion.server_time, [&] {
      const Touch touch = world_->touch(motion.position);
      const double depth_m = touch.place_m.z() - motion.position.z();
      pushed_N_ = std::max(0.0, ProbeFacts{}.stiffness_N_per_m * depth_m);
      world_->step(beats_.step_s(), {.place_m = touch.place_m, .force_N = {0, 0, -pushed_N_}});
    });
    return {.force = Point(0, 0, pushed_N_)};
  }

 private:
  std::shared_ptr<SlowWorld> world_;
  Beats beats_;
  double pushed_N_ = 0;
};

}  // namespace forcebound::server
