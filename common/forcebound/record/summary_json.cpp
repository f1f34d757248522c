#include <nlohmann/json.hpp>

#include "forcebound/record/internal/summary_view.hpp"

namespace forcebound::record {
namespace {

using Json = nlohmann::ordered_json;

Json percentiles(const Histogram& ns, double unit_ns, bool p999, bool max) {
  Json object{{"p50", ns.percentile(0.5) / unit_ns}, {"p99", ns.percentile(0.99) / unit_ns}};
  if (p999) object["p999"] = ns.percentile(0.999) / unit_ns;
  if (max) object["max"] = ns.max() / unit_ns;
  return object;
}

Json count_json(const std::optional<std::uint64_t>& count) { return count ? Json(*count) : Json(nullptr); }

Json blackout_json(const Blackout& blackout) {
  Json object{{"died", what_died(blackout)}};
  const std::pair<const char*, std::uint64_t> counts[] = {{"motions", blackout.motions},
                                                          {"lost_up", blackout.lost_up},
                                                          {"answers", blackout.answers},
                                                          {"lost_down", blackout.lost_down}};
  for (const auto& [name, count] : counts) object[name] = blackout.counted ? Json(count) : Json(nullptr);
  return object;
}

const char* name_of(SummaryView::Verdict verdict) {
  using Verdict = SummaryView::Verdict;
  switch (verdict) {
    case Verdict::passive:
      return "passive";
    case Verdict::not_passive:
      return "not passive";
    case Verdict::not_audited:
      return "not audited";
    case Verdict::no_contact:
      return "no contact";
    case Verdict::never_connected:
      return "never connected";
  }
  return "";
}

Json ok_json(SummaryView::Verdict verdict) {
  if (verdict == SummaryView::Verdict::passive) return true;
  if (verdict == SummaryView::Verdict::not_passive) return false;
  return nullptr;
}

}  // namespace

SummaryView::Verdict SummaryView::verdict() const {
  // The measurement comes first: generated energy is reported, contact or not.
  if (s.info_.audited && !(minimum_J() >= kPassiveLeast_J)) return Verdict::not_passive;
  if (!s.connected_) return Verdict::never_connected;
  if (!touched()) return Verdict::no_contact;
  return s.info_.audited ? Verdict::passive : Verdict::not_audited;
}

void SummaryView::add_run(Json& json) const {
  const RunInfo& info = s.info_;
  json["law"] = info.law;
  json["device"] = info.device;
  json["operator"] = info.operator_name;
  json["scene"] = scene();
  json["encryption"] = info.encryption.empty() ? Json(nullptr) : Json(info.encryption);
  json["duration_s"] = duration_s();
  json["ticks"] = s.ticks_;
  json["period_us"] = percentiles(s.period_ns_, 1e3, true, true);
  json["late_ticks"] = s.late_ticks_;
  if (const IdleTimer* idle = idle_timer()) {
    json["idle_timer"] = {
        {"period_us", {{"p50", idle->p50_us}, {"p99", idle->p99_us}, {"p999", idle->p999_us}, {"max", idle->max_us}}},
        {"late", idle->late},
        {"wake_ups", idle->wake_ups}};
  }
}

void SummaryView::add_network(Json& json) const {
  json["sent"] = sent();
  json["received"] = received();
  json["lost"] = count_json(lost());
  json["duplicated"] = count_json(total(&RunTotals::duplicated));
  json["reordered"] = count_json(total(&RunTotals::reordered));
  json["lost_up"] = count_json(total(&RunTotals::lost_up));
  json["lost_down"] = count_json(total(&RunTotals::lost_down));
  json["motions"] = motions();
  json["stale_ticks"] = stale_ticks();
  json["late_force"] = {
      {"fading_ticks", s.fading_ticks_}, {"dropped_ticks", s.dropped_ticks_}, {"changes", s.policy_changes_}};
  json["blackouts"] = blackouts();
  json["server_clock_ms"] = server_clock();
  json["follower"] = follower();
  json["rendering"] = {{"asked", s.info_.rendering},
                       {"at_client", share(s.at_client_ticks_)},
                       {"both", share(s.both_ticks_)},
                       {"held", share(s.ticks_ - s.at_client_ticks_ - s.both_ticks_)},
                       {"modelled", share(s.modelled_ticks_)},
                       {"model_trust", s.model_trust_.mean()},
                       {"scene_pieces", count_json(total(&RunTotals::scene_pieces))},
                       {"scene_piece_bytes", count_json(total(&RunTotals::scene_piece_bytes))},
                       {"scenes_from_cache", count_json(total(&RunTotals::scenes_from_cache))}};
}

nlohmann::ordered_json SummaryView::server_clock() const {
  if (!s.totals_ || !s.totals_->server_ahead || !s.totals_->server_ahead_off) return nullptr;
  return {{"ahead", 1e3 * time::to_seconds(*s.totals_->server_ahead)},
          {"off", 1e3 * time::to_seconds(*s.totals_->server_ahead_off)}};
}

nlohmann::ordered_json SummaryView::follower() const {
  if (!s.has_follower_) return nullptr;
  Json seconds = Json::object();
  for (std::uint8_t i = 1; i < control::kFollowerStates; ++i) {
    seconds[std::string(control::name_of(static_cast<control::FollowerState>(i)))] =
        time::to_seconds(s.follower_times_.at(i));
  }
  return {{"state", std::string(control::name_of(s.follower_))},
          {"changes", s.follower_changes_},
          {"seconds", seconds},
          {"unknown_s", time::to_seconds(s.follower_unknown_)}};
}

nlohmann::ordered_json SummaryView::motions() const {
  if (!s.totals_) return nullptr;
  const MotionFates fates = fates_of(*s.totals_);
  return {{"sent", fates.sent},       {"answered", fates.answered},   {"unanswered", fates.unanswered},
          {"lost_up", fates.lost_up}, {"lost_down", fates.lost_down}, {"in_flight", fates.in_flight}};
}

nlohmann::ordered_json SummaryView::blackouts() const {
  const bool known = s.totals_ && s.totals_->longest_blackout.duration > Nanoseconds::zero();
  return {{"count", s.blackouts_},
          {"longest_s", time::to_seconds(s.blackout_longest_)},
          {"longest", known ? blackout_json(s.totals_->longest_blackout) : Json(nullptr)}};
}

void SummaryView::add_times(Json& json) const {
  json["force_age_ms"] = percentiles(s.age_ns_, 1e6, false, true);
  json["rtt_us"] = percentiles(s.round_trip_ns_, 1e3, false, true);
  json["compute_us"] = percentiles(s.compute_ns_, 1e3, false, false);
  json["stages_us"] = {{"network", percentiles(s.network_ns_, 1e3, false, true)},
                       {"server", percentiles(s.server_ns_, 1e3, false, true)},
                       {"wait", percentiles(s.wait_ns_, 1e3, false, true)}};
  json["tick_latency_us"] = percentiles(s.tick_latency_ns_, 1e3, false, true);
}

void SummaryView::add_contact(Json& json) const {
  json["contact_ticks"] = s.contact_ticks_;
  json["surface_unknown_ticks"] = s.unknown_ticks_;
  json["force_N"] = {{"mean", s.force_N_.mean()}, {"variance", s.force_N_.variance()}, {"max", s.force_N_max_}};
  if (s.shows_torque_) json["torque_N_m"] = {{"max", s.torque_N_m_max_}};
  json["penetration_m"] = {{"mean", s.penetration_m_.mean()}, {"max", s.penetration_m_max_}};
  json["displayed_stiffness_N_per_m"] = {{"mean", s.stiffness_.mean()}, {"median", stiffness_median()}};
  json["at_rest"] = {{"fraction", rest_fraction()},
                     {"force_N", rest_force_N()},
                     {"penetration_m", rest_depth_m()},
                     {"speed_m_per_s_max", DisplayedStiffness::kSpeed_m_per_s}};
  json["bounded_fraction"] = bounded_fraction();
  json["verdict"] = name_of(verdict());
  json["passivity"] = {{"minimum_J", minimum_J()}, {"final_J", final_J()}, {"ok", ok_json(verdict())}};
  json["passivity"]["guarantee"] = s.info_.guarantee.empty() ? Json(nullptr) : Json(s.info_.guarantee);
  json["ledger"] = {{"final_J", s.ledger_final_J_}};
}

void SummaryView::add_faults(Json& json) const {
  Json faults = Json::object();
  const RunTotals totals = s.totals_.value_or(RunTotals{});
  for (const Fault& fault : faults_of(totals)) faults[fault.name] = s.totals_ ? Json(fault.count) : Json(nullptr);
  faults["notes"] = totals.notes;
  json["faults"] = std::move(faults);
  json["complete"] = s.totals_.has_value();

  const RunInfo& info = s.info_;
  json["run"] = {{"program", info.program},
                 {"simulated", simulated()},
                 {"network", info.network},
                 {"law_parameters", info.law_parameters},
                 {"facts", info.facts},
                 {"hand", info.hand},
                 {"seed", info.seed},
                 {"period_s", time::to_seconds(info.period)},
                 {"hold_s", time::to_seconds(info.hold)},
                 {"drop_s", time::to_seconds(info.drop)},
                 {"settle_s", info.settle_s},
                 {"stiffness_depth_m_min", info.stiffness_depth_m_min},
                 {"device_simulated", info.device_simulated},
                 {"audited", info.audited},
                 {"surface", info.surface_true ? "true" : "plane"}};
}

std::string Summary::to_json() const {
  const SummaryView view{*this};
  Json json;
  view.add_run(json);
  view.add_network(json);
  view.add_times(json);
  view.add_contact(json);
  view.add_faults(json);
  // Text comes from command lines and peers: bytes that are not UTF-8 are replaced, so that no exception ends the run.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace forcebound::record
