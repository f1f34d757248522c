#include "forcebound/server/app/recording_observer.hpp"

#include <spdlog/spdlog.h>

#include <chrono>
#include <utility>

namespace forcebound::server {
namespace {

constexpr std::chrono::milliseconds kDrainPeriod{100};

}  // namespace

RecordingObserver::RecordingObserver(const time::Clock& clock, const std::string& file, const record::RunInfo& info)
    : LogObserver(clock),
      clock_(clock),
      file_(file),
      writer_(file, info),
      thread_([this](const std::stop_token& stopping) {
        while (!stopping.stop_requested()) {
          recorder_.drain(writer_);
          if (const std::string fault = watch_.take(recorder_, writer_); !fault.empty()) {
            spdlog::error("{}; the server goes on", fault);
          }
          std::this_thread::sleep_for(kDrainPeriod);
        }
      }) {}

RecordingObserver::~RecordingObserver() { RecordingObserver::finish(); }

bool RecordingObserver::finish() {
  if (std::exchange(finished_, true)) return complete_;
  thread_.request_stop();
  thread_.join();
  recorder_.drain(writer_);
  writer_.flush();
  record::RunTotals totals;
  totals.recording_dropped = recorder_.dropped();
  totals.recording_unwritten = writer_.unwritten();
  if (!writer_.problem().empty()) totals.notes.push_back(writer_.problem());
  writer_.finish(totals);
  if (const auto missing = totals.recording_dropped + totals.recording_unwritten; missing > 0) {
    spdlog::error("{} records are missing in '{}' {}", missing, file_, writer_.problem());
  }
  complete_ = totals.recording_dropped + writer_.unwritten() == 0 && writer_.problem().empty();
  return complete_;
}

void RecordingObserver::on_motion(const wire::MotionSample& motion) noexcept {
  recorder_.on_motion({.receive_time = clock_.now(), .motion = motion});
}

void RecordingObserver::on_force(const wire::EnvironmentForce& force) noexcept { recorder_.on_sent({.force = force}); }

}  // namespace forcebound::server
