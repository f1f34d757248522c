#include "forcebound/client/app/event_words.hpp"

#include <fmt/format.h>

namespace forcebound::client {

std::string in_words(time::Nanoseconds duration) {
  const double seconds = time::to_seconds(duration);
  return seconds < 1 ? fmt::format("{:.0f} ms", seconds * 1e3) : fmt::format("{:.2f} s", seconds);
}

namespace {

/// What the robot at the far end does, and what the operator can do about it.
EventWords words_of_follower(const Event& event) {
  using enum control::FollowerState;
  using spdlog::level::info;
  using spdlog::level::warn;
  const std::string engage = event.words().empty() ? "engage" : std::string(event.words());
  switch (event.follower) {
    case none:
      return {info, "there is no robot at the far end any more"};
    case waiting:
      return {info, fmt::format("the robot waits: {}, and it follows", engage)};
    case following:
      return {info, "the robot follows"};
    case clutched:
      return {info, "the clutch is pressed: the robot holds still until it is released"};
    case holding:
      return {warn, "the robot holds: it did not hear this device for a while"};
    case stopping:
      return {warn, "the robot is being stopped"};
    case stopped:
      return {warn, fmt::format("the robot has stopped: {}, and it follows again", engage)};
    case failed:
      return {spdlog::level::err, "the robot refuses: the server's log has the reason"};
    case taken:
      return {warn,
              "another device leads the robot: it took it while this one was silent; once it leaves, the robot "
              "waits for this one again"};
  }
  return {};
}

}  // namespace

EventWords words_of(const Event& event) {
  using spdlog::level::err;
  using spdlog::level::info;
  using spdlog::level::warn;
  switch (event.kind) {
    case Event::Kind::welcomed:
      return {info, fmt::format("connected; simulated: {}", event.words()), std::string(event.words())};
    case Event::Kind::refused:
      return {err, fmt::format("refused by the server: {}", event.words())};
    case Event::Kind::session_unknown:
      return {warn, "the server does not know this session (any more); requesting another"};
    case Event::Kind::server_left:
      return {warn, "the server ended the session; requesting another"};
    case Event::Kind::scene_here:
      return {info, "the scene has arrived: its static parts run at the client"};
    case Event::Kind::scene_refused:
      return {err, fmt::format("the server's scene is refused, its forces are held instead: {}", event.words())};
    case Event::Kind::limited_for_safety:
      return {warn, std::string(event.words())};
    case Event::Kind::device_gone:
      return {warn, fmt::format("no readings of the device, and no force until there are: {}", event.words())};
    case Event::Kind::no_torque:
      return {info, fmt::format("device {} tracks orientation, shows no torque", event.words())};
    case Event::Kind::device_back:
      return {info, fmt::format("the device is back after {}", in_words(event.duration))};
    case Event::Kind::force_fading:
      return {warn, fmt::format("forces are {} old: fading", in_words(event.duration))};
    case Event::Kind::force_dropped:
      return {warn, fmt::format("forces are {} old: zero force", in_words(event.duration))};
    case Event::Kind::force_fresh:
      return {info, fmt::format("forces are fresh again after {}", in_words(event.duration))};
    case Event::Kind::follower_changed:
      return words_of_follower(event);
    case Event::Kind::tool_lost:
      return {warn,
              "the scene puts a tool into the hand, and the device does not tell its orientation: the tool touches at "
              "the grip, and not at all if it has a shape"};
  }
  return {};
}

}  // namespace forcebound::client
