#include "forcebound/client/page/live_page.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <variant>

#include "forcebound/text/printable.hpp"

namespace forcebound::client {
namespace {

// Of 60 a second.
constexpr std::uint64_t kBeatsPerStatus = 15;

page::Text shared(std::string text) { return std::make_shared<const std::string>(std::move(text)); }

}  // namespace

LivePage::LivePage(const time::Clock& clock) : clock_(clock), epoch_(clock.now()) {}

double LivePage::now_s() const noexcept { return time::to_seconds(clock_.now() - epoch_); }

/// Behind `lock_`.
void LivePage::queue(std::string message) { outbox_.push_back(std::move(message)); }

void LivePage::begin_run(PageState state, std::vector<ShownTrack> tracks) {
  const std::scoped_lock lock(lock_);
  state_ = std::move(state);
  scenes_.assign(tracks.size(), {});
  next_tracks_ = std::move(tracks);
  closing_ = false;
  queue(hello_message(state_, now_s()));
}

void LivePage::note_closing() {
  const std::scoped_lock lock(lock_);
  closing_ = true;
}

void LivePage::set_state(PageState state) {
  const std::scoped_lock lock(lock_);
  state_ = std::move(state);
  queue(hello_message(state_, now_s()));
}

void LivePage::set_scene(int track, std::string message) {
  const std::scoped_lock lock(lock_);
  const auto place = static_cast<std::size_t>(track);
  if (place >= scenes_.size()) return;
  scenes_[place] = message;
  queue(std::move(message));
}

void LivePage::tell(int track, const std::string& level, const std::string& text) {
  const std::scoped_lock lock(lock_);
  std::string message = event_message(track, now_s(), level, text::printable(text));
  events_.push_back(message);
  if (events_.size() > kEventsKept) events_.pop_front();
  queue(std::move(message));
}

void LivePage::refuse(const std::string& about, const std::string& text) {
  const std::scoped_lock lock(lock_);
  queue(refused_message(about, text::printable(text)));
}

std::optional<page::Request> LivePage::take_request() {
  const std::scoped_lock lock(lock_);
  if (requests_.empty()) return std::nullopt;
  page::Request request = std::move(requests_.front());
  requests_.pop_front();
  return request;
}

void LivePage::greet(page::ViewerId viewer, page::Viewers& viewers) {
  const std::scoped_lock lock(lock_);
  // Before the first run there is nothing to tell; its hello goes to all.
  if (scenes_.empty()) return;
  viewers.send(viewer, shared(hello_message(state_, now_s())), page::Worth::needed);
  for (const std::string& scene : scenes_) {
    if (!scene.empty()) viewers.send(viewer, shared(scene), page::Worth::needed);
  }
  for (const std::string& event : events_) viewers.send(viewer, shared(event), page::Worth::needed);
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
    for (const Track& track : tracks_) point(track);
  } else if (std::holds_alternative<page::HandFree>(request)) {
    hand_m_.reset();
    each_pointer([](device::PointerTarget& pointer) { pointer.let_go(); });
  } else if (const auto* const button = std::get_if<page::Button>(&request)) {
    each_pointer([button](device::PointerTarget& pointer) { pointer.press(button->index, button->down); });
  } else if (std::holds_alternative<page::Choose>(request) || std::holds_alternative<page::Record>(request)) {
    const auto* const choice = std::get_if<page::Choose>(&request);
    const std::scoped_lock lock(lock_);
    if (requests_.size() < kRequestsMost) return requests_.push_back(request);
    viewers.send(viewer,
                 shared(refused_message(choice != nullptr ? choice->setting : "record",
                                        "too many changes at once: wait until the last one is done")),
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
void LivePage::take_run() {
  if (!next_tracks_) return;
  tracks_.clear();
  for (ShownTrack& shown : *next_tracks_) {
    RunFigures figures(shown.figures);
    tracks_.push_back({.shown = std::move(shown), .figures = std::move(figures)});
  }
  next_tracks_.reset();
}

void LivePage::beat(page::Viewers& viewers) {
  std::vector<std::string> outbox;
  bool closing = false;
  {
    const std::scoped_lock lock(lock_);
    take_run();
    outbox.swap(outbox_);
    closing = closing_;
  }
  for (std::string& message : outbox) viewers.send_to_all(shared(std::move(message)), page::Worth::needed);
  const bool status_due = beats_++ % kBeatsPerStatus == 0;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    auto& [shown, figures] = tracks_[i];
    shown.tap->take([&figures = figures](const ForceSample& force) { figures.add(force); },
                    [&figures = figures](const TickSample& tick) { figures.add(tick); });
    point(tracks_[i]);
    std::optional<device::PointerTarget::Point> hand;
    if (shown.pointer && shown.pointer->held()) hand = shown.pointer->place_m();
    if (viewers.count() == 0) {
      figures.leave_out_ticks();
      continue;
    }
    const auto track = static_cast<int>(i);
    if (std::string ticks = figures.take_ticks(track, hand); !ticks.empty()) {
      viewers.send_to_all(shared(std::move(ticks)), page::Worth::stream);
    }
    if (!status_due) continue;
    viewers.send_to_all(shared(figures.status(track, shown.tap->dropped(), closing)), page::Worth::stream);
  }
}

std::string LivePage::metrics() {
  std::string text;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    tracks_[i].figures.add_metrics(text, static_cast<int>(i), tracks_[i].shown.tap->dropped());
  }
  return text;
}

}  // namespace forcebound::client
