#include "tests/process/loop_checks.hpp"

#include <gtest/gtest.h>

#include <sstream>
#include <vector>

#include "tests/process/passive.hpp"

namespace forcebound::test {
namespace {

using namespace std::chrono_literals;

/// The fates of the datagrams of one direction, in the order in which they came to the relay.
struct Fates {
  std::vector<bool> lost;

  [[nodiscard]] std::uint64_t all() const { return lost.size(); }
  [[nodiscard]] std::uint64_t lost_among(std::uint64_t first, std::uint64_t end) const {
    std::uint64_t count = 0;
    for (std::uint64_t i = first; i < end; ++i) count += lost.at(i) ? 1U : 0U;
    return count;
  }
};

Fates fates(const std::string& log, const std::string& direction) {
  Fates result;
  std::istringstream rows(log);
  for (std::string row; std::getline(rows, row);) {
    if (!row.starts_with(direction + ",")) continue;
    const bool lost = row.find(",lost,") != std::string::npos;
    EXPECT_TRUE(lost || row.find("forwarded,") != std::string::npos) << row;
    result.lost.push_back(lost);
  }
  return result;
}

void expect_numbers(const nlohmann::json& summary, std::initializer_list<const char*> pointers) {
  for (const char* pointer : pointers) {
    const nlohmann::json::json_pointer at(pointer);
    EXPECT_TRUE(summary.contains(at) && summary.at(at).is_number()) << pointer;
  }
}

}  // namespace

LoopOutcome run_loop(const LoopSettings& settings) {
  const TemporaryFolder folder;
  Server server({"--scene", settings.scene});
  Words relay_words{"--log", folder.file("log.csv")};
  relay_words.insert(relay_words.end(), settings.relay.begin(), settings.relay.end());
  Relay relay(server.address(), relay_words);
  Words client_words{"--duration", std::to_string(settings.duration.count())};
  client_words.insert(client_words.end(), settings.client.begin(), settings.client.end());
  Client client(relay.address(), client_words);
  EXPECT_EQ(client.wait(settings.duration + 20s), 0);
  Relay::let_everything_arrive();
  EXPECT_EQ(relay.stop(), 0);
  EXPECT_EQ(server.stop(), 0);
  return {client.summary(), server.out(), content(folder.file("log.csv"))};
}

void write_trace_after(const std::filesystem::path& trace, std::chrono::milliseconds skipped, const std::string& file) {
  std::istringstream rows(content(trace));
  std::string row;
  std::getline(rows, row);
  std::string kept = row + "\n";
  while (std::getline(rows, row)) {
    if (std::stod(row) >= static_cast<double>(skipped.count())) kept += row + "\n";
  }
  write_file(file, kept);
}

void expect_sound(const nlohmann::json& summary, std::chrono::seconds duration) {
  ASSERT_TRUE(summary.is_object());
  expect_numbers(summary, {"/duration_s", "/period_us/p50", "/force_age_ms/p50", "/force_age_ms/max", "/rtt_us/p50",
                           "/compute_us/p99", "/force_N/max", "/bounded_fraction", "/passivity/minimum_J",
                           "/passivity/final_J", "/ledger/final_J"});
  EXPECT_TRUE(summary["complete"]);
  // A busy machine may skip some, which is counted as late; more than these there can never be.
  EXPECT_GT(summary["ticks"].get<double>(), 0);
  EXPECT_LE(summary["ticks"].get<double>(), 1000.0 * static_cast<double>(duration.count()) + 1);
  EXPECT_GE(summary["passivity"]["minimum_J"].get<double>(), kPassive_J);
  EXPECT_EQ(summary["faults"]["tick_allocations"], 0);
  EXPECT_EQ(summary["faults"]["send_failures"], 0);
  EXPECT_EQ(summary["faults"]["recording_dropped"], 0);
}

void expect_exact_counts(const LoopOutcome& outcome) {
  const auto number = [&](const char* key) { return outcome.summary.at(key).get<std::uint64_t>(); };
  const auto server = [&](const char* subject, const char* what) {
    return counted(outcome.server_totals, subject, what);
  };
  // At the ends they agree on what passed ...
  EXPECT_EQ(number("sent") - number("lost_up"), server("motions", "received"));
  EXPECT_EQ(number("received") + number("lost_down"), server("forces", "sent"));

  // ... and between them the relay's log has, besides motion, the Hellos and Byes of which the server counted those
  // that arrived, and the answer to each of these.
  const Fates up = fates(outcome.relay_log, "up");
  const std::uint64_t hellos = server("sessions", "opened") + server("sessions", "hellos repeated");
  const std::uint64_t byes = server("sessions", "ended by the client") + server("sessions", "byes repeated");
  const std::uint64_t lost_up = up.lost_among(0, up.all());
  EXPECT_EQ(up.all() - lost_up, server("datagrams", "received"));
  EXPECT_EQ(up.all() - lost_up, server("motions", "received") + hellos + byes);
  const std::uint64_t handshakes_lost = up.all() - number("sent") - hellos - byes;
  EXPECT_EQ(number("lost_up"), lost_up - handshakes_lost);

  // Down, Welcomes are the first and Byes the last. A Welcome beyond the first may come after some forces, and then
  // its fate cannot be told from theirs.
  const Fates down = fates(outcome.relay_log, "down");
  EXPECT_EQ(down.all(), hellos + server("forces", "sent") + byes);
  const std::uint64_t forces_lost = down.lost_among(hellos, down.all() - byes);
  EXPECT_NEAR(static_cast<double>(number("lost_down")), static_cast<double>(forces_lost),
              static_cast<double>(hellos - 1));
  EXPECT_EQ(number("lost"), number("lost_up") + number("lost_down"));
  EXPECT_EQ(number("duplicated"), 0U);
}

}  // namespace forcebound::test
