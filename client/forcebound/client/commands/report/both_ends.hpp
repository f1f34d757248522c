#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>

#include "forcebound/record/recording_reader.hpp"

namespace forcebound::client::commands {

/// What the recordings of a client and of its server show only together: the same motions and forces at both ends,
/// joined by session and sequence.
///
/// Takes the records of both files; of the server's other clients nothing counts.
class BothEnds {
 public:
  using Nanoseconds = time::Nanoseconds;

  void add_client(const record::RunInfo& info) { client_epoch_ = info.epoch; }
  void add_client(const record::RunTotals& totals);
  void add(const record::TickRecord& tick);
  void add(const record::ForceRecord& force);

  void add_server(const record::RunInfo& info) { server_epoch_ = info.epoch; }
  void add(const record::MotionRecord& motion);
  void add(const record::SentForceRecord& force);

  /// The results, numbers in full:
  ///
  /// - `sessions`: in both files.
  /// - `motions`: `sent` by the client, of these `answered` by the server, of these `came_back`, whose forces arrived.
  /// - `forces`: `sent` to this client, `received` by it, and of those in both files those that are not bit by bit the
  ///   same, `differ`.
  /// - `up_us`, `server_us`, `compute_us`, `down_us`, `round_trip_us`, each `p50`, `p99`, `max`, of the forces in both
  ///   files: from reading a motion until the server had it, until its answer left, of that computing, until the
  ///   answer arrived, and from reading until then. Up and down are by the wall clocks of both machines;
  ///   `clocks_apart_us` is what the client found them apart, off by `clocks_apart_off_us` at most; null: not known.
  ///
  /// @throws std::runtime_error if no session is in both
  [[nodiscard]] nlohmann::ordered_json results() const;

  /// In lines as a summary's. @throws std::runtime_error as `results`
  [[nodiscard]] std::string to_text() const;

 private:
  using Key = std::pair<std::uint64_t, std::uint64_t>;  // session, sequence

  struct Received {
    Nanoseconds at{0};
    Nanoseconds round_trip{0};
    std::uint64_t motion = 0;
    control::Vector force_N;
  };
  struct Sent {
    Nanoseconds motion_arrived{0};
    Nanoseconds at{0};
    Nanoseconds compute{0};
    std::uint64_t motion = 0;
    control::Vector force_N;
  };

  [[nodiscard]] std::map<std::uint64_t, std::uint64_t> sessions_in_both() const;

  Nanoseconds client_epoch_{0};
  Nanoseconds server_epoch_{0};
  std::optional<Nanoseconds> server_ahead_{};
  std::optional<Nanoseconds> server_ahead_off_{};
  std::map<std::uint64_t, Nanoseconds> motions_read_;  // by sequence, which is the client's own across sessions
  std::map<Key, Nanoseconds> motions_arrived_;
  std::map<Key, Received> received_;
  std::map<Key, Sent> sent_;
};

}  // namespace forcebound::client::commands
