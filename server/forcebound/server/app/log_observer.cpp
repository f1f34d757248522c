#include "forcebound/server/app/log_observer.hpp"

#include <spdlog/spdlog.h>

#include <chrono>
#include <string>
#include <utility>

#include "forcebound/text/terminal.hpp"

namespace forcebound::server {
namespace {

const char* words(CloseReason reason) {
  switch (reason) {
    case CloseReason::client_said_bye:
      return "ended its session";
    case CloseReason::idle:
      return "was idle too long";
    case CloseReason::did_not_move:
      return "did not move for a minute, and another asked for its place";
    case CloseReason::was_asked_to:
      return "is disconnected, as asked for on the page";
    case CloseReason::server_stops:
      return "is disconnected: the server stops";
  }
  return "";
}

/// Its address, and its name if it has shown who it is.
std::string who(const SessionInfo& info) {
  const std::string address = net::to_string(info.address);
  return info.client.empty() ? address : address + " (client " + info.client + ")";
}

}  // namespace

// The session's number is its key, so it is in no log line.
void LogObserver::on_opened(const SessionInfo& info) {
  spdlog::info("{} connected to scene '{}' with device '{}' ({})", who(info), info.scene, info.device,
               text::counted(info.degrees_of_freedom, "degree of freedom", "degrees of freedom"));
  if (!info.choice.empty()) spdlog::info("{} {}", who(info), info.choice);
}

void LogObserver::on_closed(const SessionInfo& info, CloseReason reason, const wire::Bye& final_counts) {
  spdlog::info("{} {}: {} received, {} duplicated, {} reordered, {} sent", who(info), words(reason),
               text::counted(final_counts.motions_received, "motion"), final_counts.motions_duplicated,
               final_counts.motions_reordered, text::counted(final_counts.forces_sent, "force"));
}

void LogObserver::on_scene_failed(std::string_view scene, std::string_view why) {
  spdlog::error("scene '{}' is not available: {}", scene, why);
}

void LogObserver::on_unsound_response(const SessionInfo& info) noexcept {
  spdlog::error("{} is sent zero force: environment '{}' answered what is not finite or of wrong size", who(info),
                info.scene);
}

void LogObserver::on_quarantined(const SessionInfo& info, std::string_view object) noexcept {
  spdlog::error("{}: '{}' of scene '{}' is left out from now on: its force was not finite", who(info), object,
                info.scene);
}

void LogObserver::on_refused(const net::Address& address, std::string_view text) {
  const time::Nanoseconds now = clock_.now();
  if (any_refusal_ && now - refusal_logged_ < std::chrono::seconds{1}) {
    ++refusals_not_logged_;
    return;
  }
  any_refusal_ = true;
  refusal_logged_ = now;
  spdlog::warn("{} refused: {}", net::to_string(address), text);
  if (const auto others = std::exchange(refusals_not_logged_, 0); others > 0) {
    spdlog::warn("{} more were refused since the last such line", others);
  }
}

}  // namespace forcebound::server
