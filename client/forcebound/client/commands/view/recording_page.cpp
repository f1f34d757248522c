#include "forcebound/client/commands/view/recording_page.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>
#include <variant>

#include "forcebound/text/printable.hpp"

namespace forcebound::client::commands {
namespace {

using client::RunFigures;

// Of 60 a second.
constexpr std::uint64_t kBeatsPerStatus = 15;
// A slider that is dragged asks for more jumps than anybody sees.
constexpr std::uint64_t kBeatsPerJump = 6;
constexpr std::size_t kCheckpointTicks = 10000;
constexpr double kCheckpointEvery_s = 30;
constexpr std::size_t kTicksPerMessage = 1000;
constexpr std::size_t kEventsMost = 200;
constexpr int kAxesShown = 3;

page::Text shared(std::string text) { return std::make_shared<const std::string>(std::move(text)); }

RunFigures::Options options_of(const Recorded& recorded) {
  return {.degrees_of_freedom = std::clamp(recorded.degrees_of_freedom, 1, kAxesShown),
          .period = recorded.info.period,
          .epoch = recorded.ticks.front().time,
          .audited = recorded.info.audited};
}

client::PageState state_of(const Recorded& recorded, const std::string& file) {
  const record::RunInfo& info = recorded.info;
  return {.choice = {.law = info.law, .scene = recorded.scene(), .device = info.device},
          .simulated = info.device_simulated,
          .degrees_of_freedom = std::clamp(recorded.degrees_of_freedom, 1, kAxesShown),
          .period_s = time::to_seconds(info.period),
          .replay = client::Replay{.file = file, .duration_s = recorded.duration_s()}};
}

const char* words_of(record::SessionState state) noexcept {
  switch (state) {
    case record::SessionState::connecting:
      return "connecting";
    case record::SessionState::active:
      return "connected";
    case record::SessionState::stale:
      return "no new force for longer than it is held";
    case record::SessionState::reconnecting:
      return "no new force for so long that there is none: connecting again";
  }
  return "unknown state";
}

}  // namespace

RecordingPage::RecordingPage(Recorded recorded, const std::string& file, std::string scene, const time::Clock& clock)
    : recorded_(std::move(recorded)),
      scene_(std::move(scene)),
      clock_(clock),
      state_(state_of(recorded_, file)),
      now_{.figures = RunFigures(options_of(recorded_))},
      last_beat_(clock.now()) {
  mark_checkpoints();
  collect_events();
}

double RecordingPage::time_s(std::size_t tick) const noexcept {
  return time::to_seconds(recorded_.ticks[tick].time - recorded_.ticks.front().time);
}

std::size_t RecordingPage::tick_at(double time_s) const noexcept {
  const time::Nanoseconds at = recorded_.ticks.front().time + time::from_seconds(time_s);
  const auto after = std::ranges::upper_bound(recorded_.ticks, at, {}, &client::TickSample::time);
  return static_cast<std::size_t>(after - recorded_.ticks.begin());
}

void RecordingPage::mark_checkpoints() {
  double next_s = 0;
  std::size_t next_tick = 0;
  while (now_.tick < recorded_.ticks.size()) {
    // Not only by time: a file may say that its ticks are hours apart.
    if (time_s(now_.tick) >= next_s && now_.tick >= next_tick) {
      checkpoints_.push_back(now_);
      next_tick = now_.tick + kCheckpointTicks;
      next_s = time_s(now_.tick) + kCheckpointEvery_s;
    }
    go_on_to(now_.tick + 1);
    now_.figures.leave_out_ticks();
  }
  now_ = checkpoints_.front();
}

void RecordingPage::collect_events() {
  struct TimedEvent {
    double at_s = 0;
    std::string level;
    std::string text;
  };
  std::vector<TimedEvent> all;
  const auto add = [&all](double at_s, std::string level, std::string text) {
    all.push_back({.at_s = at_s, .level = std::move(level), .text = std::move(text)});
  };
  if (!recorded_.flaw.empty()) add(0, "warning", recorded_.flaw);
  std::optional<record::SessionState> last;
  for (std::size_t i = 0; i < recorded_.ticks.size(); ++i) {
    const record::SessionState state = recorded_.ticks[i].state;
    if (state == std::exchange(last, state)) continue;
    const bool good = state == record::SessionState::active || i == 0;
    add(time_s(i), good ? "info" : "warning", words_of(state));
  }
  auto robot = control::FollowerState::none;
  for (const client::ForceSample& force : recorded_.forces) {
    if (force.follower == std::exchange(robot, force.follower)) continue;
    const double at_s = time::to_seconds(force.received - recorded_.ticks.front().time);
    add(at_s, "info", "the robot: " + std::string(name_of(robot)));
  }
  if (recorded_.totals) {
    for (const std::string& note : recorded_.totals->notes) add(recorded_.duration_s(), "info", note);
  }
  std::ranges::stable_sort(all, {}, &TimedEvent::at_s);
  if (all.size() > kEventsMost) all.resize(kEventsMost);
  for (const TimedEvent& one : all) {
    events_.push_back(client::event_message(0, one.at_s, one.level, text::printable(one.text)));
  }
}

void RecordingPage::go_on_to(std::size_t tick) {
  for (; now_.tick < tick; ++now_.tick) {
    const client::TickSample& next = recorded_.ticks[now_.tick];
    // An answer that came before the command of a tick may be in it.
    while (now_.force < recorded_.forces.size() && recorded_.forces[now_.force].received <= next.time + next.latency) {
      now_.figures.add(recorded_.forces[now_.force++]);
    }
    now_.figures.add(next);
  }
}

void RecordingPage::send_ticks(page::Viewers& viewers) {
  if (std::string ticks = now_.figures.take_ticks(0, std::nullopt); !ticks.empty()) {
    viewers.send_to_all(shared(std::move(ticks)), page::Worth::needed);
  }
}

void RecordingPage::send_hello(page::Viewers& viewers) const {
  viewers.send_to_all(shared(client::hello_message(state_, now_s_)), page::Worth::needed);
}

void RecordingPage::jump(double to_s, page::Viewers& viewers) {
  now_s_ = std::clamp(to_s, 0.0, recorded_.duration_s());
  const std::size_t past = now_s_ > kPast_s ? tick_at(now_s_ - kPast_s) : 0;
  const std::size_t end = tick_at(now_s_);
  const auto after = std::ranges::upper_bound(checkpoints_, past, {}, &Checkpoint::tick);
  now_ = after == checkpoints_.begin() ? checkpoints_.front() : *std::prev(after);
  while (now_.tick < past) {
    go_on_to(std::min(past, now_.tick + kTicksPerMessage));
    now_.figures.leave_out_ticks();
  }
  while (now_.tick < end) {
    go_on_to(std::min(end, now_.tick + kTicksPerMessage));
    send_ticks(viewers);
  }
}

void RecordingPage::greet(page::ViewerId viewer, page::Viewers& viewers) {
  viewers.send(viewer, shared(client::hello_message(state_, now_s_)), page::Worth::needed);
  viewers.send(viewer, shared(scene_), page::Worth::needed);
  for (const std::string& event : events_) viewers.send(viewer, shared(event), page::Worth::needed);
  if (!jump_to_s_) jump_to_s_ = now_s_;
}

void RecordingPage::receive(page::ViewerId viewer, std::string_view text, page::Viewers& viewers) {
  try {
    if (const auto request = page::read_request(text)) act_on(*request, viewer, viewers);
  } catch (const std::invalid_argument& error) {
    viewers.send(viewer, shared(client::refused_message("message", error.what())), page::Worth::stream);
  }
}

void RecordingPage::act_on(const page::Request& request, page::ViewerId viewer, page::Viewers& viewers) {
  if (const auto* const seek = std::get_if<page::Seek>(&request)) {
    jump_to_s_ = seek->time_s;
  } else if (const auto* const wanted = std::get_if<page::Play>(&request)) {
    play(wanted->on, wanted->speed, viewers);
  } else {
    viewers.send(viewer, shared(client::refused_message("message", "this is the page of a recording: it has happened")),
                 page::Worth::stream);
  }
}

void RecordingPage::play(bool on, double speed, page::Viewers& viewers) {
  // From the end it begins anew.
  if (on && !state_.replay->playing && !jump_to_s_ && now_.tick == recorded_.ticks.size()) jump_to_s_ = 0;
  state_.replay->playing = on;
  state_.replay->speed = speed;
  send_hello(viewers);
}

void RecordingPage::beat(page::Viewers& viewers) {
  const time::Nanoseconds now = clock_.now();
  const double elapsed_s = time::to_seconds(now - std::exchange(last_beat_, now));
  ++beats_;
  // Until somebody looks it waits at its beginning, and whenever nobody does.
  if (viewers.count() == 0) return;
  if (jump_to_s_ && beats_ - jumped_ >= kBeatsPerJump) {
    jumped_ = beats_;
    jump(*std::exchange(jump_to_s_, std::nullopt), viewers);
    viewers.send_to_all(shared(now_.figures.status(0, 0, false)), page::Worth::stream);
    return;
  }
  if (state_.replay->playing && !jump_to_s_) {
    now_s_ = std::min(now_s_ + elapsed_s * state_.replay->speed, recorded_.duration_s());
    for (const std::size_t end = tick_at(now_s_); now_.tick < end;) {
      go_on_to(std::min(end, now_.tick + kTicksPerMessage));
      send_ticks(viewers);
    }
    if (now_.tick == recorded_.ticks.size()) {
      state_.replay->playing = false;
      send_hello(viewers);
    }
  }
  if (beats_ % kBeatsPerStatus == 0) {
    viewers.send_to_all(shared(now_.figures.status(0, 0, false)), page::Worth::stream);
  }
}

std::string RecordingPage::metrics() {
  std::string text;
  now_.figures.add_metrics(text, 0, 0);
  return text;
}

}  // namespace forcebound::client::commands
