#include "python/native/running_law.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "forcebound/text/numbers.hpp"
#include "python/native/fields.hpp"

namespace forcebound::python {
namespace {

double or_else(const py::object& tick, double standard, const char* name) {
  return tick.is_none() ? standard : number_from(tick, name);
}

double seconds_or_else(const py::object& tick, double standard, const char* name) {
  return tick.is_none() ? standard : seconds_from(tick, name);
}

/// Reports of the device, which may be before what they are counted from.
double report_or_else(const py::object& tick, double standard, const char* name) {
  constexpr double kMost_s = 1e6;
  const double seconds = or_else(tick, standard, name);
  if (tick.is_none() || std::abs(seconds) <= kMost_s) return seconds;
  throw py::value_error(std::string(name) + " must be -1e6 to 1e6 s, or None where the device does not tell, got " +
                        text::to_text(seconds));
}

}  // namespace

/// While a sequence runs, other Python threads do too; none of them may use this law.
class RunningLaw::InUse {
 public:
  explicit InUse(std::atomic<bool>& flag) : flag_(flag) {
    if (flag_.exchange(true)) throw std::runtime_error("this law runs in another thread: a law has one owner");
  }
  ~InUse() { flag_ = false; }
  InUse(const InUse&) = delete;
  InUse& operator=(const InUse&) = delete;

 private:
  std::atomic<bool>& flag_;
};

RunningLaw::RunningLaw(control::DeviceFacts facts, const std::string& name, control::LawOptions options)
    : law_(std::move(facts), name, std::move(options)), request_N_(Vector::Zero(law_.facts().degrees_of_freedom())) {}

void RunningLaw::read_joints(py::handle position, const Tick& tick) {
  const control::DeviceFacts& facts = law_.facts();
  control::Motion& motion = law_.motion();
  motion.position = vector_from(position, facts.degrees_of_freedom(), "position");
  if (facts.cartesian) return;
  if (tick.joint.is_none() || tick.jacobian.is_none()) {
    throw py::value_error("joint and jacobian: expected both, as device '" + facts.name + "' is not Cartesian");
  }
  motion.joint = vector_from(tick.joint, facts.joints(), "joint");
  motion.jacobian = matrix_from(tick.jacobian, facts.degrees_of_freedom(), facts.joints(), "jacobian");
}

py::array_t<double> RunningLaw::step(py::handle position, py::handle request_N, const Tick& tick) {
  const InUse in_use(in_use_);
  const control::DeviceFacts& facts = law_.facts();
  // All is read before anything of the law changes.
  if (!request_N.is_none()) request_N_ = vector_from(request_N, facts.degrees_of_freedom(), "request_N");
  const double interval_s = or_else(tick.interval_s, law_.begun() ? facts.period_s : 0, "interval_s");
  const double latency_s = seconds_or_else(tick.latency_s, facts.latency_s, "latency_s");
  const double latency_s_max = seconds_or_else(tick.latency_s_max, facts.latency_s, "latency_s_max");
  const double effect_s = report_or_else(tick.effect_s, control::Motion{}.effect_s, "effect_s");
  const double held_s = report_or_else(tick.held_s, control::Motion{}.held_s, "held_s");
  read_joints(position, tick);
  control::Motion& motion = law_.motion();
  motion.interval_s = interval_s;
  motion.latency_s = latency_s;
  motion.latency_s_max = latency_s_max;
  motion.effect_s = effect_s;
  motion.held_s = held_s;
  motion.write_failed = tick.write_failed;
  return array_of(request_N.is_none() ? law_.release() : law_.tick(request_N_));
}

/// A recorded sequence, checked before its first tick.
class RunningLaw::Sequence {
 public:
  Sequence(const control::DeviceFacts& facts, py::handle positions, py::handle requests_N, const Recorded& recorded)
      : positions_(positions, {facts.degrees_of_freedom()}, "positions"),
        requests_N_(requests_N, {facts.degrees_of_freedom()}, "requests_N") {
    expect_as_many(requests_N_, size(), "requests_N");
    const bool all_alike =
        recorded.intervals_s.is_none() || doubles_from(recorded.intervals_s, "intervals_s").ndim() == 0;
    if (all_alike) {
      interval_s_ = or_else(recorded.intervals_s, facts.period_s, "intervals_s");
    } else {
      intervals_s_.emplace(one_each(recorded.intervals_s, "intervals_s"));
    }
    if (!recorded.latencies_s.is_none()) store_latencies(recorded.latencies_s);
    if (facts.cartesian) return;
    if (recorded.joints.is_none() || recorded.jacobians.is_none()) {
      throw py::value_error("joints and jacobians: expected both, as device '" + facts.name + "' is not Cartesian");
    }
    joints_.emplace(recorded.joints, std::vector<py::ssize_t>{facts.joints()}, "joints");
    jacobians_.emplace(recorded.jacobians, std::vector<py::ssize_t>{facts.degrees_of_freedom(), facts.joints()},
                       "jacobians");
    expect_as_many(*joints_, size(), "joints");
    expect_as_many(*jacobians_, size(), "jacobians");
  }

  [[nodiscard]] py::ssize_t size() const noexcept { return positions_.size(); }

  void read(py::ssize_t row, control::Motion& motion, Vector& request_N) const noexcept {
    positions_.read(row, motion.position);
    requests_N_.read(row, request_N);
    if (joints_) {
      joints_->read(row, motion.joint);
      jacobians_->read(row, motion.jacobian);
    }
    motion.interval_s = intervals_s_ ? intervals_s_->read(row) : interval_s_;
    if (!latencies_s_) return;
    motion.latency_s = latencies_s_->read(row);
    if (row + 1 < size()) motion.latency_s_max = latencies_s_->read(row + 1);
  }

  void store_latencies(const py::object& values) {
    latencies_s_.emplace(one_each(values, "latencies_s"));
    for (py::ssize_t row = 0; row < size(); ++row) {
      const double latency_s = latencies_s_->read(row);
      if (latency_s >= 0 && latency_s <= 1e6) continue;
      throw py::value_error("latencies_s must be 0 to 1e6 s, got " + text::to_text(latency_s) + " in row " +
                            std::to_string(row));
    }
  }

  [[nodiscard]] bool has_intervals() const noexcept { return intervals_s_.has_value(); }

 private:
  [[nodiscard]] Rows one_each(const py::object& values, const char* name) const {
    Rows rows(values, {}, name);
    expect_as_many(rows, size(), name);
    return rows;
  }

  Rows positions_;
  Rows requests_N_;
  double interval_s_ = 0;
  std::optional<Rows> intervals_s_;
  std::optional<Rows> latencies_s_;
  std::optional<Rows> joints_;
  std::optional<Rows> jacobians_;
};

py::tuple RunningLaw::run(py::handle positions, py::handle requests_N, const Recorded& recorded) {
  const Sequence sequence(law_.facts(), positions, requests_N, recorded);
  const InUse in_use(in_use_);
  const auto dof = static_cast<py::ssize_t>(law_.facts().degrees_of_freedom());
  py::array_t<double> forces_N({sequence.size(), dof});
  py::array_t<double> energies_J(sequence.size());
  py::array_t<double> xis(sequence.size());
  double* force_at = forces_N.mutable_data();
  double* energy_at = energies_J.mutable_data();
  double* xi_at = xis.mutable_data();
  {
    const py::gil_scoped_release others_run;
    law_.time_by_facts();
    for (py::ssize_t row = 0; row < sequence.size(); ++row) {
      sequence.read(row, law_.motion(), request_N_);
      if (!law_.begun() && !sequence.has_intervals()) law_.motion().interval_s = 0;
      const Vector force_N = law_.tick(request_N_);
      for (Eigen::Index i = 0; i < force_N.rows(); ++i) *force_at++ = force_N[i];
      *energy_at++ = law_.bounder().law().energy_J();
      *xi_at++ = law_.bounder().law().xi();
    }
  }
  return py::make_tuple(forces_N, energies_J, xis);
}

py::array_t<double> RunningLaw::confirm(py::handle force_N, double latency_s) {
  const InUse in_use(in_use_);
  const Vector force = vector_from(force_N, law_.facts().degrees_of_freedom(), "force_N");
  if (!force.allFinite()) throw py::value_error("force_N must be finite");
  return array_of(law_.bounder().confirmed(force, latency_s));
}

void RunningLaw::receive(py::handle numbers) {
  const InUse in_use(in_use_);
  law_.bounder().receive(server_law_numbers_from(numbers));
}

py::array_t<double> RunningLaw::outgoing() const {
  const InUse in_use(in_use_);
  const control::ServerLawNumbers numbers = law_.bounder().law().outgoing();
  return array_of(numbers.data(), numbers.rows());
}

void RunningLaw::begin_server_side() {
  const InUse in_use(in_use_);
  law_.bounder().begin_server_side();
}

double RunningLaw::energy_J() const {
  const InUse in_use(in_use_);
  return law_.bounder().law().energy_J();
}

double RunningLaw::xi() const {
  const InUse in_use(in_use_);
  return law_.bounder().law().xi();
}

py::dict RunningLaw::counts() const {
  const InUse in_use(in_use_);
  const control::ForceBounder::Counts& c = law_.bounder().counts();
  py::dict counts;
  counts["requests_not_finite"] = c.requests_not_finite;
  counts["readings_not_finite"] = c.readings_not_finite;
  counts["readings_too_far"] = c.readings_too_far;
  counts["writes_failed"] = c.writes_failed;
  counts["effects_outside_facts"] = c.effects_outside_facts;
  counts["releases_outside_facts"] = c.releases_outside_facts;
  counts["intervals_impossible"] = c.intervals_impossible;
  counts["saturated"] = c.saturated;
  counts["forces_not_finite"] = c.forces_not_finite;
  counts["withdrawn"] = c.withdrawn;
  return counts;
}

}  // namespace forcebound::python
