#pragma once

#include "forcebound/control/held_force.hpp"
#include "forcebound/control/law.hpp"

namespace forcebound::control {

/// The more conservative force bounding law: what free space saved is forgotten, so that contact rests where
/// readings are exact.
///
/// Vectors have `dof` rows in the device frame: position [m], force on the device [N]; B = b/T = C C'.
/// Kim 2015, Prop. 3, eq. 24-34, written in energies so that nothing is divided by xi, which may underflow:
///
///     psi = sqrt(xi_{n-1}) C'd_n - sqrt(R) w,  w = C^-1 u_{n-1} / |C^-1 u_{n-1}|
///     A_n = |psi|^2                         energy available now  ( = R + xi_{n-1} d'B d - f_{n-1}'d )
///     r   = f_e'B^-1 f_e / 4                energy the request needs
///     f_e = 0  :  f = 0,                      xi = 1,        R = 0
///     r <= A_n :  f = f_e,                    xi = r / A_n,  R = A_n
///     else     :  f = u sqrt(4 A_n/u'B^-1 u), xi = 1,        R = A_n
///
/// An interval whose end was not read, or that no clock can have measured, leaves nothing of the reserve, and a
/// debt where the force was held for longer than the period; the debt is repaid from A before anything else. A static
/// wall in one degree of freedom shows min(K, 2b/T); where r <= A_n always, the law is transparent.
class MoreConservativeLaw final : public PassivityLaw {
 public:
  /// @throws std::invalid_argument unless degrees of freedom are 1 to 7 and period [s] > 0.
  MoreConservativeLaw(int degrees_of_freedom, double period_s);

  [[nodiscard]] std::string_view name() const noexcept override { return "fba-more"; }
  void credit(const Motion& motion) noexcept override;
  void lose(const Motion& motion) noexcept override { lose_for(motion.interval_s); }
  [[nodiscard]] Vector bound(const Vector& request_N) noexcept override;
  [[nodiscard]] bool allows(const Vector& force_N, double) const noexcept override;
  void commit(const Vector& force_N) noexcept override;

  /// A_n [J].
  [[nodiscard]] double energy_J() const noexcept override { return available_J_; }
  [[nodiscard]] double xi() const noexcept override { return xi_; }

 private:
  void lose_for(double interval_s) noexcept;

  HeldForce held_;
  double available_J_ = 0;  // A_n
  double reserved_J_ = 0;   // R
  double xi_ = 1;
  double debt_J_ = 0;  // what a force held for longer than a period may have taken beyond its reserve
};

}  // namespace forcebound::control
