#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "forcebound/client/rendering/tool.hpp"
#include "forcebound/client/session/actuation.hpp"
#include "forcebound/client/session/renderer.hpp"
#include "forcebound/record/run_info.hpp"
#include "forcebound/record/session_state.hpp"
#include "forcebound/record/tick_record.hpp"
#include "forcebound/wire/messages.hpp"

namespace forcebound::client {

/// The stage of a Session that records: each tick and each force, and the names of the scene for the totals. Takes what
/// the other stages gave; nothing depends on it.
///
/// Real time: noexcept, no allocation, but for the constructor and `add_to`.
class SessionRecorder {
 public:
  /// @param sinks must outlive this
  explicit SessionRecorder(std::span<record::TickSink* const> sinks);

  /// What a session's server simulates. @returns it in words that can be printed
  std::string_view begin_session(const wire::Welcome& welcome) noexcept;

  void record(const wire::EnvironmentForce& force, Nanoseconds arrival) const noexcept;

  struct Tick {
    Nanoseconds now{0};
    const device::Reading& reading;
    const ToolPoint& point;
    std::uint64_t motion_sequence = 0;  ///< sent, 0: none
    const Renderer::Rendered& rendered;
    const Actuation::Command& command;
    record::SessionState state = record::SessionState::connecting;
    const std::optional<wire::EnvironmentForce>& newest;  ///< of the server's answers
  };
  void record(const Tick& tick) noexcept;

  /// Recorded so far.
  [[nodiscard]] std::uint64_t ticks() const noexcept { return ticks_; }

  /// Adds what the server said of its scene.
  void add_to(record::RunTotals& totals) const;

 private:
  std::span<record::TickSink* const> sinks_;
  std::uint64_t ticks_ = 0;
  std::uint64_t local_scene_ = 0;  // number of the scene at the client
  Nanoseconds local_since_{0};     // when it was taken into use
  // They hold all that a Welcome can carry, so that the tick does not allocate.
  std::string scene_;
  std::string simulated_;
};

}  // namespace forcebound::client
