#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "forcebound/client/runtime/client.hpp"
#include "forcebound/client/session/event.hpp"
#include "forcebound/control/law_description.hpp"
#include "forcebound/device/haptic_device.hpp"
#include "forcebound/record/tick_record.hpp"

namespace forcebound::client {

/// A client within a program of another language: a law by its name, and what happened on the way given away as it
/// comes. Of this Python's and C's are made. It runs once; its tick has a thread of its own, in which nothing of that
/// language runs.
class EmbeddedClient {
 public:
  struct Settings {
    Client::Settings client;  ///< names the law; its words for the recording are filled in
    control::LawOptions law_options{};
  };

  /// Called in the thread that runs, several times a second.
  struct Reports {
    std::function<void(const Event&)> event = [](const Event&) {};
    std::function<void(const std::string&)> problem = [](const std::string&) {};  ///< of keys, names, the recording
  };

  /// @param device and `sinks` must outlive it
  /// @throws std::invalid_argument what the law refuses, and what Client does
  EmbeddedClient(const Settings& settings, device::HapticDevice& device, const std::vector<record::TickSink*>& sinks,
                 Reports reports);

  /// Runs until its time is up, it gives up, or `stop`.
  /// @throws std::runtime_error for a second time, and what Client::run does
  void run();

  /// Any thread.
  void stop() noexcept { stop_ = true; }

  /// Any thread.
  [[nodiscard]] bool ended() const noexcept { return ended_; }

  /// JSON. @throws std::runtime_error before it has ended
  [[nodiscard]] std::string summary() const;

  /// Why there was no session; empty: there was one. @throws as above
  [[nodiscard]] std::string why_no_session() const;

 private:
  void look();

  Reports reports_;
  Client client_;
  std::atomic<bool> stop_{false};
  std::atomic<bool> begun_{false};
  std::atomic<bool> ended_{false};
};

}  // namespace forcebound::client
