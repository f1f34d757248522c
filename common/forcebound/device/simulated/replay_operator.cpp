#include "forcebound/device/simulated/replay_operator.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "forcebound/device/simulated/likely_units.hpp"
#include "forcebound/text/lines.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/terminal.hpp"

namespace forcebound::device {
namespace {

constexpr Hand kReplayHand{.mass_kg = 0, .stiffness_N_per_m = 300, .damping_N_s_per_m = 3};

std::string shown(std::string_view line) { return "'" + std::string(line.substr(0, 80)) + "'"; }

class MotionReader {
 public:
  MotionReader(std::istream& text, const std::string& place, int dof) : lines_(text, place), dof_(dof) {}

  std::vector<MotionSample> read() {
    check_header();
    std::vector<MotionSample> motion;
    while (lines_.next()) {
      const std::string_view line = lines_.line();
      if (line.empty()) continue;
      motion.push_back(parse_row(line));
      if (motion.size() > 1 && !(motion.back().time_s > motion[motion.size() - 2].time_s)) {
        lines_.refuse("time_s must increase from row to row, got " + shown(line));
      }
    }
    if (motion.size() < 2) lines_.refuse("needs at least two rows, got " + std::to_string(motion.size()));
    const double start = motion.front().time_s;
    for (MotionSample& sample : motion) sample.time_s -= start;
    return motion;
  }

 private:
  void check_header() {
    static constexpr std::string_view kColumns = "time_s,x_m,y_m,z_m";
    if (dof_ > 3) {
      lines_.refuse("a recorded hand has at most 3 degrees of freedom, the device has " + std::to_string(dof_));
    }
    const std::string_view needed =
        kColumns.substr(0, kColumns.find("_m", 0) + 2 + 4 * static_cast<std::size_t>(dof_ - 1));
    const std::string_view header = lines_.next() ? lines_.line() : "";
    if (header == needed || header.starts_with(std::string(needed) + ",")) return;
    lines_.refuse("the header must begin with '" + std::string(needed) + "' for " +
                  text::counted(static_cast<std::uint64_t>(dof_), "degree of freedom", "degrees of freedom") +
                  ", got " + shown(header));
  }

  MotionSample parse_row(std::string_view line) const {
    const std::vector<std::string_view> fields = text::split(line, ',');
    const auto number = [&](int column) {
      const auto at = static_cast<std::size_t>(column);
      const auto value = at < fields.size() ? text::finite_number(fields[at]) : std::nullopt;
      if (!value) lines_.refuse("expected " + std::to_string(dof_ + 1) + " finite numbers, got " + shown(line));
      return *value;
    };
    MotionSample sample{.time_s = number(0), .position = Vector(dof_)};
    for (int i = 0; i < dof_; ++i) sample.position[i] = number(i + 1);
    return sample;
  }

  text::LineReader lines_;
  int dof_;
};

// Slope at the middle one of three samples of the parabola through them.
Vector parabola_slope(const MotionSample& a, const MotionSample& b, const MotionSample& c) {
  const double before = b.time_s - a.time_s;
  const double after = c.time_s - b.time_s;
  const Vector first = (b.position - a.position) / before;
  const Vector second = (c.position - b.position) / after;
  return (after * first + before * second) / (before + after);
}

std::string doubt_of(const std::vector<MotionSample>& motion) {
  RecordedPace pace;
  for (std::size_t i = 1; i < motion.size(); ++i) {
    pace.add_row(motion[i].time_s - motion[i - 1].time_s, (motion[i].position - motion[i - 1].position).norm());
  }
  return pace.doubt_of_units();
}

}  // namespace

std::vector<MotionSample> parse_motion(std::string_view csv_text, const std::string& place, int dof) {
  std::istringstream text{std::string(csv_text)};
  return MotionReader(text, place, dof).read();
}

ReplayOperator::ReplayOperator(OperatorSettings settings, int dof, std::vector<MotionSample> motion)
    : SpecifiedOperator(settings, dof, kReplayHand), motion_(std::move(motion)) {
  const double scale = settings.number("scale", OperatorSettings::Allowed::any, 1);
  const Vector offset = settings.offset(dof);
  finish(settings);
  for (MotionSample& sample : motion_) sample.position = scale * sample.position + offset;
  doubt_ = doubt_of(motion_);
  if (!doubt_.empty()) add_to_description("; it " + doubt_);
  velocity_.assign(motion_.size(), Vector::Zero(dof));
  for (std::size_t i = 1; i + 1 < motion_.size(); ++i) {
    velocity_[i] = parabola_slope(motion_[i - 1], motion_[i], motion_[i + 1]);
  }
}

Operator::Target ReplayOperator::target(double time_s) const noexcept {
  const double length = motion_.back().time_s;
  const double phase = std::fmod(std::max(time_s, 0.0), 2 * length);
  const bool backwards = phase > length;
  const double at = backwards ? 2 * length - phase : phase;

  const auto after = std::upper_bound(motion_.begin() + 1, motion_.end() - 1, at,
                                      [](double t, const MotionSample& sample) { return t < sample.time_s; });
  const auto end = static_cast<std::size_t>(after - motion_.begin());
  const MotionSample& a = motion_[end - 1];
  const MotionSample& b = motion_[end];
  const double h = b.time_s - a.time_s;
  const double s = std::clamp((at - a.time_s) / h, 0.0, 1.0);
  const Vector slope = (b.position - a.position) / h;
  const Vector& v0 = velocity_[end - 1];
  const Vector& v1 = velocity_[end];
  const Vector square = 3 * slope - 2 * v0 - v1;
  const Vector cube = v0 + v1 - 2 * slope;

  Target target;
  target.position = a.position + (h * s) * (v0 + s * (square + s * cube));
  target.velocity = (backwards ? -1.0 : 1.0) * (v0 + s * (2 * square + 3 * s * cube));
  return target;
}

}  // namespace forcebound::device
