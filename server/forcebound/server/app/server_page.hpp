#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "forcebound/live/foxglove_subject.hpp"
#include "forcebound/live/record_tap.hpp"
#include "forcebound/page/subject.hpp"
#include "forcebound/time/clock.hpp"
#include "forcebound/view/assembly.hpp"

namespace forcebound::server {

/// What the page of forcebound-server shows and is asked for. The server's thread sets and takes, twice a second while
/// somebody looks; the rest is of the page's thread.
class ServerPage final : public page::Subject, private live::FoxgloveSubject::Source {
 public:
  static constexpr std::size_t kKicksMost = 64;
  /// Events that a viewer who comes later is told of.
  static constexpr std::size_t kEventsKept = 50;

  /// How the scene of this name looks; no parts: it is not known here.
  using PartsOf = std::function<std::vector<record::ScenePart>(const std::string& scene)>;

  struct Options {
    std::string recording{};          ///< file; empty: none
    time::Nanoseconds wall_clock{0};  ///< time [since 1970] at time zero of the clock
    PartsOf parts_of{};
    live::RecordTap* records = nullptr;  ///< brings motions and forces; must outlive it. Null: there are none
  };

  /// @param clock must outlive it
  ServerPage(const time::Clock& clock, Options options);

  /// All sessions for viewers that speak Foxglove's protocol.
  [[nodiscard]] page::Subprotocol foxglove() noexcept { return foxglove_.subprotocol(); }
  /// The scene that these are shown. The server's thread.
  void set_scene(const std::string& name);

  /// Whether somebody looks, or waits for figures. Never waits.
  [[nodiscard]] bool watched() const noexcept { return watched_.load(std::memory_order_relaxed); }
  [[nodiscard]] bool awaited() const noexcept { return awaited_.load(std::memory_order_relaxed); }

  /// What is shown from now on.
  void show(std::string sessions, std::string metrics);
  /// An event. Any thread.
  void report(const std::string& level, const std::string& text);

  /// How the robot that is served looks. Before the page is served.
  void set_robot(const view::Description& appearance);
  /// Where the items of a group of it are; the newest counts.
  void move_robot(std::size_t group, std::span<const float> numbers);

  /// The page's number of a session that is to be ended.
  [[nodiscard]] std::optional<std::uint64_t> take_kick();

  void greet(page::ViewerId viewer, page::Viewers& viewers) override;
  void receive(page::ViewerId viewer, std::string_view text, page::Viewers& viewers) override;
  void beat(page::Viewers& viewers) override;
  /// Waits for new figures, half a second at most: a server that nobody looks at has none ready.
  [[nodiscard]] std::string metrics() override;

 private:
  void write_new(record::TopicEncoder& to, bool wanted) override;
  [[nodiscard]] double now_s() const noexcept;
  [[nodiscard]] std::string hello() const;
  [[nodiscard]] bool queue_kick(std::uint64_t kick);

  const time::Clock& clock_;
  time::Nanoseconds epoch_;
  Options options_;
  std::mutex lock_;
  std::string sessions_;
  std::string metrics_;
  std::deque<page::Text> events_;          // the newest
  std::size_t events_waiting_ = 0;         // of the newest of them, not sent yet
  std::vector<std::vector<float>> moved_;  // of each group of the robot's looks; empty: nothing new
  std::vector<std::vector<float>> sent_;   // the page's thread's own
  std::deque<std::uint64_t> kicks_;
  bool fresh_ = false;
  std::condition_variable shown_;
  std::uint64_t beats_ = 0;
  std::uint64_t view_ = 0;   // of the robot's looks; 0: there is none
  view::Assembly assembly_;  // of the page's thread
  std::string scene_;
  std::atomic<bool> watched_{false};
  std::atomic<bool> awaited_{false};
  live::FoxgloveSubject foxglove_;
  std::string scene_name_;          // behind the lock
  std::string written_scene_name_;  // of the page's thread
};

}  // namespace forcebound::server
