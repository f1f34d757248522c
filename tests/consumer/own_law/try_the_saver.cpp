#include <forcebound/control/force_bounder.hpp>
#include <forcebound/law_plugin/known_laws.hpp>

#include <cmath>
#include <cstdio>
#include <exception>

int main() try {
  namespace control = forcebound::control;
  const std::string name = forcebound::law_plugin::law_named(SAVER_FILE);
  control::DeviceFacts facts;
  facts.name = "a device of one axis";
  facts.damping = control::Matrix::Constant(1, 1, 30.0);  // N s/m
  facts.friction = facts.encoder_step = facts.actuator_step = control::Vector::Zero(1);
  facts.force_N_max = 30.0;
  control::ForceBounder bounder(facts, forcebound::law_plugin::known_laws().make(name, facts));

  // A millimetre of free motion in a tick dissipates b d^2/T = 30 mJ, which pay 2 sqrt(b E/T) = 60 N: all of the 20 N.
  const auto damping = control::Damping::from_matrix(facts.damping);
  control::Motion motion;
  motion.position = motion.joint = control::Vector::Zero(1);
  motion.jacobian = control::Matrix::Identity(1, 1);
  motion.damping = &damping;
  const double at_first_N = bounder.tick(motion, control::Vector::Constant(1, -20.0))[0];
  motion.interval_s = 1e-3;
  motion.position = motion.joint = control::Vector::Constant(1, 1e-3);
  const double then_N = bounder.tick(motion, control::Vector::Constant(1, -20.0))[0];
  std::printf("%s: %g N, then %g N\n", name.c_str(), at_first_N, then_N);
  return at_first_N == 0 && then_N == -20.0 && std::abs(bounder.law().energy_J() - 0.03) < 1e-12 ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "try_the_saver: %s\n", error.what());
  return 1;
}
