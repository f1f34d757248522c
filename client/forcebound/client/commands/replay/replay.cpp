#include "forcebound/client/commands/replay/replay.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <ostream>
#include <stdexcept>

#include "forcebound/client/commands/replay/csv_reader.hpp"
#include "forcebound/control/classic_text.hpp"
#include "forcebound/control/force_bounder.hpp"
#include "forcebound/control/law_registry.hpp"
#include "forcebound/text/file.hpp"

namespace forcebound::client::commands {
namespace {

using control::DeviceFacts;
using control::Matrix;
using control::Vector;

template <typename... Parts>
[[noreturn]] void refuse_option(const Parts&... parts) {
  throw std::invalid_argument(control::joined(parts...));
}

std::string numbered(const std::string& before, Eigen::Index axis, const std::string& after) {
  return before + std::to_string(axis) + after;
}

std::vector<std::string> input_columns(Eigen::Index axes) {
  std::vector<std::string> columns{"time_s"};
  for (Eigen::Index i = 0; i < axes; ++i) columns.push_back(numbered("x", i, "_m"));
  for (Eigen::Index i = 0; i < axes; ++i) columns.push_back(numbered("fe", i, "_N"));
  return columns;
}

Eigen::Index axes_of(const std::vector<std::string>& header, const CsvReader& reader) {
  for (Eigen::Index axes = 1; axes <= control::kDofMax; ++axes) {
    if (header == input_columns(axes)) return axes;
  }
  std::string got = header.front();
  for (std::size_t i = 1; i < header.size(); ++i) got.append(",").append(header[i]);
  reader.refuse("expected the header time_s,x0_m[,x1_m..],fe0_N[,fe1_N..] for 1 to 6 axes, got '" + got.substr(0, 100) +
                "'" + (header.front().empty() ? ", whose first column has no name (pandas: to_csv(index=False))" : ""));
}

std::string counted(Eigen::Index count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

/// One number per axis, from one per axis, one for all, or none.
Vector per_axis(const char* option, const std::vector<double>& values, Eigen::Index axes) {
  if (values.empty()) return Vector::Zero(axes);
  if (values.size() == 1) return Vector::Constant(axes, values.front());
  if (values.size() != static_cast<std::size_t>(axes)) {
    refuse_option(option, " has ", values.size(), " values, but the input has ", counted(axes, "axis", "axes"),
                  ": give one for all or one for each");
  }
  return Vector::Map(values.data(), axes);
}

Matrix damping_of(const ReplayOptions& options, Eigen::Index axes) {
  if (!options.damping_matrix) {
    if (options.damping_N_s_per_m.empty()) refuse_option("--damping or --damping-matrix must be given");
    return per_axis("--damping", options.damping_N_s_per_m, axes).asDiagonal();
  }
  const auto& rows = *options.damping_matrix;
  Matrix damping(axes, axes);
  if (rows.size() != static_cast<std::size_t>(axes)) {
    refuse_option("--damping-matrix has ", rows.size(), " rows, but the input has ", counted(axes, "axis", "axes"));
  }
  for (Eigen::Index i = 0; i < axes; ++i) {
    const auto& row = rows[static_cast<std::size_t>(i)];
    if (row.size() != rows.size()) {
      refuse_option("--damping-matrix: row ", i + 1, " must have ", axes, " numbers, got ", row.size());
    }
    damping.row(i) = Vector::Map(row.data(), axes).transpose();
  }
  return damping;
}

void refuse_nonsense(const ReplayOptions& options) {
  const auto finite_above = [](double value) { return value > 0 && std::isfinite(value); };
  const auto at_least_zero = [](double value) { return value >= 0 && std::isfinite(value); };
  if (!finite_above(options.period_s)) refuse_option("--period must be > 0 s, got ", options.period_s);
  if (options.hold_s && !finite_above(*options.hold_s)) refuse_option("--hold must be > 0 s, got ", *options.hold_s);
  if (!at_least_zero(options.latency_s)) refuse_option("--latency must be >= 0 s, got ", options.latency_s);
  if (!(options.force_N_max >= 0)) refuse_option("--force-max must be >= 0 N, got ", options.force_N_max);
  for (const double step_m : options.encoder_step_m) {
    if (!at_least_zero(step_m)) refuse_option("--encoder must be >= 0 m, got ", step_m);
  }
  for (const double friction_N : options.friction_N) {
    if (!at_least_zero(friction_N)) refuse_option("--friction must be >= 0 N, got ", friction_N);
  }
}

DeviceFacts facts_of(const ReplayOptions& options, Eigen::Index axes) {
  DeviceFacts facts;
  facts.name = "replay";
  facts.period_s = options.period_s;
  facts.damping = damping_of(options, axes);
  facts.friction = per_axis("--friction", options.friction_N, axes);
  facts.encoder_step = per_axis("--encoder", options.encoder_step_m, axes);
  facts.actuator_step = Vector::Zero(axes);
  facts.force_N_max = options.force_N_max;
  facts.hold_s_max = options.hold_s.value_or(options.period_s);
  // The device releases the force only if a hold time is given.
  facts.releases = options.hold_s.has_value();
  facts.latency_s = options.latency_s;
  return facts;
}

control::Damping checked_damping(const ReplayOptions& options, const DeviceFacts& facts) {
  try {
    return control::Damping::from_matrix(facts.damping);
  } catch (const std::invalid_argument& error) {
    refuse_option(options.damping_matrix ? "--damping-matrix: " : "--damping: ", error.what());
  }
}

void write_number(std::string& line, double value) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::general, 17);
  line.append(digits.data(), end.ptr);
}

std::unique_ptr<control::PassivityLaw> checked_law(const ReplayOptions& options, const DeviceFacts& facts) {
  try {
    if (options.laws.find(options.law).make_server_side) {
      refuse_option("law '", options.law, "' has a server-side law, and rows have no server: it cannot be replayed");
    }
    return options.laws.make(options.law, facts, options.law_options);
  } catch (const std::invalid_argument& error) {
    refuse_option("--law: ", error.what());
  }
}

/// A whole line at once, so that the reader of a pipe never gets half of one.
void write_line(std::ostream& output, std::string line) {
  output << (line += '\n') << std::flush;
  if (!output) throw text::WriteError("the answer cannot be written");
}

std::string output_header(Eigen::Index axes) {
  std::string line = "time_s";
  for (Eigen::Index i = 0; i < axes; ++i) line += numbered(",f", i, "_N");
  return line + ",energy_J,xi";
}

std::string answer(double time_s, const Vector& force_N, const control::PassivityLaw& law) {
  std::string line;
  write_number(line, time_s);
  for (const double component_N : force_N) write_number(line += ',', component_N);
  write_number(line += ',', law.energy_J());
  write_number(line += ',', law.xi());
  return line;
}

/// `previous_s` is the time of the row before, if there is one.
double checked_interval_s(double time_s, std::optional<double> previous_s, const CsvReader& reader) {
  if (!std::isfinite(time_s)) reader.refuse("time_s must be finite");
  if (!previous_s) return 0;
  if (time_s < *previous_s) {
    std::string what = "time_s runs backwards: ";
    write_number(what, time_s);
    write_number(what += " after ", *previous_s);
    reader.refuse(what + "; it must stay or grow");
  }
  return time_s - *previous_s;
}

}  // namespace

ReplayCounts replay(const ReplayOptions& options, const ReplayInput& input, std::ostream& output) {
  refuse_nonsense(options);
  CsvReader reader(input.rows, input.name);
  const std::vector<std::string> columns = reader.header();
  const Eigen::Index axes = axes_of(columns, reader);
  const DeviceFacts facts = facts_of(options, axes);
  const control::Damping damping = checked_damping(options, facts);
  control::ForceBounder bounder(facts, checked_law(options, facts));

  control::Motion motion;
  motion.jacobian = Matrix::Identity(axes, axes);
  motion.damping = &damping;
  motion.latency_s = motion.latency_s_max = options.latency_s;
  write_line(output, output_header(axes));

  ReplayCounts counts;
  counts.pace = device::RecordedPace(options.period_s);
  std::optional<double> previous_s;
  Vector previous_m;
  for (auto row = reader.row(columns); !row.empty(); row = reader.row(columns)) {
    const double time_s = row.front();
    motion.interval_s = checked_interval_s(time_s, previous_s, reader);
    motion.position = motion.joint = Vector::Map(row.data() + 1, axes);
    const Vector force = bounder.tick(motion, Vector::Map(row.data() + 1 + axes, axes));
    write_line(output, answer(time_s, force, bounder.law()));
    if (previous_s) counts.pace.add_row(motion.interval_s, (motion.position - previous_m).norm());
    previous_s = time_s;
    previous_m = motion.position;
    ++counts.rows;
  }
  counts.requests_not_finite = bounder.counts().requests_not_finite;
  counts.readings_not_finite = bounder.counts().readings_not_finite;
  counts.intervals_impossible = bounder.counts().intervals_impossible;
  return counts;
}

}  // namespace forcebound::client::commands
