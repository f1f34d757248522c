#include "forcebound/client/commands/identify/identification.hpp"

#include <algorithm>
#include <cmath>

#include "forcebound/client/commands/identify/student.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::client::commands::identify {
namespace {

constexpr double kNotTimed_s = 4e-6;       // what the fit leaves out of the times
constexpr double kLatencyWide_s = 100e-6;  // bounds farther apart are none
constexpr double kHoldWide_s = 1e-3;
constexpr double kMassDoubtMost = 0.2;
constexpr double kGainMost = 2;  // more, or less than its inverse, is no motor's but another mass
constexpr double kDoubt = 1.3;   // errors are estimates too, and joints are weighed by them

/// Two joints' estimates of the same time: the more certain one counts more.
struct Pool {
  double weighted = 0;
  double weights = 0;
  double samples = 0;

  void add(const Estimate& estimate) noexcept {
    const double error = std::max(estimate.error, 1e-7);
    weighted += estimate.value / (error * error);
    weights += 1 / (error * error);
    samples += estimate.slides;
  }
  [[nodiscard]] TimeBounds bounds(double confidence, double wide_s, const char* what) const {
    if (weights == 0) return {.refused = std::string("no slide told the ") + what};
    const double quantile = student_quantile(confidence, std::max(5.0, samples - 8));
    const double margin = kDoubt * quantile / std::sqrt(weights) + kNotTimed_s;
    const double value = weighted / weights;
    TimeBounds bounds{.least_s = std::max(value - margin, 0.0), .most_s = std::max(value + margin, 0.0)};
    if (2 * margin > wide_s) {
      bounds.refused = "known to " + text::rounded(2e6 * margin, 2) + " us only; slides were too slow or too few";
    }
    return bounds;
  }
};

std::string asymmetry(const EnergyBalance& balance, bool cartesian) {
  constexpr double kMost = 0.5;
  const double mean = *std::min_element(balance.friction_at.begin(), balance.friction_at.end());
  const double weight = std::abs(balance.weight);
  const double noise = balance.friction.estimate - balance.friction.bound;
  if (weight < 3 * noise || weight < kMost * mean) return {};
  return "the two directions differ by " + text::rounded(2 * weight, 2) + (cartesian ? " N" : " N m") + ", " +
         text::rounded(100 * weight / std::max(mean, 1e-9), 2) +
         " % of the friction each way: does a weight pull on it, or a hand?";
}

/// Narrows the gain that the driver tells, by the mass that the joint has and the one that it seems to have: a motor
/// that makes less than commanded moves it as if it were heavier. Without a gain, damping and friction are not known
/// either.
void measure_gain(JointFindings& joint, double mass, double share) {
  EnergyBalance& balance = joint.balance;
  if (!balance.damping.refused.empty()) return;
  const control::Bracket told = joint.gain_share;
  const bool exact = told == control::Bracket{};
  const double doubt = balance.mass_error / balance.mass;
  const bool seen = doubt >= 0 && doubt < kMassDoubtMost;
  if (!seen && !exact) return;
  control::Bracket& gain = joint.gain_share;
  gain = {(1 - share) * mass / (balance.mass * (1 + doubt)) - 1, (1 + share) * mass / (balance.mass * (1 - doubt)) - 1};
  const control::Bracket accepted = exact ? control::Bracket{1 / kGainMost - 1, kGainMost - 1} : told;
  std::string refused;
  if (!seen) {
    refused = "the mass that it seems to have, " + text::rounded(balance.mass) + ", is lost in friction and rounding";
  } else if (gain.least > accepted.most || gain.most < accepted.least) {
    refused = "it moves like " + text::rounded(balance.mass) + ", the known mass is " + text::rounded(mass) +
              ": its motor would make " + text::rounded(mass / balance.mass, 2) + " times what is commanded; " +
              text::rounded(1 + accepted.least, 3) + " to " + text::rounded(1 + accepted.most, 3) +
              " would be accepted";
  } else if (!exact) {
    gain = {std::max(gain.least, told.least), std::min(gain.most, told.most)};
  }
  if (!refused.empty()) balance.damping.refused = balance.friction.refused = refused;
}

}  // namespace

bool Findings::complete() const noexcept {
  return trouble.empty() && latency.refused.empty() && (!releases || hold.refused.empty()) &&
         std::ranges::all_of(joints, [](const JointFindings& joint) {
           return joint.encoder_refused.empty() && joint.balance.damping.refused.empty();
         });
}

control::Bracket Findings::torque_gain_share() const noexcept {
  if (joints.size() < 2) return {};
  control::Bracket all = joints.front().gain_share;
  for (const JointFindings& joint : joints) {
    all = {std::min(all.least, joint.gain_share.least), std::max(all.most, joint.gain_share.most)};
  }
  return all;
}

std::vector<std::string> Findings::refusals(bool cartesian) const {
  std::vector<std::string> all;
  if (!trouble.empty()) all.push_back(trouble);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const std::string of = std::string(" of ") + (cartesian ? "axis " : "joint ") + std::to_string(i + 1) + ": ";
    const JointFindings& joint = joints[i];
    if (!joint.encoder_refused.empty()) all.push_back("encoder step" + of + joint.encoder_refused);
    if (!joint.balance.damping.refused.empty()) all.push_back("damping" + of + joint.balance.damping.refused);
    if (!joint.balance.friction.refused.empty()) all.push_back("friction" + of + joint.balance.friction.refused);
  }
  if (!latency.refused.empty()) all.push_back("latency: " + latency.refused);
  if (releases && !hold.refused.empty()) all.push_back("hold time: " + hold.refused);
  return all;
}

Findings evaluate(const Guide& guide, const control::DeviceFacts& declared, double confidence_of_all,
                  const KnownMass& known) {
  const bool mass_known = !known.of_joints.empty();
  // Damping and friction of each joint, both ends of its mass and of two times (Bonferroni).
  const double bounds = (mass_known ? 4.0 : 2.0) * declared.degrees_of_freedom() + 4;
  const double confidence = 1 - (1 - confidence_of_all) / bounds;
  Findings findings;
  findings.readings = guide.readings();
  findings.force_N_most = guide.force_N_most();
  findings.trouble = guide.trouble();
  findings.gains_measured = mass_known;
  Pool latency;
  Pool hold;
  int silent = 0;
  int pushed_on = 0;
  for (std::size_t i = 0; i < guide.joints().size(); ++i) {
    const Guide::JointRecord& record = guide.joints()[i];
    JointFindings joint;
    joint.gain_share = declared.uncertainty.torque_gain_share;
    joint.break_away = record.break_away;
    joint.encoder_step = i < findings.readings.encoder_step.size() ? findings.readings.encoder_step[i] : 0;
    if (joint.encoder_step == 0) joint.encoder_refused = "its readings lie on no grid";
    joint.release = fit_releases(record.slides, joint.encoder_step, record.guess);
    for (const Slide& slide : record.slides) {
      silent += slide.end == Slide::End::silence;
      pushed_on += slide.still_pushed;
    }
    if (joint.release) {
      latency.add(joint.release->latency_s);
      if (joint.release->hold_s) hold.add(*joint.release->hold_s);
    }
    findings.joints.push_back(std::move(joint));
  }
  findings.latency = latency.bounds(confidence, kLatencyWide_s, "latency");
  findings.releases = silent == 0 || 2 * pushed_on < silent;
  findings.hold = hold.bounds(confidence, kHoldWide_s, "hold time");

  for (std::size_t i = 0; i < guide.joints().size(); ++i) {
    const Guide::JointRecord& record = guide.joints()[i];
    JointFindings& joint = findings.joints[i];
    if (!record.refused.empty() || !joint.release) {
      joint.balance.damping.refused = joint.balance.friction.refused =
          record.refused.empty() ? "too few slides can be used" : record.refused;
      continue;
    }
    const double latency_error_s = 0.5 * (findings.latency.most_s - findings.latency.least_s);
    joint.balance = balance_energy(
        record.slides, *joint.release,
        {.encoder_step = joint.encoder_step, .latency_error_s = latency_error_s, .confidence = confidence});
    joint.points = slide_points(record.slides, *joint.release, joint.encoder_step);
    LowerBound& damping = joint.balance.damping;
    LowerBound& friction = joint.balance.friction;
    if (damping.refused.empty() && damping.bound <= 0) {
      damping.refused = "it is lost in friction and rounding: " + text::rounded(damping.estimate) + " was found, " +
                        text::rounded(damping.estimate - damping.bound) + " is the doubt";
    }
    // No friction is a bound too.
    if (friction.refused.empty() && friction.bound > 0) {
      friction.refused = asymmetry(joint.balance, declared.cartesian);
    }
    friction.bound = std::max(friction.bound, 0.0);
    if (mass_known) measure_gain(joint, known.of_joints[i], known.share);
  }
  return findings;
}

control::DeviceFacts facts_of(const Findings& findings, const control::DeviceFacts& declared) {
  control::DeviceFacts facts = declared;
  const int dof = declared.degrees_of_freedom();
  facts.damping.setZero(dof, dof);
  facts.friction.setZero(dof);
  facts.encoder_step.setZero(dof);
  for (int i = 0; i < dof; ++i) {
    const JointFindings& joint = findings.joints[static_cast<std::size_t>(i)];
    facts.damping(i, i) = joint.balance.damping.least();
    facts.friction[i] = joint.balance.friction.least();
    facts.encoder_step[i] = joint.encoder_step;
  }
  facts.uncertainty.damping_share = facts.uncertainty.friction_share = 0;
  facts.uncertainty.torque_gain_share = findings.torque_gain_share();
  facts.uncertainty.losses_with_gain = true;
  facts.latency_s = findings.latency.most_s;
  facts.uncertainty.latency_s = {findings.latency.least_s - findings.latency.most_s, 0};
  facts.releases = findings.releases;
  if (findings.releases) {
    facts.hold_s_max = findings.hold.most_s;
    facts.uncertainty.hold_s = {findings.hold.least_s - findings.hold.most_s, 0};
    facts.release_share = facts.release_s = 0;
  }
  return facts;
}

}  // namespace forcebound::client::commands::identify
