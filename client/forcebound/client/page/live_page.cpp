#include "forcebound/client/page/live_page.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>
#include <variant>

#include "forcebound/text/printable.hpp"
#include "forcebound/view/scene_parts.hpp"
#include "forcebound/view/shown_scene.hpp"

namespace forcebound::client {
namespace {

// Of 60 a second.
constexpr std::uint64_t kBeatsPerStatus = 15;
constexpr std::uint64_t kBeatsPerMovement = 2;

constexpr const char* kTooMany = "too many changes at once: wait until the last one is done";

page::Text shared(std::string text) { return std::make_shared<const std::string>(std::move(text)); }

/// @param here at this client @param server as the server tells; null: nothing is known
view::ShownScene appearance_of(const view::ShownScene* here, const view::ShownScene* server) {
  static const view::ShownScene kNothing;
  const view::ShownScene& told = server != nullptr ? *server : kNothing;
  return here != nullptr ? view::joined(*here, told) : told;
}

constexpr std::string_view kServicePrefix = "/choose/";

std::vector<live::Service> services() {
  std::vector<live::Service> all;
  all.reserve(kSettings.size());
  for (const Setting& setting : kSettings) {
    all.push_back(
        {.name = std::string(kServicePrefix) + std::string(setting.name), .schema = std::string(setting.schema)});
  }
  return all;
}

}  // namespace

LivePage::LivePage(const time::Clock& clock, time::Nanoseconds wall_clock)
    : clock_(clock),
      epoch_(clock.now()),
      foxglove_({.name = "forcebound-client " FORCEBOUND_VERSION,
                 .epoch = wall_clock,
                 .topics = {record::Topic::tick, record::Topic::force, record::Topic::scene, record::Topic::device,
                            record::Topic::arrows},
                 .services = services()},
                *this) {}

double LivePage::now_s() const noexcept { return time::to_seconds(clock_.now() - epoch_); }

/// Behind `lock_`.
void LivePage::queue(std::string message) { outbox_.push_back(std::move(message)); }

/// Likewise.
void LivePage::queue_hello() {
  queue(hello_message(state_, now_s()));
  hello_waits_ = true;
}

void LivePage::begin_run(PageState state, std::vector<ShownTrack> tracks) {
  const std::scoped_lock lock(lock_);
  state_ = std::move(state);
  scenes_.assign(tracks.size(), Scene());
  next_tracks_ = std::move(tracks);
  begin_m_.reset();
  closing_ = false;
  queue_hello();
}

void LivePage::set_closing() {
  const std::scoped_lock lock(lock_);
  closing_ = true;
}

void LivePage::set_state(PageState state) {
  const std::scoped_lock lock(lock_);
  state_ = std::move(state);
  queue_hello();
}

void LivePage::set_scene(int track, view::ShownScene scene) {
  auto here = std::make_shared<const view::ShownScene>(std::move(scene));
  const std::scoped_lock lock(lock_);
  const auto place = static_cast<std::size_t>(track);
  if (place >= scenes_.size()) return;
  scenes_[place].here = std::move(here);
  scenes_[place].changed = true;
}

void LivePage::report(int track, const std::string& level, const std::string& text) {
  const std::scoped_lock lock(lock_);
  std::string message = event_message(track, now_s(), level, text::printable(text));
  events_.push_back(message);
  if (events_.size() > kEventsKept) events_.pop_front();
  queue(std::move(message));
  ++events_waiting_;
}

void LivePage::refuse(const std::string& about, const std::string& text) {
  const std::scoped_lock lock(lock_);
  queue(refused_message(about, text::printable(text)));
  answer_call(text::printable(text));
}

std::optional<control::Vector> LivePage::take_begin() {
  const std::scoped_lock lock(lock_);
  return std::exchange(begin_m_, std::nullopt);
}

std::optional<page::Request> LivePage::take_request() {
  const std::scoped_lock lock(lock_);
  answer_call({});
  if (wishes_.empty()) return std::nullopt;
  Wish wish = std::move(wishes_.front());
  wishes_.pop_front();
  call_in_hand_ = wish.call;
  return std::move(wish.request);
}

/// Behind `lock_`.
void LivePage::answer_call(const std::string& refusal) {
  if (const auto call = std::exchange(call_in_hand_, std::nullopt)) answers_.emplace_back(*call, refusal);
}

bool LivePage::queue_wish(Wish wish) {
  const std::scoped_lock lock(lock_);
  if (wishes_.size() == kRequestsMost) return false;
  wishes_.push_back(std::move(wish));
  return true;
}

/// As the page's message `choose` would.
void LivePage::call(std::uint64_t number, const live::Service& service, const std::string& value) {
  try {
    nlohmann::json message = nlohmann::json::parse(value, nullptr, false);
    if (!message.is_object()) throw std::invalid_argument("a call needs a JSON object with value");
    message["kind"] = "choose";
    message["setting"] = service.name.substr(kServicePrefix.size());
    const auto request = page::read_request(message.dump());
    if (!queue_wish({.request = *request, .call = number})) foxglove_.answer(number, kTooMany);
  } catch (const std::invalid_argument& error) {
    foxglove_.answer(number, error.what());
  }
}

void LivePage::write_new(record::TopicEncoder& to, bool wanted) {
  std::vector<std::pair<std::uint64_t, std::string>> answers;
  WrittenScene scene;
  {
    const std::scoped_lock lock(lock_);
    answers.swap(answers_);
    if (!scenes_.empty()) scene = {scenes_.front().here, scenes_.front().server};
  }
  for (const auto& [call, refusal] : answers) foxglove_.answer(call, refusal);
  if (!tracks_.empty()) tracks_.front().shown.tap->records().drain(to, wanted);
  const double now = now_s();
  if (!wanted || scene == written_scene_ || now - scene_written_s_ < kSceneEvery_s) return;
  written_scene_ = scene;
  scene_written_s_ = now;
  to.write_scene(view::parts_of(appearance_of(scene.here.get(), scene.server.get())), clock_.now());
}

/// What waits in the outbox goes to this viewer too, at the next beat.
void LivePage::greet(page::ViewerId viewer, page::Viewers& viewers) {
  std::vector<page::Text> messages;
  {
    const std::scoped_lock lock(lock_);
    // Before the first run there is nothing to tell; its hello goes to all.
    if (scenes_.empty()) return;
    if (!hello_waits_) messages.push_back(shared(hello_message(state_, now_s())));
    for (Scene& scene : scenes_) {
      if (!scene.message) continue;
      if (hello_waits_) {
        scene.changed = true;  // after the hello
      } else {
        messages.push_back(scene.message);
      }
    }
    const std::size_t told = events_.size() - std::min(events_.size(), events_waiting_);
    for (std::size_t i = 0; i < told; ++i) messages.push_back(shared(events_[i]));
  }
  for (const page::Text& message : messages) viewers.send(viewer, message, page::Worth::needed);
  for (Track& track : tracks_) track.assembly.report_all_again();
}

/// Whoever leaves has nothing in the hand any more.
void LivePage::leave(page::ViewerId viewer) noexcept {
  if (dragging_ == viewer) let_go();
  const auto pressing = pressed_.find(viewer);
  if (pressing == pressed_.end()) return;
  const std::uint32_t buttons = pressing->second;
  pressed_.erase(pressing);
  for (int button = 0; button < std::numeric_limits<std::uint32_t>::digits; ++button) {
    if (((buttons >> static_cast<unsigned>(button)) & 1U) == 0) continue;
    for (const Track& track : tracks_) {
      if (track.shown.pointer) track.shown.pointer->press(button, false);
    }
  }
}

void LivePage::let_go() noexcept {
  hand_m_.reset();
  dragging_ = 0;
  for (const Track& track : tracks_) {
    if (track.shown.pointer) track.shown.pointer->let_go();
  }
}

void LivePage::receive(page::ViewerId viewer, std::string_view text, page::Viewers& viewers) {
  try {
    if (const auto request = page::read_request(text)) act_on(*request, viewer, viewers);
  } catch (const std::invalid_argument& error) {
    viewers.send(viewer, shared(refused_message("message", error.what())), page::Worth::stream);
  }
}

void LivePage::act_on(const page::Request& request, page::ViewerId viewer, page::Viewers& viewers) {
  const auto each_pointer = [this](auto use) {
    for (const Track& track : tracks_) {
      if (track.shown.pointer) use(*track.shown.pointer);
    }
  };
  if (const auto* const hand = std::get_if<page::HandAt>(&request)) {
    hand_m_ = hand->point_m;
    dragging_ = viewer;
    for (const Track& track : tracks_) point(track);
  } else if (std::holds_alternative<page::HandFree>(request)) {
    let_go();
  } else if (const auto* const button = std::get_if<page::Button>(&request)) {
    const std::uint32_t bit = 1U << static_cast<unsigned>(button->index);
    std::uint32_t& held = pressed_[viewer];
    held = button->down ? held | bit : held & ~bit;
    each_pointer([button](device::PointerTarget& pointer) { pointer.press(button->index, button->down); });
  } else if (std::holds_alternative<page::Choose>(request) || std::holds_alternative<page::Record>(request)) {
    const auto* const choice = std::get_if<page::Choose>(&request);
    if (queue_wish({.request = request})) return;
    viewers.send(viewer, shared(refused_message(choice != nullptr ? choice->setting : "record", kTooMany)),
                 page::Worth::stream);
  } else {
    viewers.send(viewer, shared(refused_message("message", "this is the page of a client")), page::Worth::stream);
  }
}

/// Also as the tip moves on towards a pointer that rests.
void LivePage::point(const Track& track) const {
  if (!track.shown.pointer || !hand_m_) return;
  device::PointerTarget::Point place_m = *hand_m_;
  const auto& newest = track.figures.newest();
  if (newest && newest->usable) {
    double squares = 0;
    for (std::size_t i = 0; i < place_m.size(); ++i) {
      place_m[i] -= newest->position_m[i];
      squares += place_m[i] * place_m[i];
    }
    const double share = std::min(1.0, track.shown.pull_m / std::sqrt(squares));
    for (std::size_t i = 0; i < place_m.size(); ++i) {
      place_m[i] = newest->position_m[i] + (squares > 0 ? share * place_m[i] : 0);
    }
  }
  track.shown.pointer->point_to(place_m);
}

/// Behind `lock_`.
void LivePage::begin_next_run() {
  if (!next_tracks_) return;
  tracks_.clear();
  for (ShownTrack& shown : *next_tracks_) {
    RunFigures figures(shown.figures);
    tracks_.push_back({.shown = std::move(shown), .figures = std::move(figures)});
  }
  next_tracks_.reset();
}

/// Of the page's thread alone: a description is read here.
void LivePage::receive_view(std::size_t number) {
  Track& track = tracks_[number];
  if (!track.shown.view) return;
  track.shown.view->drain([&](const view::Assembly::Piece& piece) {
    if (!track.assembly.add(piece)) return;
    auto server = std::make_shared<const view::ShownScene>(track.assembly.scene()->shown);
    const std::scoped_lock lock(lock_);
    if (next_tracks_ || number >= scenes_.size()) return;  // of a run that is over
    if (number == 0 && server->begin_m.rows() > 0) begin_m_ = server->begin_m;
    scenes_[number].server = std::move(server);
    scenes_[number].changed = true;
  });
}

void LivePage::show_scenes(page::Viewers& viewers) {
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    std::shared_ptr<const view::ShownScene> here;
    std::shared_ptr<const view::ShownScene> server;
    {
      const std::scoped_lock lock(lock_);
      if (next_tracks_ || i >= scenes_.size()) return;
      Scene& scene = scenes_[i];
      const double now = now_s();
      if (!scene.changed || (scene.shown_s >= 0 && now - scene.shown_s < kSceneEvery_s)) continue;
      // All of it is on its way to here.
      if (tracks_[i].shown.renders_locally && !scene.here && scene.server->empty()) continue;
      scene.changed = false;
      scene.shown_s = now;
      here = scene.here;
      server = scene.server;
    }
    const view::ShownScene appearance = appearance_of(here.get(), server.get());
    const page::Text message = shared(view::scene_message(static_cast<int>(i), appearance));
    viewers.send_to_all(message, page::Worth::needed);
    tracks_[i].assembly.report_all_again();
    const std::scoped_lock lock(lock_);
    if (!next_tracks_ && i < scenes_.size()) scenes_[i].message = message;
  }
}

void LivePage::show(Track& track, int number, bool closing, page::Viewers& viewers) {
  auto& [shown, figures, assembly] = track;
  std::optional<device::PointerTarget::Point> hand;
  if (shown.pointer && shown.pointer->held()) hand = shown.pointer->place_m();
  if (std::string ticks = figures.take_ticks(number, hand); !ticks.empty()) {
    viewers.send_to_all(shared(std::move(ticks)), page::Worth::stream);
  }
  if (beats_ % kBeatsPerMovement == 0) {
    if (std::string moved = assembly.take_moved(number); !moved.empty()) {
      viewers.send_to_all(shared(std::move(moved)), page::Worth::stream);
    }
  }
  if (beats_ % kBeatsPerStatus == 0) {
    viewers.send_to_all(shared(figures.status(number, shown.tap->dropped(), closing)), page::Worth::stream);
  }
}

void LivePage::beat(page::Viewers& viewers) {
  std::vector<std::string> outbox;
  bool closing = false;
  {
    const std::scoped_lock lock(lock_);
    begin_next_run();
    outbox.swap(outbox_);
    events_waiting_ = 0;
    hello_waits_ = false;
    closing = closing_;
  }
  for (std::string& message : outbox) viewers.send_to_all(shared(std::move(message)), page::Worth::needed);
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    auto& [shown, figures, assembly] = tracks_[i];
    shown.tap->drain([&figures = figures](const ForceSample& force) { figures.add(force); },
                     [&figures = figures](const TickSample& tick) { figures.add(tick); });
    point(tracks_[i]);
    receive_view(i);
  }
  if (viewers.count() > 0) show_scenes(viewers);
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (viewers.count() == 0) {
      tracks_[i].figures.leave_out_ticks();
    } else {
      show(tracks_[i], static_cast<int>(i), closing, viewers);
    }
  }
  ++beats_;
}

std::string LivePage::metrics() {
  std::string text;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    tracks_[i].figures.add_metrics(text, static_cast<int>(i), tracks_[i].shown.tap->dropped());
  }
  if (!tracks_.empty()) {
    text += "forcebound_client_records_dropped_total " +
            std::to_string(tracks_.front().shown.tap->records().dropped()) + "\n";
  }
  return text;
}

}  // namespace forcebound::client
