#pragma once

#include <deque>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "forcebound/client/page/page_state.hpp"
#include "forcebound/client/page/run_figures.hpp"
#include "forcebound/client/page/tick_tap.hpp"
#include "forcebound/client/page/view_tap.hpp"
#include "forcebound/device/simulated/pointer_operator.hpp"
#include "forcebound/live/foxglove_subject.hpp"
#include "forcebound/page/subject.hpp"
#include "forcebound/time/clock.hpp"
#include "forcebound/view/assembly.hpp"

namespace forcebound::client {

/// One client of a run, as a page shows it.
struct ShownTrack {
  std::shared_ptr<TickTap> tap;
  std::shared_ptr<device::PointerTarget> pointer{};  ///< null: the hand follows none
  std::shared_ptr<ViewTap> view{};                   ///< null: the server does not tell how the scene looks
  bool renders_locally = false;                      ///< what the server need not tell comes to be here
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
class LivePage final : public page::Subject, private live::FoxgloveSubject::Source {
 public:
  /// Requests that wait for the program; more are refused.
  static constexpr std::size_t kRequestsMost = 8;
  /// The least time between two pictures of a growing scene.
  static constexpr double kSceneEvery_s = 1;
  /// Events that a viewer who comes later is told of.
  static constexpr std::size_t kEventsKept = 50;

  /// @param clock must outlive it; it gives time zero of the page
  /// @param wall_clock time [since 1970] at time zero of the clock
  explicit LivePage(const time::Clock& clock, time::Nanoseconds wall_clock = {});

  /// Another run is shown from now on, its figures from zero.
  void begin_run(PageState state, std::vector<ShownTrack> tracks);
  /// The run that is shown ends.
  void set_closing();
  /// The same run, but something of what a page shows as chosen is another.
  void set_state(PageState state);
  /// What of a track's scene is at this client. What the server tells of the rest is shown beside.
  void set_scene(int track, view::ShownScene scene);
  void report(int track, const std::string& level, const std::string& text);
  void refuse(const std::string& about, const std::string& text);

  /// Where the server says that a hand begins in the scene of the run that is shown, once; nothing: it has not said.
  [[nodiscard]] std::optional<control::Vector> take_begin();

  /// The oldest choice or wish for a recording that waits. The one before has been dealt with: it was refused
  /// meanwhile, or is done.
  [[nodiscard]] std::optional<page::Request> take_request();

  [[nodiscard]] time::Nanoseconds epoch() const noexcept { return epoch_; }

  /// The first track for viewers that speak Foxglove's protocol.
  [[nodiscard]] page::Subprotocol foxglove() noexcept { return foxglove_.subprotocol(); }

  void greet(page::ViewerId viewer, page::Viewers& viewers) override;
  void leave(page::ViewerId viewer) noexcept override;
  void receive(page::ViewerId viewer, std::string_view text, page::Viewers& viewers) override;
  void beat(page::Viewers& viewers) override;
  [[nodiscard]] std::string metrics() override;

 private:
  /// How a track's scene looks. A scene that is handed over grows by every piece: it is shown once a second.
  struct Scene {
    std::shared_ptr<const view::ShownScene> here{};    ///< at this client; null: none
    std::shared_ptr<const view::ShownScene> server{};  ///< as the server tells; null: it does not
    bool changed = false;
    double shown_s = -1;  ///< when; below 0: never
    page::Text message{};
  };

  struct WrittenScene {
    std::shared_ptr<const view::ShownScene> here{};
    std::shared_ptr<const view::ShownScene> server{};
    friend bool operator==(const WrittenScene&, const WrittenScene&) = default;
  };

  struct Track {
    ShownTrack shown;
    RunFigures figures;
    view::Assembly assembly{};
  };

  /// What is to be done, for a page's viewer or for a call by Foxglove's protocol.
  struct Wish {
    page::Request request;
    std::optional<std::uint64_t> call{};
  };

  void write_new(record::TopicEncoder& to, bool wanted) override;
  void call(std::uint64_t number, const live::Service& service, const std::string& value) override;
  [[nodiscard]] bool queue_wish(Wish wish);
  void answer_call(const std::string& refusal);
  [[nodiscard]] double now_s() const noexcept;
  void queue(std::string message);
  void queue_hello();
  void begin_next_run();
  void receive_view(std::size_t track);
  void show_scenes(page::Viewers& viewers);
  void show(Track& track, int number, bool closing, page::Viewers& viewers);
  void let_go() noexcept;
  void point(const Track& track) const;
  void act_on(const page::Request& request, page::ViewerId viewer, page::Viewers& viewers);

  const time::Clock& clock_;
  time::Nanoseconds epoch_;

  // Between the threads.
  std::mutex lock_;
  PageState state_;
  std::optional<std::vector<ShownTrack>> next_tracks_;  // of a run that the page's thread has not taken yet
  std::vector<Scene> scenes_;                           // by track
  std::vector<std::string> outbox_;
  std::size_t events_waiting_ = 0;  // of the newest events, in the outbox
  bool hello_waits_ = false;        // likewise
  std::deque<std::string> events_;
  std::deque<Wish> wishes_;
  std::optional<std::uint64_t> call_in_hand_;                   // of the wish that was taken last
  std::vector<std::pair<std::uint64_t, std::string>> answers_;  // to calls: why not, or nothing
  std::optional<control::Vector> begin_m_;
  bool closing_ = false;

  // Of the page's thread.
  std::vector<Track> tracks_;
  std::optional<device::PointerTarget::Point> hand_m_;  // where the pointer is, while it drags
  page::ViewerId dragging_ = 0;                         // whose it is
  std::map<page::ViewerId, std::uint32_t> pressed_;     // buttons that viewers hold down
  std::uint64_t beats_ = 0;
  live::FoxgloveSubject foxglove_;
  WrittenScene written_scene_;  // for it
  double scene_written_s_ = -kSceneEvery_s;
};

}  // namespace forcebound::client
