#pragma once

#include <string>
#include <thread>

#include "forcebound/record/recorder.hpp"
#include "forcebound/record/recording_writer.hpp"
#include "forcebound/server/app/log_observer.hpp"

namespace forcebound::server {

/// Logs who comes and goes, and writes every motion answered and every force sent to a recording.
///
/// The server's thread only hands records to a queue; a thread of its own writes them. A disk that fails ends the
/// recording, not the server.
class RecordingObserver final : public LogObserver {
 public:
  /// @throws std::runtime_error if the file cannot be created.
  RecordingObserver(const time::Clock& clock, const std::string& file, const record::RunInfo& info);

  /// Writes what is left and says in the log what is missing.
  ~RecordingObserver() override;

  void on_motion(const wire::MotionSample& motion) noexcept override;
  void on_force(const wire::EnvironmentForce& force) noexcept override;

 private:
  const time::Clock& clock_;
  std::string file_;
  record::RecordingWriter writer_;  // the thread's, until it has ended
  record::Recorder recorder_;
  std::jthread thread_;
};

}  // namespace forcebound::server
