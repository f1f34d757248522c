#include "forcebound/client/app/live_run.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "forcebound/client/app/device_in_words.hpp"
#include "forcebound/client/app/event_words.hpp"
#include "forcebound/client/app/live_line.hpp"
#include "forcebound/client/app/live_track.hpp"
#include "forcebound/client/app/run_parts.hpp"
#include "forcebound/client/app/screen.hpp"
#include "forcebound/client/page/live_page.hpp"
#include "forcebound/client/page/relay_control.hpp"
#include "forcebound/page/page_server.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/terminal.hpp"
#include "forcebound/time/steady_clock.hpp"
#include "forcebound/view/shown_scene.hpp"

namespace forcebound::client {
namespace {

std::string level_of(const EventWords& words) {
  if (words.level >= spdlog::level::err) return "error";
  return words.level == spdlog::level::warn ? "warning" : "info";
}

class LiveRun {
 public:
  LiveRun(const Options& options, const control::LawRegistry& laws, const device::DeviceRegistry& devices,
          const std::atomic<bool>& stop)
      : options_(options),
        maker_(options, laws, devices),
        stop_(stop),
        page_(clock_, time::wall_clock_now() - clock_.now()) {
    choice_ = maker_.first_choice();
    if (!options.relay_control.empty()) {
      relay_.emplace(options.relay_control, clock_);
      network_ = relay_->network();
    }
    const page::PageServer::Settings settings = page::page_settings(*options.page, text::program_path());
    if (const std::string why = page::missing_page(text::program_path()); !why.empty()) spdlog::warn("{}", why);
    server_.emplace(settings, page_, page_.foxglove());
    std::fputs(("page: " + page::printed_address(server_->address()) + "\n").c_str(), stdout);
    std::fflush(stdout);
  }

  int run() {
    begun_ = clock_.now();
    do {
      if (next_) choice_ = *std::exchange(next_, std::nullopt);
      try {
        store_exit_code(run_once());
        worked_ = choice_;
      } catch (const std::exception& error) {
        // What cannot be run for what was chosen, or is refused by the server, goes back to what could.
        if (!can_go_back()) throw;
        spdlog::error("{}; goes back to what ran before", error.what());
        page_.refuse("run", error.what());
        next_ = worked_;
      }
    } while (next_);
    return exit_code_;
  }

 private:
  /// The second client, on a thread of its own. It begins once the server has welcomed the first: a robot is led by
  /// one.
  struct Beside {
    ~Beside() { ended = true; }  // before the thread is joined
    std::atomic<bool> ended{false};
    std::atomic<bool> refused{false};
    std::jthread thread{};
  };

  /// What the page has been told of a track's scene.
  struct ShownScene {
    std::shared_ptr<const scene::Scene> scene{};
    std::string simulated{};
  };

  [[nodiscard]] bool can_go_back() const { return worked_ && *worked_ != choice_; }

  /// Of several runs the worst counts; that none had a session counts where that is so of all.
  void store_exit_code(int exit_code) {
    constexpr std::array kFromWorst{program::kNotPassive, program::kFailed, program::kOutputLost, program::kDone,
                                    program::kNeverConnected};
    const auto rank = [&](int code) { return std::ranges::find(kFromWorst, code); };
    if (rank(exit_code) < rank(exit_code_)) exit_code_ = exit_code;
  }

  int run_once() {
    if (!std::exchange(again_, false)) {
      ++run_;
      maker_.set_start(choice_, tip_);
    }
    ended_ = false;
    std::vector<std::unique_ptr<LiveTrack>> tracks;
    tracks.push_back(maker_.make(choice_, false, run_));
    if (choice_.law_beside) tracks.push_back(maker_.make(choice_, true, run_));
    if (network_) {
      for (const auto& track : tracks) track->settings.network = "relay: " + words_of_network(*network_);
    }
    LiveTrack& main = *tracks.front();
    main.settings.asks_again = !can_go_back();
    show(tracks);
    LiveLine line;
    Client client(main.settings, *main.device, std::move(main.law), {&line, main.tap.get()});
    spdlog::info("{}; law {}, {}, server {}, {}", first_words(*main.device, main.settings.hand), choice_.law,
                 rendering_in_words(main.settings, client), client.server_in_words(),
                 encryption_in_words(main.settings));
    warn_of_hand(main.settings.hand, *main.device);
    Screen screen(options_, line, client.events(), [this](const EventWords& words) { show_event(0, words); });
    Beside beside;
    time::Nanoseconds last{0};
    const auto housekeeping = [&](time::Nanoseconds now, time::Nanoseconds elapsed) {
      last = now;
      if (tracks.size() > 1) attend_beside(tracks, beside, line.state() == record::SessionState::active);
      attend(client, main, screen, now, elapsed);
    };
    client.run(ended_, housekeeping, [&](std::string_view crash, bool device_stopped) {
      screen.end(last);
      return end_without_summary(*main.device, crash, device_stopped, !main.settings.recording.empty());
    });
    beside.ended = true;
    if (beside.thread.joinable()) beside.thread.join();
    screen.end(last);
    if (again_) return program::kDone;  // the run proper follows
    if (const std::string why_none = client.why_no_session(); !why_none.empty() && can_go_back() && !stop_) {
      throw std::runtime_error(why_none + ": " + words_of_change(*worked_, choice_));
    }
    tip_ = main.tip();
    return conclude(client);
  }

  void attend_beside(std::vector<std::unique_ptr<LiveTrack>>& tracks, Beside& beside, bool welcomed) {
    if (welcomed && !beside.thread.joinable()) {
      beside.thread = std::jthread([this, &track = *tracks[1], &beside] { run_beside(track, beside); });
    }
    if (!beside.refused) return;
    beside.thread.join();
    tracks.pop_back();
    choice_.law_beside.reset();
    shown_.resize(1);
    state_.choice.law_beside.reset();
    begin_on_page();
  }

  /// What is to be done several times a second.
  void attend(Client& client, const LiveTrack& main, Screen& screen, time::Nanoseconds now, time::Nanoseconds elapsed) {
    if (const std::string news = client.take_server_news(); !news.empty()) screen.report_news(news);
    if (const std::string why = client.take_server_problem(); !why.empty()) screen.report_problem(why);
    screen.refresh(now, elapsed, client.server_in_words());
    if (const std::string fault = client.take_recording_fault(); !fault.empty()) screen.report_recording_fault(fault);
    show_scene(0, client);
    while (!next_) {
      const auto request = page_.take_request();
      if (!request) break;
      consider(*request, client);
    }
    if (const auto begin_m = page_.take_begin(); begin_m && !next_) begin_again_at(*begin_m, main);
    const double duration_s = options_.client.duration_s;
    const bool over = duration_s > 0 && time::to_seconds(clock_.now() - begun_) >= duration_s;
    if (stop_ || over) {
      next_.reset();
      again_ = false;
    }
    if (!ended_ && (stop_ || over || next_)) {
      page_.set_closing();
      ended_ = true;
    }
  }

  /// A scene that is not known here: nothing was felt yet but where its hand does not begin.
  void begin_again_at(const control::Vector& place_m, const LiveTrack& main) {
    const bool held = main.pointer != nullptr && main.pointer->held();
    if (held || !maker_.set_told_start(place_m)) return;
    again_ = true;
    next_ = choice_;
  }

  void run_beside(LiveTrack& track, Beside& beside) noexcept {
    try {
      Client client(track.settings, *track.device, std::move(track.law), {track.tap.get()});
      Event event;
      client.run(beside.ended, [&](time::Nanoseconds, time::Nanoseconds) {
        while (client.events().take(event)) {
          if (event.kind != Event::Kind::refused) {
            show_event(1, words_of(event));
          } else if (!beside.ended.exchange(true)) {
            page_.report(0, "info", "no second law runs beside: " + std::string(event.words()));
            beside.refused = true;
          }
        }
        show_scene(1, client);
      });
    } catch (const std::exception& error) {
      page_.report(1, "error", error.what());
    }
  }

  void show_event(int track, const EventWords& words) {
    if (!words.simulated.empty())
      scenes_.at(static_cast<std::size_t>(track)).simulated = "simulated: " + words.simulated;
    page_.report(track, level_of(words), words.text);
  }

  void show_scene(int track, const Client& client) {
    const auto scene = client.scene_here();
    ShownScene& shown = scenes_.at(static_cast<std::size_t>(track));
    if (scene == shown.scene) return;
    shown.scene = scene;
    if (!scene) return;
    view::ShownScene appearance = view::shown(*scene, view::Which::all);
    view::add_words(appearance.more, shown.simulated);
    page_.set_scene(track, std::move(appearance));
  }

  void show(const std::vector<std::unique_ptr<LiveTrack>>& tracks) {
    shown_.clear();
    for (const auto& track : tracks) shown_.push_back(track->shown(page_.epoch()));
    state_ = maker_.state(choice_, *tracks.front());
    state_.network = network_;
    begin_on_page();
  }

  void begin_on_page() {
    scenes_.fill({});
    page_.begin_run(state_, shown_);
  }

  void consider(const page::Request& request, Client& client) {
    std::string about = "record";
    try {
      if (const auto* const choice = std::get_if<page::Choose>(&request)) {
        about = choice->setting;
        if (about == "network") return set_network(*choice, client);
        begin_next(maker_.suited(changed(choice_, *choice, state_.choices), choice_));
      } else if (const auto* const record = std::get_if<page::Record>(&request)) {
        PageChoice next = choice_;
        next.recording = record->on;
        begin_next(next);
      }
    } catch (const std::exception& error) {
      page_.refuse(about, error.what());
    }
  }

  void begin_next(const PageChoice& next) {
    if (next == choice_) return page_.set_state(state_);
    maker_.check(next);
    next_ = next;
    page_.report(0, "info", "begins anew: " + words_of_change(choice_, next));
    spdlog::info("begins anew: {}", words_of_change(choice_, next));
  }

  void set_network(const page::Choose& choice, Client& client) {
    if (!relay_) throw std::invalid_argument("no relay is there to tell: start the client with --relay-control");
    const auto* const wanted = std::get_if<page::Network>(&choice.value);
    if (wanted == nullptr) throw std::invalid_argument("network must have delay_ms, jitter_ms and loss_percent");
    network_ = relay_->set(*wanted);
    state_.network = network_;
    page_.set_state(state_);
    const std::string words = "network, each way: " + words_of_network(*network_);
    page_.report(0, "info", words);
    client.add_note(words);
  }

  int conclude(const Client& client) {
    const bool written = write_summary(file_of_run(options_.summary, run_), client.summary().to_json());
    const std::string why_none = client.why_no_session();
    if (!why_none.empty()) spdlog::error("gave up: {}", why_none);
    if (!next_) std::fputs(client.summary().to_text(text::colour_for(STDOUT_FILENO)).c_str(), stdout);
    return exit_code_of(client, written);
  }

  const Options& options_;
  TrackMaker maker_;
  const std::atomic<bool>& stop_;
  time::SteadyClock clock_;
  LivePage page_;
  std::optional<RelayControl> relay_;
  std::optional<page::Network> network_;
  std::optional<page::PageServer> server_;
  PageState state_;
  PageChoice choice_;
  std::optional<PageChoice> next_;
  std::optional<PageChoice> worked_;  ///< of the last run that came to its end
  int exit_code_ = program::kNeverConnected;
  std::vector<ShownTrack> shown_;       // of this run
  bool again_ = false;                  // this run, from where its hand is to begin
  std::optional<control::Vector> tip_;  // where the last run left it
  std::array<ShownScene, 2> scenes_{};  // each of its track's thread
  std::atomic<bool> ended_{false};      // this run
  time::Nanoseconds begun_{0};
  int run_ = 0;
};

}  // namespace

int run_with_page(const Options& options, const control::LawRegistry& laws, const device::DeviceRegistry& devices,
                  const std::atomic<bool>& stop) {
  return LiveRun(options, laws, devices, stop).run();
}

}  // namespace forcebound::client
