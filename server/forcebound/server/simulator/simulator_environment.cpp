#include "forcebound/server/simulator/simulator_environment.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "forcebound/local_model/dragged_mass.hpp"
#include "forcebound/server/offer/scene_answers.hpp"

namespace forcebound::server {
namespace {

using local_model::DevicePoint;
using local_model::DraggedMass;
using local_model::LocalModel;
using local_model::Mass;
using local_model::MassState;

// As a client's late-force policy.
constexpr double kHold_s = 0.25;
constexpr double kDrop_s = 1;
constexpr double kReturn_s = 0.05;
// What a report changes of the force fades.
constexpr double kFade_s = 0.005;
constexpr double kNothing_N = 1e-9;
// A report older than kHold_s is not gone on from: steps of a millisecond, with some to spare.
constexpr int kCatchUpMost = 300;
// Estimate on a present-day machine, of a probe that meets what there is room for.
constexpr double kStep_ns = 1500;

/// A client's probe, which goes on between reports.
class ProbeState {
 public:
  ProbeState(Simulator& simulator, std::size_t seat) noexcept : simulator_(&simulator), seat_(seat) {}

  [[nodiscard]] bool taken() const noexcept { return client_ != 0; }

  void join() noexcept {
    *this = ProbeState(*simulator_, seat_);
    client_ = simulator_->another_client();
  }

  void leave() noexcept {
    client_ = 0;
    simulator_->publish(seat_, {});
  }

  void press(std::uint32_t buttons) noexcept { buttons_ = buttons; }

  void move(const DevicePoint& device, Nanoseconds now) noexcept {
    device_ = device;
    if (placed_) return;
    placed_ = true;
    model_ = mass_of(simulator_->probe(), device.place_m, Point::Zero(), {});
    mass_.update(model_, {}, now);
  }

  void advance(double elapsed_s, Nanoseconds now) noexcept {
    if (!placed_) return;
    // More at once is the client's own pause.
    const bool falls_silent = silent_s_ <= kHold_s && silent_s_ + elapsed_s > kHold_s && elapsed_s < kHold_s;
    silent_s_ += elapsed_s;
    fading_N_ *= std::exp(-elapsed_s / kFade_s);
    if (fading_N_.cwiseAbs().maxCoeff() < kNothing_N) fading_N_.setZero();
    const auto before = mass_.state().met;
    mass_.advance(device_, elapsed_s, now);
    for (std::size_t i = 0; i < kTouchesMost; ++i)
      pushed_.front().impulse_Ns.at(i) += share_ * (mass_.state().met.at(i).received_Ns - before.at(i).received_Ns);
    const Simulator::Report* const report = simulator_->newest(seat_);
    if (report != nullptr && report->client == client_) take_over(*report, now);
    if (falls_silent && silent_s_ > kHold_s) simulator_->count_silence();
    const double in_time = std::clamp((kDrop_s - silent_s_) / (kDrop_s - kHold_s), 0.0, 1.0);
    share_ = pushed_.front().report == 0 ? 0 : std::min(in_time, share_ + elapsed_s / kReturn_s);
    publish(now);
  }

  [[nodiscard]] scene::ModelTouch touch() const noexcept {
    scene::ModelTouch touch{.force_N = felt_N()};
    const MassState& state = mass_.state();
    for (std::uint32_t i = 0; i < model_.contact_count; ++i) {
      const MassState::Met& met = state.met.at(i);
      const Point& normal = model_.contacts.at(i).normal;
      const double depth_m = normal.dot(state.place_m - device_.place_m) - met.gap_m;
      if (!(met.pressed_Ns > 0) || depth_m <= touch.penetration_m) continue;
      touch.normal = normal;
      touch.penetration_m = depth_m;
    }
    return touch;
  }

  /// As it is now, in place of when it was reported.
  [[nodiscard]] bool describe(LocalModel& model) const noexcept {
    if (share_ < 1) return false;
    const MassState& state = mass_.state();
    Mass mass = model_;
    mass.force_N = mass_.force_N(device_);
    mass.place_m = state.place_m;
    mass.body.velocity_m_per_s = state.velocity_m_per_s;
    mass.contact_count = 0;
    for (std::uint32_t i = 0; i < model_.contact_count; ++i) {
      const MassState::Met& met = state.met.at(i);
      if (!std::isfinite(met.gap_m)) continue;  // left behind
      local_model::Contact& contact = mass.contacts.at(mass.contact_count++);
      contact = model_.contacts.at(i);
      contact.gap_m = met.gap_m;
      contact.met.velocity_m_per_s = met.velocity_m_per_s;
      contact.met.bias_m_per_s2 +=
          bias_m_per_s2(contact.met.mobility_per_kg, -contact.met.spring_N_per_m * met.moved_m);
    }
    model.has_mass = true;
    model.mass = mass;
    return true;
  }

  [[nodiscard]] bool sound() const noexcept { return felt_N().allFinite(); }

 private:
  [[nodiscard]] Point felt_N() const noexcept { return share_ * mass_.force_N(device_) + fading_N_; }

  /// One that is too old to go on from is as none.
  void take_over(const Simulator::Report& report, Nanoseconds now) noexcept {
    const double age_s = time::to_seconds(now - report.moment);
    if (age_s > kHold_s) return;
    const Point before_N = mass_.force_N(device_);
    model_ = mass_of(simulator_->probe(), report.place_m, report.velocity_m_per_s,
                     std::span(report.touches).first(report.count));
    mass_.update(model_, {.s = age_s}, now);
    fading_N_ += share_ * (before_N - mass_.force_N(device_));
    pushed_ = {Simulator::Pushed{.report = report.number}, pushed_.front()};
    silent_s_ = age_s;
  }

  void publish(Nanoseconds now) const noexcept {
    const MassState& state = mass_.state();
    simulator_->publish(seat_, {.moment = now,
                                .client = client_,
                                .place_m = state.place_m,
                                .velocity_m_per_s = state.velocity_m_per_s,
                                .device_m = device_.place_m,
                                .buttons = buttons_,
                                .pushed = pushed_});
  }

  Simulator* simulator_;
  std::size_t seat_;
  std::uint64_t client_ = 0;  // 0: the seat is free
  std::uint32_t buttons_ = 0;
  bool placed_ = false;
  DevicePoint device_{};
  Mass model_{};  // of the newest report, or the probe alone
  DraggedMass mass_{kCatchUpMost};
  std::array<Simulator::Pushed, 2> pushed_{};  // by the newest report, and by the one before
  double silent_s_ = 0;
  double share_ = 0;  // of the force that is felt
  Point fading_N_ = Point::Zero();
};

class ProbeStates final : public scene::DynamicModelState {
 public:
  explicit ProbeStates(std::shared_ptr<Simulator> simulator) : simulator_(std::move(simulator)) {
    for (std::size_t seat = 0; seat < simulator_->seats(); ++seat) probes_.emplace_back(*simulator_, seat);
  }

  int join() override {
    const auto free = std::ranges::find_if(probes_, [](const ProbeState& probe) { return !probe.taken(); });
    if (free == probes_.end()) return -1;
    free->join();
    return static_cast<int>(free - probes_.begin());
  }
  void leave(int seat) override { of(seat).leave(); }
  void press(int seat, std::uint32_t buttons) noexcept override { of(seat).press(buttons); }
  void move(int seat, const Point& position_m, const Point& velocity_m_per_s) noexcept override {
    of(seat).move({.place_m = position_m, .velocity_m_per_s = velocity_m_per_s}, now_);
  }
  void advance(double elapsed_s) noexcept override {
    now_ += time::from_seconds(elapsed_s);
    for (ProbeState& probe : probes_) {
      if (probe.taken()) probe.advance(elapsed_s, now_);
    }
  }
  scene::ModelTouch touch(int seat) noexcept override { return of(seat).touch(); }
  [[nodiscard]] bool describe(int seat, LocalModel& model) noexcept override { return of(seat).describe(model); }
  [[nodiscard]] bool sound() const noexcept override {
    return std::ranges::all_of(probes_, [](const ProbeState& probe) { return probe.sound(); });
  }

 private:
  ProbeState& of(int seat) noexcept { return probes_[static_cast<std::size_t>(seat)]; }

  std::shared_ptr<Simulator> simulator_;
  std::vector<ProbeState> probes_;
  Nanoseconds now_{0};
};

class SimulatorModel final : public scene::DynamicModel {
 public:
  explicit SimulatorModel(std::shared_ptr<Simulator> simulator) : simulator_(std::move(simulator)) {}

  [[nodiscard]] std::unique_ptr<scene::DynamicModelState> make_state(int /*seats*/) const override {
    return std::make_unique<ProbeStates>(simulator_);
  }
  [[nodiscard]] scene::DynamicModelFacts facts() const override {
    return {.stiffness_N_per_m = simulator_->probe().stiffness_N_per_m,
            .damping_N_s_per_m = simulator_->probe().damping_N_s_per_m,
            .cost_ns = kStep_ns,
            .seats_max = static_cast<int>(simulator_->seats()),
            .describes_itself = true,
            .inputs = {.velocity = true, .time = true}};
  }

 private:
  std::shared_ptr<Simulator> simulator_;
};

std::shared_ptr<const scene::Scene> scene_of(const SimulatorOffer& offer, const std::shared_ptr<Simulator>& simulator) {
  scene::SceneParts parts;
  parts.dynamic_models.push_back(
      {.name = offer.name, .text = offer.simulated, .dynamic_model = std::make_unique<SimulatorModel>(simulator)});
  return std::make_shared<const scene::Scene>(scene::SceneFacts{.name = offer.name,
                                                                .description = offer.simulated,
                                                                .degrees_of_freedom = 3,
                                                                .shared = true,
                                                                .clients_max = static_cast<int>(simulator->seats())},
                                              std::move(parts));
}

}  // namespace

EnvironmentKind simulator_environment(const SimulatorOffer& offer, const std::shared_ptr<Simulator>& simulator) {
  const auto scene = scene_of(offer, simulator);
  const auto models = std::make_shared<scene::DynamicModelsNow>(
      scene::begin_dynamic_models(*scene, static_cast<int>(simulator->seats())));
  return {.name = offer.name,
          .degrees_of_freedom = {3, 6},
          .sessions_max = simulator->seats(),
          .make = [offer, scene, models](const ClientFacts& client) {
            return MadeEnvironment{.environment = std::make_unique<SceneAnswers>(
                                       scene::SceneState(scene, client.degrees_of_freedom, *models)),
                                   .simulated = offer.simulated,
                                   .least_rendering = scene->least_rendering()};
          }};
}

}  // namespace forcebound::server
