#pragma once

#include <algorithm>
#include <cmath>

#include "forcebound/baselines/two_port.hpp"
#include "forcebound/control/energy_sum.hpp"

/// Waves between a law and its server-side law. A message carries the energy so far and the wave's integral, with one
/// number per axis.
namespace forcebound::baselines {

/// An outgoing wave: its integral [m sqrt(N s/m)] and the energy in it [J].
class SentWave {
 public:
  void add(const Vector& wave, double interval_s) noexcept {
    const double energy_J = wave.squaredNorm() / 2 * interval_s;
    if (!std::isfinite(energy_J)) return;
    if (integral_.rows() == 0) integral_ = Vector::Zero(wave.rows());
    integral_ += wave * interval_s;
    energy_.add(energy_J);
  }

  /// Energy, integral; nothing before the first sample.
  [[nodiscard]] Eigen::Index rows() const noexcept { return integral_.rows() > 0 ? 1 + integral_.rows() : 0; }
  void write(control::ServerLawNumbers& numbers, Eigen::Index at) const noexcept {
    if (integral_.rows() == 0) return;
    numbers[at] = energy_.value_J();
    numbers.segment(at + 1, integral_.rows()) = integral_;
  }

 private:
  Vector integral_;
  control::EnergySum energy_;
};

/// An incoming wave. Integral and energy travel as sums, so that what was lost arrives with the next message and
/// nothing counts twice. The wave taken out never has more energy than what came in: of two samples, one late, the sum
/// makes no higher wave than their energy allows.
class ReceivedWave {
 public:
  /// The first sums received give no wave.
  void begin(Eigen::Index dof) noexcept { rest_ = Vector::Zero(dof); }

  void begin_at_zero(Eigen::Index dof) noexcept {
    energy_.begin_at_zero();
    newest_ = rest_ = Vector::Zero(dof);
  }

  void receive(const control::ServerLawNumbers& numbers, Eigen::Index at) noexcept {
    const Eigen::Index dof = rest_.rows();
    if (numbers.rows() < at + 1 + dof) return;
    const Vector integral = numbers.segment(at + 1, dof);
    const double news_J = energy_.receive(numbers[at]);
    if (newest_.rows() != dof) newest_ = integral;
    if (!(news_J > 0)) return;
    budget_.add(news_J);
    rest_ += integral - newest_;
    newest_ = integral;
  }

  /// The wave over the coming interval, such that the rest would last for `spread_s` if no more came.
  [[nodiscard]] Vector take(double interval_s, double spread_s) noexcept {
    const double wanted = rest_.stableNorm() / spread_s;
    const double most = std::sqrt(2 * std::max(0.0, budget_.value_J()) / interval_s);
    Vector wave = Vector::Zero(rest_.rows());
    if (wanted > 0 && std::isfinite(wanted)) wave = rest_ * (std::min(1.0, most / wanted) / spread_s);
    rest_ -= wave * interval_s;
    return wave;
  }

  void spend(double energy_J) noexcept {
    if (std::isfinite(energy_J)) budget_.add(-energy_J);
  }
  [[nodiscard]] double budget_J() const noexcept { return budget_.value_J(); }

 private:
  RemoteSum energy_;
  control::EnergySum budget_;
  Vector newest_;  // integral
  Vector rest_;    // of the integral, not taken yet
};

/// Impedance b_w of the wave [N s/m]. F is the paper's force, v goes with it: b_w v + F = sqrt(2 b_w) u.
struct WaveCoding {
  double impedance_N_s_per_m;

  [[nodiscard]] double root() const noexcept { return std::sqrt(2 * impedance_N_s_per_m); }
  [[nodiscard]] Vector going(const Vector& v, const Vector& F) const noexcept {
    return (impedance_N_s_per_m * v + F) / root();
  }
  [[nodiscard]] Vector returning(const Vector& v, const Vector& F) const noexcept {
    return (impedance_N_s_per_m * v - F) / root();
  }
  [[nodiscard]] Vector force(const Vector& v, const Vector& returning) const noexcept {
    return impedance_N_s_per_m * v - root() * returning;
  }
};

}  // namespace forcebound::baselines
