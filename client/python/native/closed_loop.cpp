#include "python/native/closed_loop.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "forcebound/record/run_info.hpp"
#include "python/native/fields.hpp"

namespace forcebound::python {
namespace {

using time::Nanoseconds;

/// Of virtual time, a few milliseconds of real time: so long Ctrl-C and an exception of Python code wait.
constexpr Nanoseconds kSlice = std::chrono::milliseconds{100};

}  // namespace

void RecordingTap::finish(const record::RunTotals& totals) {
  if (!writer_) return;
  writer_->finish(totals);
  const std::string problem = writer_->problem();
  writer_.reset();
  if (!problem.empty()) throw std::runtime_error("the recording is incomplete: " + problem);
}

/// A loop is used by one thread at a time, and not by its own law, environment or hand.
class PythonLoop::Running {
 public:
  explicit Running(bool& flag) : flag_(flag) {
    if (flag_)
      throw std::runtime_error("this loop runs already, in another thread or below its own law, environment or hand");
    flag_ = true;
  }
  ~Running() { flag_ = false; }
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;

 private:
  bool& flag_;
};

PythonLoop::PythonLoop(sim::ClosedLoop::Settings settings, Parts parts, const std::string& recording)
    : parts_(std::move(parts)), loop_(std::move(settings), {&tables_, &tap_}) {
  if (!recording.empty()) tap_.begin(recording, loop_.summary().info());
  check();
}

void PythonLoop::check() {
  if (parts_.own_law) parts_.own_law->fault.rethrow();
  if (parts_.own_environment) parts_.own_environment->fault.rethrow();
  if (parts_.own_hand) parts_.own_hand->fault.rethrow();
  tables_.rethrow();
}

void PythonLoop::run(py::handle duration_s) {
  if (summary_) throw std::runtime_error("this loop has ended: its summary was asked for");
  const Running running(running_);
  const Nanoseconds target = end_ + time::from_seconds(seconds_from(duration_s, "duration_s"));
  while (end_ < target) {
    end_ = std::min(end_ + kSlice, target);
    {
      const py::gil_scoped_release others_run;
      loop_.run_until(end_);
    }
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    check();
  }
}

py::tuple PythonLoop::take() {
  const Running not_running(running_);
  return py::make_tuple(tables_.take_ticks(), tables_.take_forces());
}

std::string PythonLoop::close() {
  if (summary_) return *summary_;
  const Running running(running_);
  const record::Summary& summary = loop_.close();
  check();
  summary_ = summary.to_json();
  tap_.finish(loop_.totals());
  return *summary_;
}

py::dict PythonLoop::truth() {
  const Running not_running(running_);
  const device::SimulatedDevice::Truth truth = loop_.device().truth();
  py::dict all;
  all["joint"] = array_of(truth.joint);
  all["joint_velocity"] = array_of(truth.joint_velocity);
  all["position"] = array_of(truth.position);
  all["velocity"] = array_of(truth.velocity);
  all["turning"] = array_of(truth.turning);
  return all;
}

}  // namespace forcebound::python
