#pragma once

#include <memory>
#include <optional>
#include <string>

#include "forcebound/record/recording_writer.hpp"
#include "python/native/own_environment.hpp"
#include "python/native/own_hand.hpp"
#include "python/native/own_law.hpp"
#include "python/native/tables.hpp"
#include "tests/tools/sim/closed_loop.hpp"

namespace forcebound::python {

/// Writes a recording of a simulated loop, as the client does of a real one.
class RecordingTap final : public record::TickSink {
 public:
  void begin(const std::string& file, const record::RunInfo& info) { writer_.emplace(file, info); }
  void on_tick(const record::TickRecord& tick) noexcept override {
    if (writer_) writer_->write(tick);
  }
  void on_force(const record::ForceRecord& force) noexcept override {
    if (writer_) writer_->write(force);
  }
  /// @throws std::runtime_error if not all of it could be written
  void finish(const record::RunTotals& totals);

 private:
  std::optional<record::RecordingWriter> writer_;
};

/// sim::ClosedLoop with tables of its ticks and forces, and with law, environment or hand in Python.
class PythonLoop {
 public:
  struct Parts {
    std::shared_ptr<OwnLaw::Shared> own_law{};
    std::shared_ptr<OwnEnvironment::Shared> own_environment{};
    std::shared_ptr<OwnHand::Shared> own_hand{};
  };

  /// @throws what sim::ClosedLoop does; std::runtime_error if the recording cannot be created
  PythonLoop(sim::ClosedLoop::Settings settings, Parts parts, const std::string& recording);

  /// Goes on for that time. Other Python threads run meanwhile, and Ctrl-C ends it.
  /// @throws py::value_error unless the duration is 0 to 1e6 s; the first exception of a law, environment or hand in
  /// Python
  void run(py::handle duration_s);

  /// The ticks and forces since the last time; also of a loop that was closed, when forces still came.
  py::tuple take();

  /// Ends the session; the summary as JSON. Idempotent.
  std::string close();

  [[nodiscard]] double time_s() const noexcept { return time::to_seconds(end_); }
  /// Not while it runs in another thread. @throws std::runtime_error
  [[nodiscard]] py::dict truth();

 private:
  class Running;

  void check();

  Parts parts_;
  LoopTables tables_;
  RecordingTap tap_;
  sim::ClosedLoop loop_;
  time::Nanoseconds end_{0};
  bool running_ = false;
  std::optional<std::string> summary_;
};

}  // namespace forcebound::python
