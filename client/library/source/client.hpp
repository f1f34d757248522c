#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "forcebound/client/embedding/embedded_client.hpp"
#include "forcebound/record/tick_record.hpp"
#include "forcebound/time/latest.hpp"
#include "library/forcebound.h"
#include "library/source/device.hpp"

namespace forcebound::library {

/// Keeps the newest tick for other threads. Real time: `on_tick` is noexcept, allocates nothing and never waits.
class NewestTick final : public record::TickSink {
 public:
  void on_tick(const record::TickRecord& tick) noexcept override { newest_.store(tick); }

  /// Any other thread; number 0: there was none.
  [[nodiscard]] record::TickRecord get();

 private:
  time::Latest<record::TickRecord> newest_;
  std::mutex mutex_;  // of those who look
  record::TickRecord seen_{};
};

/// Events that wait for the program; further ones are counted.
class Events {
 public:
  void add(const fb_event& event);
  [[nodiscard]] bool take(fb_event& event);
  [[nodiscard]] std::uint64_t lost() const;
  [[nodiscard]] std::string simulated() const;

 private:
  static constexpr std::size_t kMost = 1000;

  mutable std::mutex mutex_;
  std::deque<fb_event> waiting_;
  std::uint64_t lost_ = 0;
  std::string simulated_;
};

}  // namespace forcebound::library

/// What fb_client points at.
struct fb_client {
  fb_client(const forcebound::client::EmbeddedClient::Settings& settings,
            std::shared_ptr<forcebound::library::OpenedDevice> used);
  ~fb_client();
  fb_client(const fb_client&) = delete;
  fb_client& operator=(const fb_client&) = delete;

  std::shared_ptr<forcebound::library::OpenedDevice> opened;
  forcebound::library::NewestTick newest;
  forcebound::library::Events events;
  forcebound::client::EmbeddedClient client;
  std::mutex mutex;  ///< of what follows, but `running`
  std::condition_variable changed;
  bool started = false;
  bool ended = false;
  std::string failure;  ///< of the run; empty: none
  std::atomic<bool> running{false};
  std::jthread thread;  ///< last: ends before what it uses
};
