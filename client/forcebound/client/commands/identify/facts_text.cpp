#include "forcebound/client/commands/identify/facts_text.hpp"

#include <algorithm>
#include <functional>

#include "forcebound/control/classic_text.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/table.hpp"
#include "forcebound/text/terminal.hpp"

namespace forcebound::client::commands::identify {
namespace {

using text::rounded;

/// `KEY = [a, b]  # why`, or a comment with the reason.
class Lines {
 public:
  void fact(const std::string& key, const std::string& value, const std::string& why) {
    out_ << key << " = " << value << "  # " << why << '\n';
  }
  void refused(const std::string& key, const std::string& why) { out_ << "# " << key << ": no bound. " << why << '\n'; }
  void add_comment(const std::string& words) { out_ << "# " << words << '\n'; }
  void raw(const std::string& line) { out_ << line << '\n'; }
  [[nodiscard]] std::string text() const { return out_.str(); }

 private:
  control::ClassicText out_;
};

/// A lower bound that is still one when written with five digits.
std::string written_below(double value) {
  constexpr double kBelow = 1 - 5e-6;
  constexpr int kDigits = 6;
  return value > 0 ? rounded(value * kBelow, kDigits) : "0";
}

std::string list(const Findings& findings, const std::function<std::string(const JointFindings&)>& one) {
  std::string all;
  for (const JointFindings& joint : findings.joints) all += (all.empty() ? "" : ", ") + one(joint);
  return "[" + all + "]";
}

/// "95 to 104": percent.
std::string range_words(const UsableForce& force) {
  if (!force.told()) return "-";
  constexpr int kDigits = 3;
  return rounded(100 * (force.share - force.share_error), kDigits) + " to " +
         rounded(100 * (force.share + force.share_error), kDigits);
}

/// Of the joint with the least; empty: that of one could not be told.
std::string arrived(const Findings& findings) {
  const UsableForce* worst = nullptr;
  for (const JointFindings& joint : findings.joints) {
    const UsableForce& force = joint.balance.force;
    if (!force.told()) return {};
    if (worst == nullptr || force.share - force.share_error < worst->share - worst->share_error) worst = &force;
  }
  return worst == nullptr ? std::string() : range_words(*worst) + " %";
}

std::string force_words(const Findings& findings) {
  const std::string share = arrived(findings);
  const std::string most = "up to " + rounded(findings.force_N_most) + " N was used here, ";
  if (share.empty()) return most + "and whether it arrived was not established";
  return most + "of which " + share + " arrived";
}

std::string bracket(double least, double most) { return "[" + text::to_text(least) + ", " + text::to_text(most) + "]"; }

bool any_refused(const Findings& findings, const std::function<const std::string&(const JointFindings&)>& reason) {
  return std::ranges::any_of(findings.joints, [&](const JointFindings& joint) { return !reason(joint).empty(); });
}

void write_joints(Lines& lines, const Findings& findings, bool cartesian, double confidence) {
  const std::string percent = rounded(100 * confidence, 3) + " %";
  int slides = 0;
  for (const JointFindings& joint : findings.joints) slides += joint.balance.slides;
  const std::string from = "energy of " + std::to_string(slides) + " slides, " + percent;
  const char* const damping = cartesian ? "damping_N_s_per_m" : "joint_damping_N_m_s_per_rad";
  const char* const friction = cartesian ? "friction_N" : "joint_friction_N_m";
  const char* const step = cartesian ? "encoder_step_m" : "encoder_step_rad";
  if (any_refused(findings, [](const JointFindings& j) -> const std::string& { return j.balance.damping.refused; })) {
    lines.refused(damping, "see the reasons above; a law cannot do without it");
  } else {
    lines.fact(damping, list(findings, [](const JointFindings& j) { return written_below(j.balance.damping.least()); }),
               "lower bound; " + from);
  }
  lines.fact(friction, list(findings, [](const JointFindings& j) { return written_below(j.balance.friction.least()); }),
             "lower bound, least of " + std::to_string(kPlaces) + " places; " + from);
  if (any_refused(findings, [](const JointFindings& j) -> const std::string& { return j.encoder_refused; })) {
    lines.refused(step, "see the reasons above");
  } else {
    lines.fact(step, list(findings, [](const JointFindings& j) { return text::to_text(j.encoder_step); }),
               "all readings lie whole steps apart");
  }
}

void write_times(Lines& lines, const Findings& findings, const control::DeviceFacts& declared, double confidence) {
  const std::string percent = rounded(100 * confidence, 3) + " %";
  if (findings.latency.refused.empty()) {
    lines.fact("latency_s", text::to_text(findings.latency.most_s),
               "upper bound; where the push ended in mid-slide, " + percent);
  } else {
    lines.refused("latency_s", findings.latency.refused);
  }
  if (!findings.releases) {
    lines.fact("releases", "false", "the force stayed for 0.15 s without commands");
    lines.fact("hold_s_max", text::to_text(declared.hold_s_max), "not measured");
  } else if (findings.hold.refused.empty()) {
    lines.fact("hold_s_max", text::to_text(findings.hold.most_s),
               "upper bound; where the push ended after the last command, " + percent);
  } else {
    lines.refused("hold_s_max", findings.hold.refused);
  }
}

void write_uncertainty(Lines& lines, const Findings& findings, const control::DeviceFacts& declared) {
  const control::Uncertainty& told = declared.uncertainty;
  lines.raw("");
  lines.raw("[uncertainty]");
  if (findings.latency.refused.empty()) {
    lines.fact("latency_s", bracket(findings.latency.least_s - findings.latency.most_s, 0), "measured");
  }
  if (findings.releases && findings.hold.refused.empty()) {
    lines.fact("hold_s", bracket(findings.hold.least_s - findings.hold.most_s, 0), "measured");
  }
  const std::string as_reported = "as the driver says; no motion tells it";
  lines.fact("latency_offset_s", bracket(told.latency_offset_s.least, told.latency_offset_s.most), as_reported);
  lines.fact("stamp_s", bracket(told.stamp_s.least, told.stamp_s.most), as_reported);
  lines.fact("clock_share", text::to_text(told.clock_share), as_reported);
  lines.fact("encoder_steps", text::to_text(told.encoder_steps), as_reported);
  const control::Bracket gain = findings.torque_gain_share();
  lines.fact("torque_gain_share", bracket(gain.least, gain.most),
             findings.joints.size() == 1 ? "of one motor it does not matter"
             : findings.gains_measured   ? "by the known mass"
                                         : as_reported);
  lines.fact("losses_with_gain", "true", "damping and friction above are in units of the motors' commands");
  lines.fact("torque_ripple_share", text::to_text(told.torque_ripple_share), as_reported);
  lines.fact("actuator_lag_s", text::to_text(told.actuator_lag_s), as_reported);
}

}  // namespace

std::string facts_text(const Findings& findings, const control::DeviceFacts& declared, double confidence) {
  Lines lines;
  lines.add_comment("Facts of '" + declared.name + "', measured by forcebound identify.");
  lines.add_comment("They hold for the device as it was: in that part of its workspace, as warm as it was.");
  if (!findings.complete()) lines.add_comment("NOT COMPLETE: no law can use this file.");
  for (const std::string& refusal : findings.refusals(declared.cartesian)) lines.add_comment("No bound: " + refusal);
  lines.raw(declared.cartesian ? "kind = \"cartesian\"" : "kind = \"arm\"");
  lines.raw("degrees_of_freedom = " + std::to_string(declared.degrees_of_freedom()));
  write_joints(lines, findings, declared.cartesian, confidence);
  lines.fact("force_N_max", text::to_text(declared.force_N_max), "as the driver says; " + force_words(findings));
  lines.fact("period_s", text::to_text(declared.period_s), "of the ticks here");
  write_times(lines, findings, declared, confidence);
  write_uncertainty(lines, findings, declared);
  return lines.text();
}

std::string findings_text(const Findings& findings, const control::DeviceFacts& declared) {
  const bool cartesian = declared.cartesian;
  const char* const joint_title = cartesian ? "axis" : "joint";
  const char* const force_unit = cartesian ? "N" : "N m";
  const char* const damping_unit = cartesian ? "N s/m" : "N m s/rad";
  text::Table motion({{joint_title},
                      {"encoder step", cartesian ? "um" : "urad"},
                      {"moves at", force_unit},
                      {"mass", cartesian ? "kg" : "kg m^2"},
                      {"motor's gain", "%"},
                      {"largest push", force_unit},
                      {"of it arrived", "%"}});
  text::Table losses({{joint_title},
                      {"damping", damping_unit},
                      {"lower bound", damping_unit},
                      {"friction", force_unit},
                      {"lower bound", force_unit}});
  for (std::size_t i = 0; i < findings.joints.size(); ++i) {
    const JointFindings& joint = findings.joints[i];
    const EnergyBalance& balance = joint.balance;
    const std::string number = std::to_string(i + 1);
    const auto bound = [](const LowerBound& b) { return b.refused.empty() ? rounded(b.bound) : std::string("-"); };
    const auto gain = [&](const JointFindings& j) {
      if (!findings.gains_measured || !j.balance.damping.refused.empty()) return std::string("-");
      return rounded(100 + 100 * j.gain_share.least, 3) + " to " + rounded(100 + 100 * j.gain_share.most, 3);
    };
    motion.add({number, rounded(joint.encoder_step * 1e6), rounded(joint.break_away), rounded(balance.mass),
                gain(joint), rounded(balance.force.largest), range_words(balance.force)});
    losses.add({number, rounded(balance.damping.estimate), bound(balance.damping), rounded(balance.friction.estimate),
                bound(balance.friction)});
  }
  control::ClassicText out;
  out << motion.to_text() << '\n' << losses.to_text() << '\n';
  const auto time = [&](const char* name, const TimeBounds& bounds) {
    out << name;
    if (bounds.refused.empty()) {
      out << rounded(bounds.least_s * 1e6, 4) << " to " << rounded(bounds.most_s * 1e6, 4) << " us\n";
    } else {
      out << "no bound\n";
    }
  };
  time("latency    ", findings.latency);
  if (findings.releases) {
    time("hold time  ", findings.hold);
  } else {
    out << "hold time  it does not let go of a force by itself\n";
  }
  const ReadingFacts& readings = findings.readings;
  const auto share = [](std::uint64_t part, std::uint64_t all) {
    return rounded(100.0 * static_cast<double>(part) / static_cast<double>(std::max<std::uint64_t>(all, 1)), 2) + " %";
  };
  if (readings.late > 0) {
    out << "ticks      " << share(readings.late, readings.ticks) << " late, "
        << text::counted(readings.late_slides, "slide", "slides") << " repeated for that\n";
  }
  out << "readings   " << share(readings.failed, readings.ticks) << " failed, "
      << share(readings.repeated, readings.fast) << " of those in fast motion the same as the one before\n"
      << "at rest    readings up to " << rounded(readings.rest_steps, 2) << " steps apart\n"
      << "force      " << force_words(findings) << '\n';
  for (const std::string& refusal : findings.refusals(cartesian)) out << "no bound: " << refusal << '\n';
  return out.str();
}

std::string slides_csv(const Findings& findings, bool cartesian) {
  text::Table table(
      {{"joint"}, {"direction"}, {"speed"}, {"force"}, {"damping"}, {"friction"}, {"speed_unit"}, {"force_unit"}});
  for (std::size_t i = 0; i < findings.joints.size(); ++i) {
    const JointFindings& joint = findings.joints[i];
    for (const SlidePoint& point : joint.points) {
      table.add({std::to_string(i + 1), point.direction > 0 ? "1" : "-1", rounded(point.speed, 6),
                 rounded(point.force, 6), rounded(joint.balance.damping.least(), 6),
                 rounded(joint.balance.friction.least(), 6), cartesian ? "m/s" : "rad/s", cartesian ? "N" : "N m"});
    }
  }
  return table.to_csv();
}

}  // namespace forcebound::client::commands::identify
