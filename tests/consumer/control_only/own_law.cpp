// A consumer's own law: one class and one line of registration. It saturates at a force whose energy the device's
// damping dissipates within a tick, whatever was stored before; --help, parameters and their errors come with it.
#include <forcebound/control/force_bounder.hpp>
#include <forcebound/control/held_force.hpp>
#include <forcebound/control/law_registry.hpp>

#include <cstdio>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string>

namespace control = forcebound::control;
using control::Motion;
using control::Vector;

namespace {

class CautiousLaw final : public control::PassivityLaw {
 public:
  CautiousLaw(const control::DeviceFacts& facts, double reserve_J)
      : held_(facts.degrees_of_freedom(), facts.period_s), reserve_J_(reserve_J) {}
  [[nodiscard]] std::string_view name() const noexcept override { return "cautious"; }
  void credit(const Motion& motion) noexcept override { held_.begin(motion); }
  void lose(const Motion&) noexcept override { held_.lose(); }
  [[nodiscard]] Vector bound(const Vector& request_N) noexcept override { return held_.bounded(request_N, reserve_J_); }
  void commit(const Vector& force_N) noexcept override { held_.hold(force_N); }
  [[nodiscard]] double energy_J() const noexcept override { return reserve_J_; }

 private:
  control::HeldForce held_;
  double reserve_J_;
};

control::LawDescription cautious() {
  return {.name = "cautious",
          .summary = "never more force than a reserve of energy allows",
          .shortens = true,
          .parameters = {{.name = "reserve_J",
                          .purpose = "energy that a tick may cost",
                          .least = 1e-9,
                          .most = 1,
                          .standard = [](const control::DeviceFacts&) { return 1e-5; }}},
          .make = [](const control::DeviceFacts& facts, const control::LawOptions& options) {
            return std::make_unique<CautiousLaw>(facts, options.parameters.at("reserve_J"));
          }};
}

bool refuses(const control::LawRegistry& laws, const control::DeviceFacts& facts) {
  try {
    (void)laws.make("cautious", facts, {.parameters = {{"reserve_J", 2.0}}});
    return false;
  } catch (const std::invalid_argument& error) {
    std::printf("%s\n", error.what());
    return true;
  }
}

}  // namespace

int main() {
  control::LawRegistry laws = control::force_bounding_laws();
  laws.add(cautious());

  control::DeviceFacts facts;
  facts.name = "a device of one axis";
  facts.damping = control::Matrix::Constant(1, 1, 30.0);  // N s/m
  facts.friction = facts.encoder_step = facts.actuator_step = Vector::Zero(1);
  facts.force_N_max = 30.0;
  control::ForceBounder bounder(facts, laws.make("cautious", facts));

  const auto damping = control::Damping::from_matrix(facts.damping);
  Motion motion;
  motion.position = motion.joint = Vector::Zero(1);
  motion.jacobian = control::Matrix::Identity(1, 1);
  motion.damping = &damping;
  const double force_N = -bounder.tick(motion, Vector::Constant(1, -20.0))[0];
  std::printf("%sasked for 20 N, got %.3f N\n", laws.help("cautious").c_str(), force_N);
  // T f^2 / 4b = reserve
  const bool as_chosen = force_N > 1.0954 && force_N < 1.0955;
  return as_chosen && refuses(laws, facts) ? 0 : 1;
}
