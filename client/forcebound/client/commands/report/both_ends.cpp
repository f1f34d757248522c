#include "forcebound/client/commands/report/both_ends.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <vector>

#include "forcebound/text/numbers.hpp"
#include "forcebound/text/terminal.hpp"
#include "forcebound/time/percentile.hpp"

namespace forcebound::client::commands {
namespace {

constexpr double kNs_in_us = 1e-3;

nlohmann::ordered_json spread(std::vector<double> us) {
  if (us.empty()) return nullptr;
  return {{"p50", time::percentile_of(us, 0.5)},
          {"p99", time::percentile_of(us, 0.99)},
          {"max", *std::max_element(us.begin(), us.end())}};
}

/// "0.41 ms median, 0.9 p99, 1.2 max"
std::string spread_words(const nlohmann::ordered_json& us) {
  if (us.is_null()) return "not known";
  const auto ms = [&us](const char* key) { return text::rounded(1e-3 * us[key].get<double>(), 4); };
  return ms("p50") + " ms median, " + ms("p99") + " p99, " + ms("max") + " max";
}

std::string row(const std::string& name, const std::string& words) {
  constexpr std::size_t kValuesColumn = 16;
  std::string line = "  " + name;
  line.resize(std::max(line.size() + 1, kValuesColumn), ' ');
  return text::wrapped(line + words, kValuesColumn) + '\n';
}

bool same(const control::Vector& a, const control::Vector& b) { return a.size() == b.size() && a == b; }

}  // namespace

void BothEnds::add_client(const record::RunTotals& totals) {
  server_ahead_ = totals.server_ahead;
  server_ahead_off_ = totals.server_ahead_off;
}

void BothEnds::add(const record::TickRecord& tick) {
  if (tick.motion_sequence != 0) motions_read_.emplace(tick.motion_sequence, tick.time);
}

void BothEnds::add(const record::ForceRecord& force) {
  const wire::EnvironmentForce& told = force.force;
  received_.emplace(Key{told.session, told.sequence},
                    Received{force.receive_time, force.round_trip, told.motion_sequence, told.answer.force});
}

void BothEnds::add(const record::MotionRecord& motion) {
  motions_arrived_.emplace(Key{motion.motion.session, motion.motion.sequence}, motion.receive_time);
}

void BothEnds::add(const record::SentForceRecord& force) {
  const wire::EnvironmentForce& told = force.force;
  sent_.emplace(Key{told.session, told.sequence}, Sent{told.server_receive_time, told.server_send_time,
                                                       told.compute_time, told.motion_sequence, told.answer.force});
}

/// With the number of forces that the client has of each.
std::map<std::uint64_t, std::uint64_t> BothEnds::sessions_in_both() const {
  std::set<std::uint64_t> at_server;
  for (const auto& [key, at] : motions_arrived_) at_server.insert(key.first);
  for (const auto& [key, sent] : sent_) at_server.insert(key.first);
  std::map<std::uint64_t, std::uint64_t> both;
  for (const auto& [key, received] : received_) {
    if (at_server.contains(key.first)) ++both[key.first];
  }
  return both;
}

nlohmann::ordered_json BothEnds::results() const {
  const auto sessions = sessions_in_both();
  if (sessions.empty()) {
    throw std::runtime_error(
        "the two recordings have no session in common: a client's and that of its server are needed");
  }
  std::uint64_t answered = 0;
  for (const auto& [key, at] : motions_arrived_) {
    answered += sessions.contains(key.first) && motions_read_.contains(key.second) ? 1U : 0U;
  }
  std::uint64_t sent_count = 0;
  std::uint64_t received_count = 0;
  std::uint64_t differ = 0;
  std::set<std::uint64_t> came_back;
  std::vector<double> up, server, compute, down, round_trip;
  for (const auto& [session, forces] : sessions) received_count += forces;
  const Nanoseconds epochs = server_epoch_ - client_epoch_;
  for (const auto& [key, sent] : sent_) {
    if (!sessions.contains(key.first)) continue;
    ++sent_count;
    const auto received = received_.find(key);
    if (received == received_.end()) continue;
    came_back.insert(sent.motion);
    differ += same(sent.force_N, received->second.force_N) ? 0U : 1U;
    const auto us = [](Nanoseconds time) { return kNs_in_us * static_cast<double>(time.count()); };
    compute.push_back(us(sent.compute));
    server.push_back(us(sent.at - sent.motion_arrived));
    down.push_back(us(received->second.at - sent.at) - us(epochs));
    round_trip.push_back(us(received->second.round_trip));
    if (const auto read = motions_read_.find(sent.motion); read != motions_read_.end()) {
      up.push_back(us(sent.motion_arrived - read->second) + us(epochs));
    }
  }
  nlohmann::ordered_json results{
      {"sessions", sessions.size()},
      {"motions", {{"sent", motions_read_.size()}, {"answered", answered}, {"came_back", came_back.size()}}},
      {"forces", {{"sent", sent_count}, {"received", received_count}, {"differ", differ}}},
      {"up_us", spread(std::move(up))},
      {"server_us", spread(std::move(server))},
      {"compute_us", spread(std::move(compute))},
      {"down_us", spread(std::move(down))},
      {"round_trip_us", spread(std::move(round_trip))},
      {"clocks_apart_us", nullptr},
      {"clocks_apart_off_us", nullptr}};
  if (server_ahead_ && server_ahead_off_) {
    results["clocks_apart_us"] = kNs_in_us * static_cast<double>((*server_ahead_ + epochs).count());
    results["clocks_apart_off_us"] = kNs_in_us * static_cast<double>(server_ahead_off_->count());
  }
  return results;
}

std::string BothEnds::to_text() const {
  const nlohmann::ordered_json r = results();
  const auto count = [](const nlohmann::ordered_json& number) { return std::to_string(number.get<std::uint64_t>()); };
  std::string out =
      "Both ends: " + text::counted(r["sessions"].get<std::uint64_t>(), "session") + " in both recordings\n";
  out += row("motions", count(r["motions"]["sent"]) + " sent, " + count(r["motions"]["answered"]) +
                            " answered by the server, " + count(r["motions"]["came_back"]) + " of these came back");
  out += row("forces", count(r["forces"]["sent"]) + " sent, " + count(r["forces"]["received"]) + " received, " +
                           count(r["forces"]["differ"]) + " not as they were sent");
  out += row("up", spread_words(r["up_us"]));
  out += row("server", spread_words(r["server_us"]) + "; of these computing " + spread_words(r["compute_us"]));
  out += row("down", spread_words(r["down_us"]));
  out += row("round trip", spread_words(r["round_trip_us"]));
  const auto& apart = r["clocks_apart_us"];
  out += row("clocks", apart.is_null()
                           ? "up and down by the wall clocks of both machines; how far these are apart is not known"
                           : "up and down by the wall clocks of both machines, which the client found " +
                                 text::rounded(1e-3 * apart.get<double>(), 4) + " ms apart, off by at most " +
                                 text::rounded(1e-3 * r["clocks_apart_off_us"].get<double>(), 4));
  return out;
}

}  // namespace forcebound::client::commands
