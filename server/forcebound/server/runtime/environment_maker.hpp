#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <list>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>

#include "forcebound/server/offer/environment_library.hpp"

namespace forcebound::server {

/// Makes the environments that clients request from a library, on a thread of its own, one after the other. Without it
/// the library makes them in the calling thread.
class EnvironmentMaker {
 public:
  /// @param failed called with the environment's name and the reason, in the library's own thread
  EnvironmentMaker(EnvironmentLibrary library, std::function<void(std::string_view name, std::string_view why)> failed);
  ~EnvironmentMaker();
  EnvironmentMaker(const EnvironmentMaker&) = delete;
  EnvironmentMaker& operator=(const EnvironmentMaker&) = delete;

  /// Gives the results to the library; to be called in the library's own thread.
  void deliver();

 private:
  void run(const std::stop_token& stop);

  EnvironmentLibrary library_;
  std::function<void(std::string_view, std::string_view)> failed_;
  std::mutex guard_;  // of the two lists
  std::condition_variable_any wanted_changed_;
  std::deque<EnvironmentLibrary::Later> wanted_;
  struct Outcome {
    std::string name;
    std::optional<EnvironmentKind> made{};  // nothing: failed
    std::string why_not{};
  };
  std::list<Outcome> outcomes_;  // whose nodes are made before there may be no memory for them
  std::jthread thread_;          // last: ends before what it uses
};

}  // namespace forcebound::server
