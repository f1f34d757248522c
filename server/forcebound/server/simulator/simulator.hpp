#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "forcebound/server/simulator/touch.hpp"
#include "forcebound/time/clock.hpp"
#include "forcebound/time/latest.hpp"

namespace forcebound::server {

using time::Nanoseconds;

/// Where a simulator that steps at its own rate, on a thread of its own, meets the probes of the clients, which the
/// server's thread moves at theirs:
///
///     server   probe at 1 kHz, with the newest report's touches as its model  -- where it is, what it pushed -->
///     simulator                                                               <-- the touches at the step's end --
///
/// A report is for the moment at which the probe was asked for: the probe is moved from there to now again, along the
/// way that its device went. What it pushed, as the hand felt it, goes to the simulator with the next step.
///
/// One thread calls `probes` and `report`, another the rest. Neither waits for the other.
class Simulator {
 public:
  /// What a report told of was given this, as the hand was asked to feel it, since the probe was asked for before.
  struct Push {
    std::uint32_t body = 0;
    Point place_m = Point::Zero();  ///< as it was reported
    Point impulse_Ns = Point::Zero();
  };

  struct Probe {
    std::uint64_t client = 0;  ///< a number that no other has, before or after
    double interval_s = 0;     ///< since it was asked for before; 0: the first time, or no motion came since
    Point place_m = Point::Zero();
    Point velocity_m_per_s = Point::Zero();
    Point device_m = Point::Zero();
    std::uint32_t buttons = 0;
    std::array<Push, 2 * kTouchesMost> pushes{};  ///< under the newest report, and under the one before
    std::size_t push_count = 0;
  };

  /// @param seats clients at once @throws std::invalid_argument naming what is wrong in `probe`
  Simulator(const ProbeFacts& probe, int seats);

  /// Of the clients that are there, as many as have room. @returns how many
  [[nodiscard]] std::size_t probes(std::span<Probe> to) noexcept;

  /// What a probe meets at the end of the step that began when it was asked for last. False, and nothing is done: there
  /// is no such client, or it was not asked for. @throws std::invalid_argument naming what is wrong in a touch
  [[nodiscard]] bool report(std::uint64_t client, std::span<const Touch> touches);

  /// As one that was refused, before it got here.
  void count_refused() noexcept { reports_refused_.fetch_add(1, std::memory_order_relaxed); }

  struct Counts {
    std::uint64_t reports = 0;
    std::uint64_t reports_refused = 0;
    std::uint64_t silences = 0;  ///< times that a probe had no report for so long that its force fades
  };
  /// Any thread.
  [[nodiscard]] Counts counts() const noexcept;

  // By the thread that moves the probes; noexcept, no allocation.

  /// What a probe pushed while a report was what it went by: impulses on its touches.
  struct Pushed {
    std::uint64_t report = 0;
    std::array<Point, kTouchesMost> impulse_Ns{Point::Zero(), Point::Zero(), Point::Zero()};
  };

  struct Sample {
    Nanoseconds moment{0};
    std::uint64_t client = 0;  ///< 0: the seat is free
    Point place_m = Point::Zero();
    Point velocity_m_per_s = Point::Zero();
    Point device_m = Point::Zero();
    std::uint32_t buttons = 0;
    std::array<Pushed, 2> pushed{};  ///< under the report that it goes by, and under the one before
  };

  struct Report {
    std::uint64_t number = 0;
    std::uint64_t client = 0;
    Nanoseconds moment{0};
    Point place_m = Point::Zero();  ///< of the probe then
    Point velocity_m_per_s = Point::Zero();
    Touches touches{};
    std::size_t count = 0;
  };

  [[nodiscard]] std::size_t seats() const noexcept { return seats_.size(); }
  [[nodiscard]] const ProbeFacts& probe() const noexcept { return probe_; }
  void publish(std::size_t seat, const Sample& sample) noexcept { seats_[seat]->samples.store(sample); }
  /// Null: none since it was asked for last. Valid until then.
  [[nodiscard]] const Report* newest(std::size_t seat) noexcept { return seats_[seat]->reports.take(); }
  [[nodiscard]] std::uint64_t another_client() noexcept { return ++clients_; }
  void count_silence() noexcept { silences_.fetch_add(1, std::memory_order_relaxed); }

 private:
  struct Seat {
    time::Latest<Sample> samples;
    time::Latest<Report> reports;
    // Of the simulator's thread:
    Sample now{};                          // as it was asked for last
    std::uint64_t told = 0;                // number of the newest report
    std::array<Report, 4> reports_told{};  // the newest ones, each at its number
  };

  static void add_pushes(const Seat& seat, const Sample& before, Probe& probe) noexcept;
  bool store(std::uint64_t client, std::span<const Touch> touches) noexcept;

  ProbeFacts probe_;
  std::vector<std::unique_ptr<Seat>> seats_;
  std::uint64_t clients_ = 0;
  std::atomic<std::uint64_t> reports_{0};
  std::atomic<std::uint64_t> reports_refused_{0};
  std::atomic<std::uint64_t> silences_{0};
};

}  // namespace forcebound::server
