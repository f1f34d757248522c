#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "forcebound/server/environment/scene_library.hpp"

namespace forcebound::server {

/// Compiles what clients ask a library for, on a thread of its own, one scene after the other. Without it the library
/// compiles while its asker waits.
class SceneCompiler {
 public:
  /// @param failed is told the scene and the reason, by the library's own thread
  SceneCompiler(SceneLibrary library, std::function<void(std::string_view scene, std::string_view why)> failed);
  ~SceneCompiler();
  SceneCompiler(const SceneCompiler&) = delete;
  SceneCompiler& operator=(const SceneCompiler&) = delete;

  /// Tells the library what came of it meanwhile; to be called by the library's own thread.
  void deliver();

 private:
  void run(const std::stop_token& stop);

  SceneLibrary library_;
  std::function<void(std::string_view, std::string_view)> failed_;
  std::mutex guard_;  // of the two lists
  std::condition_variable_any wanted_changed_;
  std::deque<SceneLibrary::Compilation> wanted_;
  struct Outcome {
    std::string name;
    std::shared_ptr<const scene::Scene> scene{};  // null: not had
    std::string why_not{};
  };
  std::vector<Outcome> outcomes_;
  std::jthread thread_;  // last: ends before what it uses
};

}  // namespace forcebound::server
