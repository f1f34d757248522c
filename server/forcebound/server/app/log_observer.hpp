#pragma once

#include "forcebound/server/session/observer.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::server {

/// Logs clients that connect and leave. Nothing per datagram: refusals, which an untrusted client can cause at will, at
/// most once a second.
class LogObserver : public ServerObserver {
 public:
  explicit LogObserver(const time::Clock& clock) : clock_(clock) {}

  /// After the last session. @returns whether all that was to be written has been
  virtual bool finish() { return true; }

  void on_opened(const SessionInfo& info) override;
  void on_closed(const SessionInfo& info, CloseReason reason, const wire::Bye& final_counts) override;
  void on_refused(const net::Address& address, std::string_view text) override;
  void on_scene_failed(std::string_view scene, std::string_view why) override;
  void on_unsound_response(const SessionInfo& info) noexcept override;
  void on_quarantined(const SessionInfo& info, std::string_view object) noexcept override;

 private:
  const time::Clock& clock_;
  time::Nanoseconds refusal_logged_{0};
  bool any_refusal_ = false;
  std::uint64_t refusals_not_logged_ = 0;
};

}  // namespace forcebound::server
