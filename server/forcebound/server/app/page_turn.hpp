#pragma once

#include <optional>
#include <string>

#include "forcebound/page/page_server.hpp"
#include "forcebound/program/log.hpp"
#include "forcebound/server/app/led_robot.hpp"
#include "forcebound/server/app/options.hpp"
#include "forcebound/server/app/page_observer.hpp"
#include "forcebound/server/app/server_page.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "forcebound/server/runtime/server_workers.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::server {

/// The live page of a running server: a turn beside the server's own, on its thread. The log's lines are its events.
class PageTurn {
 public:
  /// Serves the page and prints its address. All must outlive it.
  /// @param robot that is served and shown; null: there is none
  /// @throws std::runtime_error if it cannot be served there
  /// @param scenes that sessions can have. @param scene what they get by default
  PageTurn(const ProgramOptions& options, PageObserver& observer, const time::Clock& clock, LedRobot* robot,
           const SceneLibrary& scenes, const std::string& scene);

  /// To be called after each turn of the server: twice a second it ends sessions as asked, and shows what is to those
  /// who look, the robot 30 times a second. While nobody does it costs nothing more.
  void turn(ServerWorkers& server);

 private:
  [[nodiscard]] std::optional<std::uint64_t> session_of(std::uint64_t shown, ServerWorkers& server) const;
  void show_robot(time::Nanoseconds now);

  PageObserver& observer_;
  const time::Clock& clock_;
  LedRobot* robot_;
  std::size_t places_;
  ServerPage page_;
  program::LogListener log_;
  std::optional<page::PageServer> served_;
  time::Nanoseconds next_{0};
  time::Nanoseconds next_movement_{0};
  time::Nanoseconds shown_{0};
  std::uint64_t motions_ = 0;
};

}  // namespace forcebound::server
