#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <string_view>
#include <utility>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/control/force_bounder.hpp"
#include "forcebound/control/law_registry.hpp"
#include "tests/support/ideal_device.hpp"

namespace forcebound::test {

struct TwoPortSetting {
  int degrees_of_freedom = 1;
  std::size_t delay_ticks = 0;  ///< each way
  control::LawParameters parameters{};
};

/// A law and its server-side law; the test gives motion and environment:
///
///     test -- law ==( delay )== server-side law -- environment
class TwoPortLoop {
 public:
  using Environment = std::function<control::Vector(const control::Vector& place)>;

  TwoPortLoop(std::string_view law, TwoPortSetting setting, Environment environment)
      : facts_(ideal_device(setting.degrees_of_freedom)),
        name_(law),
        setting_(std::move(setting)),
        environment_(std::move(environment)),
        damping_(control::Damping::from_matrix(facts_.damping)),
        bounder_(facts_, baselines::shipped_laws().make(law, facts_, {.parameters = setting_.parameters})),
        request_(control::Vector::Zero(setting_.degrees_of_freedom)) {
    restart_server();
  }

  /// The force on the device from this reading on [N].
  control::Vector tick(const control::Vector& position) {
    up_.push_back({position, bounder_.law().outgoing()});
    if (up_.size() > setting_.delay_ticks) {
      const auto [at, numbers] = up_.front();
      up_.pop_front();
      place_ = server_side_->place({.position = at, .numbers = numbers, .interval_s = answers_++ > 0 ? 1e-3 : 0.0});
      down_.push_back(server_side_->answer(environment_(place_)));
    }
    if (down_.size() > setting_.delay_ticks) {
      bounder_.receive(down_.front().numbers);
      request_ = down_.front().force;
      down_.pop_front();
    }
    return step(position, request_);
  }
  double tick(double position_m) { return tick(control::Vector::Constant(1, position_m))[0]; }

  /// A tick without the server.
  control::Vector step(const control::Vector& position, const control::Vector& request_N) noexcept {
    control::Motion motion;
    motion.interval_s = ticks_++ > 0 ? facts_.period_s : 0.0;
    motion.position = motion.joint = position;
    motion.jacobian = control::Matrix::Identity(position.rows(), position.rows());
    motion.damping = &damping_;
    return bounder_.tick(motion, request_N);
  }
  double step(double position_m, double request_N) noexcept {
    return step(control::Vector::Constant(1, position_m), control::Vector::Constant(1, request_N))[0];
  }

  void restart_server() {
    server_side_ = baselines::shipped_laws().make_server_side(name_, setting_.degrees_of_freedom);
    answers_ = 0;
    up_.clear();
    down_.clear();
    bounder_.begin_server_side();
  }

  control::ForceBounder& bounder() noexcept { return bounder_; }
  [[nodiscard]] const control::PassivityLaw& law() const noexcept { return bounder_.law(); }
  [[nodiscard]] double energy_J() const noexcept { return law().energy_J(); }
  [[nodiscard]] const control::Vector& place() const noexcept { return place_; }

 private:
  struct Up {
    control::Vector position;
    control::ServerLawNumbers numbers;
  };

  control::DeviceFacts facts_;
  std::string name_;
  TwoPortSetting setting_;
  Environment environment_;
  control::Damping damping_;
  control::ForceBounder bounder_;
  std::unique_ptr<control::ServerSideLaw> server_side_;
  std::deque<Up> up_;
  std::deque<control::ServerSideLaw::Reply> down_;
  control::Vector request_;
  control::Vector place_;
  int ticks_ = 0;
  int answers_ = 0;
};

/// A wall at x >= 0.
inline TwoPortLoop::Environment wall_of(double stiffness_N_per_m) {
  return [=](const control::Vector& place) {
    control::Vector force = control::Vector::Zero(place.rows());
    force[0] = -stiffness_N_per_m * std::max(0.0, place[0]);
    return force;
  };
}

inline TwoPortLoop::Environment nothing_there() {
  return [](const control::Vector& place) { return control::Vector(control::Vector::Zero(place.rows())); };
}

/// Numbers of another end that offers this much energy: the energy first, then any.
inline control::ServerLawNumbers saying(double energy_J, const control::Vector& rest) {
  control::ServerLawNumbers numbers(1 + rest.rows());
  numbers << energy_J, rest;
  return numbers;
}

}  // namespace forcebound::test
