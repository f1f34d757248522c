#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "forcebound/net/datagram_link.hpp"
#include "forcebound/wire/messages.hpp"

namespace forcebound::server {

using time::Nanoseconds;

/// The client of a session.
struct SessionInfo {
  std::uint64_t session = 0;
  net::Address address;
  std::string device;  ///< as the client calls it; printable
  std::uint32_t degrees_of_freedom = 0;
  std::string scene;
  std::string client{};  ///< who it is, if it has shown that; printable
  std::string choice{};  ///< the level picked for this client, and the reason; empty: there was no choice
};

enum class CloseReason : std::uint8_t { client_said_bye, idle, server_stops, did_not_move, was_asked_to };

/// Receives a server's events. Does nothing unless overridden.
class ServerObserver {
 public:
  virtual ~ServerObserver() = default;

  virtual void on_opened(const SessionInfo&) {}
  virtual void on_closed(const SessionInfo&, CloseReason, const wire::Bye& /*final_counts*/) {}
  virtual void on_refused(const net::Address&, std::string_view /*text*/) {}

  /// A requested scene did not compile.
  virtual void on_scene_failed(std::string_view /*scene*/, std::string_view /*why*/) {}

  /// The environment's responses are not finite or of wrong size: zero force is sent instead. Once per session.
  virtual void on_unsound_response(const SessionInfo&) noexcept {}

  /// The object or field was left out, because its force was not finite. At most once per session and part.
  virtual void on_quarantined(const SessionInfo&, std::string_view /*object*/) noexcept {}

  /// Real time: called for each motion answered, and for its answer. Must not allocate, wait or print.
  virtual void on_motion(const wire::MotionSample&) noexcept {}
  virtual void on_force(const wire::EnvironmentForce&) noexcept {}
};

}  // namespace forcebound::server
