#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "forcebound/server/environment/scene_library.hpp"

namespace forcebound::server {

/// Compiles the scenes that clients request from a library, on a thread of its own, one after the other. Without it the
/// library compiles in the calling thread.
class SceneCompiler {
 public:
  /// @param failed called with the scene and the reason, in the library's own thread
  SceneCompiler(SceneLibrary library, std::function<void(std::string_view scene, std::string_view why)> failed);
  ~SceneCompiler();
  SceneCompiler(const SceneCompiler&) = delete;
  SceneCompiler& operator=(const SceneCompiler&) = delete;

  /// Gives the results to the library; to be called in the library's own thread.
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
    std::shared_ptr<const scene::Scene> scene{};  // null: failed
    std::string why_not{};
  };
  std::list<Outcome> outcomes_;  // whose nodes are made before there may be no memory for them
  std::jthread thread_;          // last: ends before what it uses
};

}  // namespace forcebound::server
