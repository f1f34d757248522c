#include "forcebound/server/app/server_page.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>
#include <variant>

#include "forcebound/page/request.hpp"

namespace forcebound::server {
namespace {

using Json = nlohmann::json;

// Of 60 a second.
constexpr std::uint64_t kBeatsPerMovement = 2;

page::Text shared(std::string text) { return std::make_shared<const std::string>(std::move(text)); }

std::string refused(const std::string& about, const std::string& why) {
  const Json message{{"kind", "refused"}, {"about", about}, {"text", why}};
  return message.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

ServerPage::ServerPage(const time::Clock& clock, Options options)
    : clock_(clock),
      epoch_(clock.now()),
      options_(std::move(options)),
      foxglove_({.name = "forcebound-server " FORCEBOUND_VERSION,
                 .epoch = options_.wall_clock,
                 .topics = {record::Topic::motion, record::Topic::force, record::Topic::scene, record::Topic::device,
                            record::Topic::arrows}},
                *this) {}

double ServerPage::now_s() const noexcept { return time::to_seconds(clock_.now() - epoch_); }

void ServerPage::show(std::string sessions, std::string metrics) {
  const std::scoped_lock lock(lock_);
  sessions_ = std::move(sessions);
  metrics_ = std::move(metrics);
  fresh_ = true;
  awaited_ = false;
  shown_.notify_all();
}

void ServerPage::report(const std::string& level, const std::string& text) {
  const Json message{{"kind", "event"}, {"track", 0}, {"time_s", now_s()}, {"level", level}, {"text", text}};
  page::Text event = shared(message.dump(-1, ' ', false, Json::error_handler_t::replace));
  const std::scoped_lock lock(lock_);
  events_.push_back(std::move(event));
  if (events_.size() > kEventsKept) events_.pop_front();
  events_waiting_ = std::min(events_waiting_ + 1, events_.size());
}

void ServerPage::set_robot(const view::Description& appearance) {
  for (std::uint32_t i = 0; i < appearance.pieces(); ++i) {
    (void)assembly_.add(
        {.view = appearance.hash, .pieces = appearance.pieces(), .number = i, .content = appearance.piece(i)});
  }
  view_ = appearance.hash;
  if (!assembly_.scene()) throw std::logic_error("the page cannot read how its own robot looks");
  scene_ = view::scene_message(0, assembly_.scene()->shown);
  for (auto* const groups : {&moved_, &sent_}) {
    groups->resize(appearance.moving.size());
    for (std::vector<float>& group : *groups) group.reserve(view::kNumbersMost);
  }
}

void ServerPage::move_robot(std::size_t group, std::span<const float> numbers) {
  const std::scoped_lock lock(lock_);
  moved_.at(group).assign(numbers.begin(), numbers.end());
}

std::optional<std::uint64_t> ServerPage::take_kick() {
  const std::scoped_lock lock(lock_);
  if (kicks_.empty()) return std::nullopt;
  const std::uint64_t session = kicks_.front();
  kicks_.pop_front();
  return session;
}

std::string ServerPage::hello() const {
  const Json none = Json::array();
  const Json message{{"kind", "hello"},
                     {"protocol", 1},
                     {"program", "server"},
                     {"version", FORCEBOUND_VERSION},
                     {"time_s", now_s()},
                     {"period_s", nullptr},
                     {"dof", 3},
                     {"simulated", false},
                     {"pointer", false},
                     {"may_change", false},
                     {"choices", {{"laws", none}, {"scenes", none}, {"devices", none}}},
                     {"settings",
                      {{"law", nullptr},
                       {"law_beside", nullptr},
                       {"scene", nullptr},
                       {"device", nullptr},
                       {"stiffness_N_per_m", nullptr},
                       {"network", nullptr}}},
                     {"recording", options_.recording.empty() ? Json(nullptr) : Json(options_.recording)},
                     {"duration_s", nullptr},
                     {"tracks", none},
                     {"read_only", false}};
  return message.dump(-1, ' ', false, Json::error_handler_t::replace);
}

void ServerPage::greet(page::ViewerId viewer, page::Viewers& viewers) {
  viewers.send(viewer, shared(hello()), page::Worth::needed);
  std::string sessions;
  std::vector<page::Text> told;  // to the others; what waits goes to this one too
  {
    const std::scoped_lock lock(lock_);
    sessions = sessions_;
    told.assign(events_.begin(), events_.end() - static_cast<std::ptrdiff_t>(events_waiting_));
  }
  for (page::Text& event : told) viewers.send(viewer, std::move(event), page::Worth::needed);
  if (!sessions.empty()) viewers.send(viewer, shared(std::move(sessions)), page::Worth::needed);
  if (scene_.empty()) return;
  viewers.send(viewer, shared(scene_), page::Worth::needed);
  assembly_.report_all_again();
}

void ServerPage::receive(page::ViewerId viewer, std::string_view text, page::Viewers& viewers) {
  const auto refuse = [&](const std::string& about, const std::string& why) {
    viewers.send(viewer, shared(refused(about, why)), page::Worth::stream);
  };
  try {
    const auto request = page::read_request(text);
    if (!request) return;
    const auto* const kick = std::get_if<page::Kick>(&*request);
    if (kick == nullptr) return refuse("message", "this is the page of a server, which takes kick alone");
    if (!queue_kick(kick->session)) refuse("kick", "too many at once: wait until the last ones are done");
  } catch (const std::invalid_argument& error) {
    refuse("message", error.what());
  }
}

bool ServerPage::queue_kick(std::uint64_t kick) {
  const std::scoped_lock lock(lock_);
  if (kicks_.size() == kKicksMost) return false;
  kicks_.push_back(kick);
  return true;
}

void ServerPage::beat(page::Viewers& viewers) {
  watched_ = viewers.count() > 0 || (options_.records != nullptr && options_.records->wanted());
  std::vector<page::Text> events;
  std::string sessions;
  // Swapped, so that the server's thread, which waits for the lock, never waits for memory.
  for (std::vector<float>& group : sent_) group.clear();
  {
    const std::scoped_lock lock(lock_);
    moved_.swap(sent_);
    events.assign(events_.end() - static_cast<std::ptrdiff_t>(events_waiting_), events_.end());
    events_waiting_ = 0;
    if (std::exchange(fresh_, false)) sessions = sessions_;
  }
  for (page::Text& event : events) viewers.send_to_all(std::move(event), page::Worth::needed);
  if (!sessions.empty()) viewers.send_to_all(shared(std::move(sessions)), page::Worth::stream);
  for (std::size_t group = 0; group < sent_.size(); ++group) {
    (void)assembly_.add({.view = view_,
                         .number = static_cast<std::uint32_t>(group),
                         .content = std::as_bytes(std::span(sent_[group]))});
  }
  if (++beats_ % kBeatsPerMovement != 0) return;
  std::string message = assembly_.take_moved(0);
  if (!message.empty()) viewers.send_to_all(shared(std::move(message)), page::Worth::stream);
}

void ServerPage::set_scene(const std::string& name) {
  const std::scoped_lock lock(lock_);
  scene_name_ = name;
}

void ServerPage::write_new(record::TopicEncoder& to, bool wanted) {
  if (options_.records != nullptr) options_.records->drain(to, wanted);
  std::string name;
  {
    const std::scoped_lock lock(lock_);
    name = scene_name_;
  }
  if (!wanted || name == written_scene_name_) return;
  written_scene_name_ = name;
  if (options_.parts_of) to.write_scene(options_.parts_of(name), clock_.now());
}

std::string ServerPage::metrics() {
  constexpr std::chrono::milliseconds kPatience{500};
  std::unique_lock lock(lock_);
  if (watched_ && !metrics_.empty()) return metrics_;
  awaited_ = true;
  shown_.wait_for(lock, kPatience, [this] { return !awaited_; });
  return metrics_;
}

}  // namespace forcebound::server
