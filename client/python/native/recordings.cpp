#include "forcebound/record/recording_reader.hpp"

#include <pybind11/stl.h>

#include <optional>
#include <stdexcept>
#include <string>

#include "forcebound/record/run_info.hpp"
#include "forcebound/record/summary.hpp"
#include "python/native/bindings.hpp"
#include "python/native/tables.hpp"

namespace forcebound::python {
namespace {

/// All that a recording has; makes no use of Python before `to_python`.
class RecordedTables final : public record::RecordingSink {
 public:
  void on_start(const record::RunInfo& info) override {
    info_ = info;
    summary_.emplace(info);
  }
  void on_end(const record::RunTotals& totals) override {
    totals_ = totals;
    if (summary_) summary_->finish(totals);
  }
  void on_tick(const record::TickRecord& tick) noexcept override {
    loop_.on_tick(tick);
    if (summary_) summary_->on_tick(tick);
  }
  void on_force(const record::ForceRecord& force) noexcept override {
    loop_.on_force(force);
    if (summary_) summary_->on_force(force);
  }
  void on_motion(const record::MotionRecord& motion) override { motions_.add(motion); }
  void on_sent(const record::SentForceRecord& force) override { sent_.add(force); }

  /// @throws as LoopTables::rethrow
  [[nodiscard]] py::dict to_python() {
    loop_.rethrow();
    py::dict read;
    read["info"] = record::to_key_values(info_);
    read["totals"] = totals_ ? py::cast(record::to_key_values(*totals_)) : py::none();
    read["summary"] = summary_ && loop_.has_ticks() ? py::cast(summary_->to_json()) : py::none();
    read["ticks"] = loop_.take_ticks();
    read["forces"] = loop_.take_forces();
    read["motions"] = motions_.take();
    read["sent"] = sent_.take();
    return read;
  }

 private:
  record::RunInfo info_;
  std::optional<record::RunTotals> totals_;
  std::optional<record::Summary> summary_;
  LoopTables loop_;
  Table<record::MotionRecord> motions_{motion_columns()};
  Table<record::SentForceRecord> sent_{sent_columns()};
};

/// What the recording has, as "complete" whether that is all, and as "flaw" what is missing.
py::dict read(const std::string& file) {
  RecordedTables tables;
  record::mcap::Ending ending;
  {
    const py::gil_scoped_release others_run;
    try {
      ending = record::read_recording(file, tables);
    } catch (const std::runtime_error& malformed) {
      throw std::invalid_argument(malformed.what());  // a ValueError in Python
    }
  }
  py::dict all = tables.to_python();
  all["complete"] = static_cast<bool>(ending);
  all["flaw"] = record::mcap::in_words(ending);
  return all;
}

}  // namespace

void bind_recordings(py::module_& module) {
  module.def("read_recording", &read, py::arg("file"));
  // As the enumerations of session_state.hpp and tick_record.hpp.
  module.attr("session_states") = py::make_tuple("connecting", "active", "stale", "reconnecting");
  module.attr("force_policies") = py::make_tuple("none", "fresh", "fading", "dropped");
  module.attr("force_origins") = py::make_tuple("held", "at_client", "both");
}

}  // namespace forcebound::python
