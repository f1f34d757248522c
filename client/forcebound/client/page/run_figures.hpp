#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "forcebound/client/page/tick_tap.hpp"
#include "forcebound/page/duration_histogram.hpp"
#include "forcebound/record/histogram.hpp"

namespace forcebound::client {

/// The durations of a stage: percentiles, each off by less than 0.05 % of itself, and counts between edges for a chart.
class StageHistogram {
 public:
  static constexpr std::array<double, 19> kEdges_ms{0,  0.02, 0.05, 0.1, 0.2, 0.5, 1,   2,    3,    5,
                                                    10, 20,   30,   50,  100, 200, 500, 1000, 10000};

  /// Outside of the edges it counts in the first or the last interval.
  void add(time::Nanoseconds duration) noexcept;

  [[nodiscard]] bool empty() const noexcept { return durations_.count() == 0; }
  [[nodiscard]] std::string to_json() const;

 private:
  std::array<std::uint64_t, kEdges_ms.size() - 1> counts_{};
  record::Histogram durations_;
};

/// The figures of one run of a client since its start, and what of its ticks waits to be shown. Owned by the page's
/// thread.
class RunFigures {
 public:
  struct Options {
    int degrees_of_freedom = 3;  ///< of the positions and forces shown: 1 to 3
    time::Nanoseconds period{1'000'000};
    time::Nanoseconds epoch{0};  ///< time zero of the page
    bool audited = false;        ///< the device knows P
    std::string scene{};         ///< as it was asked for; empty: the server's own
  };

  explicit RunFigures(const Options& options) : options_(options) {}

  void add(const ForceSample& force);
  void add(const TickSample& tick);

  /// The message `ticks` with all that came since the last one; empty: nothing came.
  /// @param hand_m where the pointer pulls to
  [[nodiscard]] std::string take_ticks(int track, const std::optional<std::array<double, 3>>& hand_m);

  /// Nobody looks.
  void leave_out_ticks() noexcept { waiting_.clear(); }

  /// The message `status`.
  [[nodiscard]] std::string status(int track, std::uint64_t dropped, bool closing) const;

  /// In the text format of Prometheus.
  void add_metrics(std::string& to, int track, std::uint64_t dropped) const;

  [[nodiscard]] const std::optional<TickSample>& newest() const noexcept { return newest_; }

 private:
  struct Network {
    std::uint64_t sent = 0;
    std::uint64_t received = 0;
    std::uint64_t lost_up = 0;
    std::uint64_t lost_down = 0;
    std::uint64_t in_flight = 0;
  };
  [[nodiscard]] Network network() const noexcept;
  [[nodiscard]] std::optional<bool> passive() const noexcept;
  void add_stages(const TickSample& tick);
  void add_handle(std::string& to) const;

  Options options_;
  std::vector<TickSample> waiting_;
  std::optional<TickSample> newest_;
  bool touched_ = false;  // a force was asked for
  std::optional<ForceSample> plane_;
  std::vector<ForceSample> unused_;  // answers whose force no tick has used yet
  std::uint64_t ticks_ = 0;
  std::uint64_t late_ = 0;
  std::uint64_t session_ = 0;
  std::uint64_t motions_sent_ = 0;  // in this session
  std::uint64_t forces_received_ = 0;
  std::uint64_t force_sequence_ = 0;  // the newest
  std::uint64_t motion_answered_ = 0;
  std::uint64_t motions_received_ = 0;  // by the server
  std::uint64_t last_used_ = 0;
  record::Histogram intervals_;
  record::Histogram round_trips_;
  page::DurationHistogram round_trip_s_;
  page::DurationHistogram at_server_s_;
  page::DurationHistogram age_s_;
  // All of the same forces, those that reached the device: no percentile of the total is below one of its parts.
  StageHistogram network_stage_;
  StageHistogram server_stage_;
  StageHistogram waiting_stage_;
  StageHistogram total_stage_;
};

}  // namespace forcebound::client
