#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "forcebound/live/record_tap.hpp"
#include "forcebound/page/duration_histogram.hpp"
#include "forcebound/record/histogram.hpp"
#include "forcebound/server/session/observer.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::server {

/// Figures of each session for a page, beside another observer, which is told of everything too. For one thread at a
/// time: where a server has several workers, of whoever has ServerWorkers::observer_lock.
class PageObserver final : public ServerObserver {
 public:
  /// Both must outlive it.
  PageObserver(ServerObserver& next, const time::Clock& clock) : next_(next), clock_(clock) {}

  /// Brings all motions and forces from now on, while they are wanted. Before the server starts.
  [[nodiscard]] live::RecordTap& begin_records() {
    records_ = std::make_unique<live::RecordTap>();
    return *records_;
  }

  /// What the whole server does, to be shown beside the sessions.
  struct Load {
    double busy = 0;  ///< share of the thread that serves
    double motions_per_s = 0;
    std::size_t places_used = 0;
    std::size_t places = 0;
  };

  /// A session as a page shows it.
  struct Row {
    std::uint64_t number = 0;  ///< the page's own, 1, 2, 3, ...: the session's number is its key
    SessionInfo info{};
    bool silent = false;
    double since_s = 0;
    double lost_up_percent = 0;  ///< of the motions between the first and the newest answered
    std::uint64_t motions_received = 0;
    std::uint64_t forces_sent = 0;
    std::uint64_t unsound = 0;
    std::uint64_t quarantined = 0;
    double compute_median_ns = 0;
    double compute_rare_ns = 0;  ///< 99 % take less
  };

  /// What is shown, copied; to be written out where no worker waits for it.
  struct Snapshot {
    std::vector<Row> sessions{};
    std::map<std::string, page::DurationHistogram> scenes{};
    std::uint64_t opened = 0;
    std::uint64_t refused = 0;

    /// The message `sessions`.
    [[nodiscard]] std::string sessions_message(const Load& load) const;
    /// In the text format of Prometheus.
    [[nodiscard]] std::string metrics(const Load& load) const;
  };

  /// Owned while one session is looked at, so that a motion waits for no more than that; empty: there is no other
  /// thread.
  using Lock = std::function<std::unique_lock<std::mutex>()>;
  [[nodiscard]] Snapshot snapshot(const Lock& lock = {}) const;

  /// The session that a page calls so; nothing: it has ended.
  [[nodiscard]] std::optional<std::uint64_t> session_of(std::uint64_t shown) const;

  void on_opened(const SessionInfo& info) override;
  void on_closed(const SessionInfo& info, CloseReason reason, const wire::Bye& final_counts) override;
  void on_refused(const net::Address& address, std::string_view text) override;
  void on_scene_failed(std::string_view scene, std::string_view why) override;
  void on_unsound_response(const SessionInfo& info) noexcept override;
  void on_quarantined(const SessionInfo& info, std::string_view object) noexcept override;
  void on_motion(const wire::MotionSample& motion) noexcept override;
  void on_force(const wire::EnvironmentForce& force) noexcept override;

 private:
  struct Figures {
    SessionInfo info;
    std::uint64_t shown = 0;  ///< its number on pages
    time::Nanoseconds opened{0};
    time::Nanoseconds answered{0};
    std::uint64_t first_motion = 0;    ///< number of the first that was answered
    std::uint64_t motions_before = 0;  ///< received before it
    std::uint64_t newest_motion = 0;
    std::uint64_t motions_received = 0;
    std::uint64_t forces_sent = 0;
    std::uint64_t unsound = 0;
    std::uint64_t quarantined = 0;
    record::Histogram compute;
    page::DurationHistogram* compute_of_scene = nullptr;  ///< of all its sessions

    /// Of the motions between the first and the newest answered, in percent.
    [[nodiscard]] double lost_up_percent() const noexcept;
  };

  [[nodiscard]] Row row_of(const Figures& figures) const;

  ServerObserver& next_;
  const time::Clock& clock_;
  std::unique_ptr<live::RecordTap> records_;               // null: there is no page
  std::unordered_map<std::uint64_t, Figures> sessions_;    // by the session's number
  std::map<std::uint64_t, std::uint64_t> shown_;           // sessions by the page's number
  std::map<std::string, page::DurationHistogram> scenes_;  // of all sessions since the start
  std::uint64_t opened_ = 0;
  std::uint64_t refused_ = 0;
};

}  // namespace forcebound::server
