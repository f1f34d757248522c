#include "forcebound/server/app/page_observer.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "forcebound/page/json_number.hpp"

namespace forcebound::server {
namespace {

using Json = nlohmann::json;

constexpr double kPercent = 100;
constexpr double kMedian = 0.5;
constexpr double kRare = 0.99;
// Without motion for so long, a session is shown as silent.
constexpr time::Nanoseconds kSilent = std::chrono::seconds{1};

Json microseconds(double nanoseconds) {
  constexpr double kMicro = 1e3;
  return std::isfinite(nanoseconds) ? Json(nanoseconds / kMicro) : Json(nullptr);
}

void add_metric(std::string& to, const std::string& name, double value) {
  constexpr int kDigits = 12;
  std::string number;
  page::add_number(number, value, kDigits);
  to += "forcebound_server_" + name + " " + (number == "null" ? "NaN" : number) + "\n";
}

}  // namespace

double PageObserver::Figures::lost_up_percent() const noexcept {
  if (first_motion == 0 || newest_motion < first_motion) return 0;
  const auto numbered = static_cast<double>(newest_motion - first_motion + 1);
  const auto received = static_cast<double>(motions_received - motions_before);
  return std::max(0.0, kPercent * (1 - received / numbered));
}

PageObserver::Row PageObserver::row_of(const Figures& figures) const {
  const time::Nanoseconds now = clock_.now();
  return {.number = figures.shown,
          .info = figures.info,
          .silent = now - figures.answered > kSilent,
          .since_s = time::to_seconds(now - figures.opened),
          .lost_up_percent = figures.lost_up_percent(),
          .motions_received = figures.motions_received,
          .forces_sent = figures.forces_sent,
          .unsound = figures.unsound,
          .quarantined = figures.quarantined,
          .compute_median_ns = figures.compute.percentile(kMedian),
          .compute_rare_ns = figures.compute.percentile(kRare)};
}

PageObserver::Snapshot PageObserver::snapshot(const Lock& lock) const {
  const auto locked = [&lock] { return lock ? lock() : std::unique_lock<std::mutex>(); };
  Snapshot all;
  std::uint64_t before = 0;
  {
    const auto held = locked();
    all.scenes = scenes_;
    all.opened = opened_;
    all.refused = refused_;
    all.sessions.reserve(shown_.size());
  }
  // One at a time, by number: some may end and others begin between two.
  while (true) {
    const auto held = locked();
    const auto next = shown_.upper_bound(before);
    if (next == shown_.end() || next->first > all.opened) return all;
    before = next->first;
    all.sessions.push_back(row_of(sessions_.at(next->second)));
  }
}

std::string PageObserver::Snapshot::sessions_message(const Load& load) const {
  Json rows = Json::array();
  for (const Row& row : sessions) {
    Json faults = Json::array();
    if (row.unsound > 0) faults.push_back({{"name", "unsound response"}, {"count", row.unsound}});
    if (row.quarantined > 0) faults.push_back({{"name", "part left out"}, {"count", row.quarantined}});
    rows.push_back(
        {{"id", row.number},
         {"client", row.info.client},
         {"address", net::to_string(row.info.address)},
         {"scene", row.info.scene},
         {"device", row.info.device},
         {"state", row.silent ? "silent" : "active"},
         {"lost_up_percent", row.lost_up_percent},
         {"compute_us", {{"median", microseconds(row.compute_median_ns)}, {"p99", microseconds(row.compute_rare_ns)}}},
         {"faults", faults},
         {"since_s", row.since_s}});
  }
  const Json message{{"kind", "sessions"},
                     {"sessions", rows},
                     {"load",
                      {{"processor_percent", kPercent * load.busy},
                       {"motions_per_s", load.motions_per_s},
                       {"places_used", load.places_used},
                       {"places", load.places}}}};
  return message.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string PageObserver::Snapshot::metrics(const Load& load) const {
  std::string text;
  add_metric(text, "sessions", static_cast<double>(load.places_used));
  add_metric(text, "sessions_most", static_cast<double>(load.places));
  add_metric(text, "sessions_opened_total", static_cast<double>(opened));
  add_metric(text, "refused_total", static_cast<double>(refused));
  add_metric(text, "busy_ratio", load.busy);
  for (const Row& row : sessions) {
    const std::string label = "{session=\"" + std::to_string(row.number) + "\"";
    constexpr double kNano = 1e-9;
    add_metric(text, "motions_received" + label + "}", static_cast<double>(row.motions_received));
    add_metric(text, "forces_sent" + label + "}", static_cast<double>(row.forces_sent));
    add_metric(text, "lost_up_ratio" + label + "}", row.lost_up_percent / kPercent);
    add_metric(text, "compute_seconds" + label + ",quantile=\"0.5\"}", kNano * row.compute_median_ns);
    add_metric(text, "compute_seconds" + label + ",quantile=\"0.99\"}", kNano * row.compute_rare_ns);
  }
  const std::string name = "forcebound_server_scene_compute_seconds";
  if (!scenes.empty()) text += "# TYPE " + name + " histogram\n";
  for (const auto& [scene, histogram] : scenes) histogram.write(text, name, "scene=" + page::label_value(scene));
  return text;
}

std::optional<std::uint64_t> PageObserver::session_of(std::uint64_t shown) const {
  const auto found = shown_.find(shown);
  if (found == shown_.end()) return std::nullopt;
  return found->second;
}

void PageObserver::on_opened(const SessionInfo& info) {
  next_.on_opened(info);
  Figures& figures = sessions_[info.session];
  figures.info = info;
  figures.shown = ++opened_;
  figures.opened = figures.answered = clock_.now();
  shown_[figures.shown] = info.session;
  figures.compute_of_scene = &scenes_[info.scene];
}

void PageObserver::on_closed(const SessionInfo& info, CloseReason reason, const wire::Bye& final_counts) {
  next_.on_closed(info, reason, final_counts);
  const auto found = sessions_.find(info.session);
  if (found == sessions_.end()) return;
  shown_.erase(found->second.shown);
  sessions_.erase(found);
}

void PageObserver::on_refused(const net::Address& address, std::string_view text) {
  ++refused_;
  next_.on_refused(address, text);
}

void PageObserver::on_scene_failed(std::string_view scene, std::string_view why) { next_.on_scene_failed(scene, why); }

void PageObserver::on_unsound_response(const SessionInfo& info) noexcept {
  next_.on_unsound_response(info);
  if (const auto found = sessions_.find(info.session); found != sessions_.end()) ++found->second.unsound;
}

void PageObserver::on_quarantined(const SessionInfo& info, std::string_view object) noexcept {
  next_.on_quarantined(info, object);
  if (const auto found = sessions_.find(info.session); found != sessions_.end()) ++found->second.quarantined;
}

void PageObserver::on_motion(const wire::MotionSample& motion) noexcept {
  next_.on_motion(motion);
  if (records_ && records_->wanted()) records_->on_motion({.receive_time = clock_.now(), .motion = motion});
}

void PageObserver::on_force(const wire::EnvironmentForce& force) noexcept {
  next_.on_force(force);
  if (records_) records_->on_sent({.force = force});
  const auto found = sessions_.find(force.session);
  if (found == sessions_.end()) return;
  Figures& figures = found->second;
  if (figures.first_motion == 0) {
    figures.first_motion = force.motion_sequence;
    figures.motions_before = force.motions_received - 1;
  }
  figures.newest_motion = force.motion_sequence;
  figures.motions_received = force.motions_received;
  figures.answered = force.server_send_time;
  ++figures.forces_sent;
  figures.compute.add(force.compute_time.count());
  figures.compute_of_scene->add(time::to_seconds(force.compute_time));
}

}  // namespace forcebound::server
