#include <optional>

#include "forcebound/record/recording_reader.hpp"
#include "forcebound/record/summary.hpp"
#include "tests/fuzz/input.hpp"

namespace forcebound::fuzz {
namespace {

/// As `forcebound report` does.
class ReportedRun final : public record::RecordingSink {
 public:
  void on_start(const record::RunInfo& info) override { summary_.emplace(info); }
  void on_end(const record::RunTotals& totals) override { summary_->finish(totals); }
  void on_tick(const record::TickRecord& tick) noexcept override { summary_->on_tick(tick); }
  void on_force(const record::ForceRecord& force) noexcept override { summary_->on_force(force); }

  void report() const {
    if (!summary_) return;
    (void)summary_->to_json();
    for (const char letter : summary_->to_text()) {
      must(letter == '\n' || static_cast<unsigned char>(letter) >= ' ', "a control character in the summary");
    }
  }

 private:
  std::optional<record::Summary> summary_;
};

}  // namespace

void fuzz_recording(Bytes bytes) {
  static InputFile file("run.mcap");
  file.replace(bytes);
  ReportedRun run;
  may_refuse([&] { (void)record::read_recording(file.path(), run); });
  run.report();
}

}  // namespace forcebound::fuzz
