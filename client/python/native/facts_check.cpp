#include "python/native/facts_check.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include "forcebound/control/classic_text.hpp"
#include "forcebound/control/damping.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::python {
namespace {

using control::Bracket;
using control::DeviceFacts;
using control::Uncertainty;
using control::Vector;

template <class Value>
[[noreturn]] void refuse(const char* field, const std::string& accepted, const Value& got) {
  control::ClassicText text;
  text << field << " must be " << accepted << ", got " << got;
  throw std::invalid_argument(text.str());
}

struct Range {
  double least = 0;
  double most = 0;
};

void expect_within(const char* field, double value, const Range& range, const char* accepted) {
  if (!(value >= range.least && value <= range.most)) refuse(field, accepted, value);
}

void expect_bracket(const char* field, const Bracket& bracket) {
  const bool holds = bracket.least >= -1 && bracket.least <= bracket.most && bracket.most <= 1;
  if (!holds) {
    refuse(field, "two numbers of -1 to 1 s, the smaller one first",
           text::to_text(bracket.least) + ", " + text::to_text(bracket.most));
  }
}

void expect_share(const char* field, double share) {
  if (!(share >= 0 && share < 1)) refuse(field, ">= 0 and < 1", share);
}

void expect_per_joint(const char* field, const Vector& values, Eigen::Index joints) {
  if (values.rows() != joints) {
    refuse(field, "of shape (" + std::to_string(joints) + ",), as damping has",
           "(" + std::to_string(values.rows()) + ",)");
  }
  if (!values.allFinite() || (values.array() < 0).any()) refuse(field, ">= 0 for each joint", values.transpose());
}

void expect_possible(const Uncertainty& uncertainty) {
  constexpr Range kSteps{0, 1000};
  constexpr Range kLag_s{0, 0.01};
  expect_bracket("stamp_s", uncertainty.stamp_s);
  expect_bracket("latency_s of the uncertainty", uncertainty.latency_s);
  expect_bracket("latency_offset_s", uncertainty.latency_offset_s);
  expect_bracket("hold_s", uncertainty.hold_s);
  expect_share("clock_share", uncertainty.clock_share);
  expect_share("damping_share", uncertainty.damping_share);
  expect_share("friction_share", uncertainty.friction_share);
  expect_share("torque_ripple_share", uncertainty.torque_ripple_share);
  expect_within("encoder_steps", uncertainty.encoder_steps, kSteps, "0 to 1000");
  expect_within("actuator_lag_s", uncertainty.actuator_lag_s, kLag_s, "0 to 0.01 s");
}

}  // namespace

void expect_possible(const DeviceFacts& facts) {
  constexpr Range kPeriod_s{1e-4, 0.1};
  constexpr Range kLatency_s{0, 0.01};
  constexpr Range kOne{0, 1};
  (void)control::Damping::from_matrix(facts.damping);  // refuses what is no damping
  if (facts.tip_axes < 0 || facts.tip_axes > facts.joints()) {
    refuse("tip_axes", "0 to " + std::to_string(facts.joints()) + ", the number of joints", facts.tip_axes);
  }
  if (facts.cartesian && facts.degrees_of_freedom() != facts.joints()) {
    refuse("tip_axes", "0 of a Cartesian device, whose joints are the axes of the tip", facts.tip_axes);
  }
  expect_within("period_s", facts.period_s, kPeriod_s, "0.0001 to 0.1 s");
  expect_within("latency_s", facts.latency_s, kLatency_s, "0 to 0.01 s");
  expect_within("release_share", facts.release_share, kOne, "0 to 1");
  expect_within("release_s", facts.release_s, kOne, "0 to 1 s");
  expect_within("hold_s_max", facts.hold_s_max, {.least = 1e-9, .most = 1}, "> 0 and <= 1 s");
  if (!(facts.force_N_max > 0)) refuse("force_N_max", "> 0 N", facts.force_N_max);
  expect_per_joint("friction", facts.friction, facts.joints());
  expect_per_joint("encoder_step", facts.encoder_step, facts.joints());
  expect_per_joint("actuator_step", facts.actuator_step, facts.joints());
  if (facts.speed_max.rows() > 0) expect_per_joint("speed_max", facts.speed_max, facts.joints());
  expect_possible(facts.uncertainty);
}

void expect_same_mechanism(const DeviceFacts& facts, const DeviceFacts& other) {
  const auto in_words = [](const DeviceFacts& f) {
    return std::to_string(f.joints()) + " joints, " + std::to_string(f.degrees_of_freedom()) + " axes of the tip, " +
           (f.cartesian ? "Cartesian" : "not Cartesian");
  };
  const bool same = facts.joints() == other.joints() && facts.degrees_of_freedom() == other.degrees_of_freedom() &&
                    facts.cartesian == other.cartesian;
  if (!same) refuse("the facts", "those of a device of " + in_words(other), in_words(facts));
}

}  // namespace forcebound::python
