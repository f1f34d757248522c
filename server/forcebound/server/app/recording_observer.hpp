#pragma once

#include <string>
#include <thread>

#include "forcebound/record/recorder.hpp"
#include "forcebound/record/recording_watch.hpp"
#include "forcebound/record/recording_writer.hpp"
#include "forcebound/server/app/log_observer.hpp"

namespace forcebound::server {

/// Logs clients that connect and leave, and writes every motion answered and every force sent to a recording.
///
/// The server's thread only puts records into a queue; another thread writes them. A failing disk ends the recording,
/// not the server, and is logged at once.
class RecordingObserver final : public LogObserver {
 public:
  /// @throws std::runtime_error if the file cannot be created.
  RecordingObserver(const time::Clock& clock, const std::string& file, const record::RunInfo& info);

  ~RecordingObserver() override;

  /// Writes the remaining records and logs how many are missing, once. @returns whether none are
  bool finish() override;

  void on_motion(const wire::MotionSample& motion) noexcept override;
  void on_force(const wire::EnvironmentForce& force) noexcept override;

 private:
  const time::Clock& clock_;
  std::string file_;
  record::RecordingWriter writer_;  // used by the thread until it ends
  record::Recorder recorder_;
  record::RecordingWatch watch_;
  bool finished_ = false;
  bool complete_ = true;
  std::jthread thread_;
};

}  // namespace forcebound::server
