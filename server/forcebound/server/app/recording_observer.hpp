#pragma once

#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "forcebound/record/recorder.hpp"
#include "forcebound/record/recording_watch.hpp"
#include "forcebound/record/recording_writer.hpp"
#include "forcebound/scene/scene.hpp"
#include "forcebound/server/app/log_observer.hpp"
#include "forcebound/server/environment/scene_library.hpp"

namespace forcebound::server {

/// Logs clients that connect and leave, and writes every motion answered and every force sent to a recording.
///
/// The server's thread only puts records into a queue; another thread writes them. Each scene that a session has is in
/// the recording too, as its file and as pictures of it show it where it begins. A failing disk ends the recording,
/// not the server, and is logged at once.
class RecordingObserver final : public LogObserver {
 public:
  /// What sessions can have.
  struct Scenes {
    SceneLibrary library{};
    std::string text{};  ///< the file of the scene that `RunInfo::scene` names; empty: there is none
  };

  /// @throws std::runtime_error if the file cannot be created.
  RecordingObserver(const time::Clock& clock, const std::string& file, const record::RunInfo& info, Scenes scenes);

  ~RecordingObserver() override;

  /// Writes the remaining records and logs how many are missing, once. @returns whether none are
  bool finish() override;

  void on_opened(const SessionInfo& info) override;
  void on_motion(const wire::MotionSample& motion) noexcept override;
  void on_force(const wire::EnvironmentForce& force) noexcept override;

 private:
  struct UsedScene {
    std::string name;
    std::shared_ptr<const scene::Scene> scene;  ///< as pictures show it; null: it is none of the library
  };

  void queue_scene(const std::string& name);
  void write_scenes();

  const time::Clock& clock_;
  Scenes scenes_;
  std::string first_scene_;
  std::set<std::string> reported_;  // of who calls on_opened, one thread at a time
  std::mutex waiting_mutex_;
  std::vector<UsedScene> waiting_{};  // for the thread that writes
  std::string file_;
  record::RecordingWriter writer_;  // used by the thread until it ends
  record::Recorder recorder_;
  record::RecordingWatch watch_;
  bool finished_ = false;
  bool complete_ = true;
  std::jthread thread_;
};

}  // namespace forcebound::server
