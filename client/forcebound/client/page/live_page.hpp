#pragma once

#include <deque>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "forcebound/client/page/page_state.hpp"
#include "forcebound/client/page/run_figures.hpp"
#include "forcebound/client/page/tick_tap.hpp"
#include "forcebound/device/simulated/pointer_operator.hpp"
#include "forcebound/page/subject.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::client {

/// One client of a run, as a page shows it.
struct ShownTrack {
  std::shared_ptr<TickTap> tap;
  std::shared_ptr<device::PointerTarget> pointer{};  ///< null: the hand follows none
  RunFigures::Options figures{};
  /// The hand is pointed no farther than this from where the tip is, however far the pointer is: it pulls no harder
  /// than the device can hold against it.
  double pull_m = std::numeric_limits<double>::infinity();
};

/// What the page of forcebound-client shows and is asked for. It outlives the clients that it shows one after the
/// other.
///
/// Any thread calls what is not a function of Subject; those are of the page's thread. The tick has a part in none of
/// them: it fills the taps.
class LivePage final : public page::Subject {
 public:
  /// Requests that wait for the program; more are refused.
  static constexpr std::size_t kRequestsMost = 8;
  /// Events that a viewer who comes later is told of.
  static constexpr std::size_t kEventsKept = 50;

  /// @param clock must outlive it; it gives time zero of the page
  explicit LivePage(const time::Clock& clock);

  /// Another run is shown from now on, its figures from zero.
  void begin_run(PageState state, std::vector<ShownTrack> tracks);
  /// The run that is shown ends.
  void note_closing();
  /// The same run, but something of what a page shows as chosen is another.
  void set_state(PageState state);
  /// The message `scene` of a track.
  void set_scene(int track, std::string message);
  void tell(int track, const std::string& level, const std::string& text);
  void refuse(const std::string& about, const std::string& text);

  /// The oldest choice or wish for a recording that waits.
  [[nodiscard]] std::optional<page::Request> take_request();

  [[nodiscard]] time::Nanoseconds epoch() const noexcept { return epoch_; }

  void greet(page::ViewerId viewer, page::Viewers& viewers) override;
  void receive(page::ViewerId viewer, std::string_view text, page::Viewers& viewers) override;
  void beat(page::Viewers& viewers) override;
  [[nodiscard]] std::string metrics() override;

 private:
  struct Track {
    ShownTrack shown;
    RunFigures figures;
  };

  [[nodiscard]] double now_s() const noexcept;
  void queue(std::string message);
  void take_run();
  void point(const Track& track) const;
  void act_on(const page::Request& request, page::ViewerId viewer, page::Viewers& viewers);

  const time::Clock& clock_;
  time::Nanoseconds epoch_;

  // Between the threads.
  std::mutex lock_;
  PageState state_;
  std::optional<std::vector<ShownTrack>> next_tracks_;  // of a run that the page's thread has not taken yet
  std::vector<std::string> scenes_;                     // by track; empty: unknown yet
  std::vector<std::string> outbox_;
  std::deque<std::string> events_;
  std::deque<page::Request> requests_;
  bool closing_ = false;

  // Of the page's thread.
  std::vector<Track> tracks_;
  std::optional<device::PointerTarget::Point> hand_m_;  // where the pointer is, while it drags
  std::uint64_t beats_ = 0;
};

}  // namespace forcebound::client
