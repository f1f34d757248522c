#include "forcebound/client/commands/doctor/doctor_report.hpp"

#include <gmock/gmock.h>

#include <sstream>

#include "forcebound/text/terminal.hpp"
#include "tests/unit/client/commands/doctor/sound_findings.hpp"

namespace forcebound::client::commands {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string report_on(const DoctorFindings& found) { return doctor_text(found, doctor_verdict(found)); }

/// With single blanks in place of all space.
std::string in_one_line(const std::string& report) {
  std::istringstream words(report);
  std::string line;
  for (std::string word; words >> word;) line += (line.empty() ? "" : " ") + word;
  return line;
}

void expect_eighty_columns(const std::string& report) {
  std::istringstream lines(report);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(text::columns_of(line), text::kColumns) << line;
}

/// Everything at its worst.
DoctorFindings sick_findings() {
  DoctorFindings found = sound_findings();
  found.server = "a-host-with-a-rather-long-name.in-a-domain.example:47800";
  found.handshake.sessions = 3;
  found.handshake.server_parts = wire::ServerParts::held;
  found.network.up.lost = 3000;
  found.network.round_trip = {
      .count = 9, .p50_ms = 1234.567, .p90_ms = 2345.678, .p99_ms = 3456.789, .p999_ms = 4567.891, .max_ms = 5678.912};
  found.network.at_server.p99_ms = 20;
  found.network.longest_gap_ms = 4000;
  found.network.drift = ClockDrift{.ppm = 4321, .uncertain_ppm = 12};
  found.path.up_bytes = 0;
  found.machine.grant = {.text = "no SCHED_FIFO (Operation not permitted), memory not locked (Cannot allocate memory)"};
  found.machine.tick.late = 900;
  return found;
}

TEST(DoctorReport, FitsEightyColumnsWhateverWasFound) {
  expect_eighty_columns(report_on(sound_findings()));
  expect_eighty_columns(report_on(sick_findings()));
  expect_eighty_columns(report_on({}));
}

TEST(DoctorReport, SaysWhatWasFoundAndWhatToChange) {
  EXPECT_THAT(in_one_line(report_on(sound_findings())),
              AllOf(HasSubstr("0.31 ms, 1 Hello; scene 'sphere' with 3 degrees of freedom"),
                    HasSubstr("5000 sent, 0 lost (0 %)"), HasSubstr("packets of 1228 bytes arrive whole"),
                    HasSubstr("1230 ms behind"), HasSubstr("C6 133 us"), HasSubstr("0 of 5000 late"),
                    HasSubstr("100 % at the client"), HasSubstr("Nothing needs to change.")));
  EXPECT_THAT(in_one_line(report_on(sick_findings())),
              AllOf(HasSubstr("3000 lost (60 %)"), HasSubstr("What to change first"), HasSubstr(" 1. Let packets of"),
                    Not(HasSubstr("Nothing needs"))));
}

TEST(DoctorReport, HasEverythingInItsJsonAndNullForWhatIsNotKnown) {
  const DoctorFindings found = sound_findings();
  // As it would be read again.
  const auto json = nlohmann::json::parse(doctor_json(found, doctor_verdict(found)).dump());
  EXPECT_EQ(json["server"], "127.0.0.1:47800");
  EXPECT_EQ(json["handshake"]["scene"], "sphere");
  EXPECT_EQ(json["handshake"]["server_parts"], "none");
  EXPECT_EQ(json["handshake"]["piece_bytes"], 380);
  EXPECT_EQ(json["round_trip_ms"]["p999"], 0.9);
  EXPECT_EQ(json["up"]["sent"], 5000);
  EXPECT_EQ(json["down"]["loss"], 0.0);
  EXPECT_EQ(json["down"]["above_least_ms"]["count"], 5000);
  EXPECT_EQ(json["path"]["up_payload_bytes"], 1200);
  EXPECT_EQ(json["path"]["mtu_bytes"], 1500);
  EXPECT_EQ(json["clocks"]["server_ahead_ms"], -1234.5);
  EXPECT_EQ(json["clocks"]["drift_ppm"], 3.0);
  EXPECT_EQ(json["machine"]["sleep_states"][1]["exit_latency_us"], 133.0);
  EXPECT_EQ(json["machine"]["priority_limit"], 95);
  EXPECT_TRUE(json["machine"]["memory_limit_bytes"].is_null()) << "there is no limit";
  EXPECT_EQ(json["machine"]["idle_timer_us"]["max"], 1100.0);
  EXPECT_EQ(json["verdict"]["network"], "good");
  EXPECT_EQ(json["verdict"]["felt"].size(), 4U);
  EXPECT_TRUE(json["verdict"]["changes"].is_array());
  EXPECT_TRUE(json["verdict"]["changes"].empty());

  const DoctorFindings nothing;
  const auto empty = nlohmann::json::parse(doctor_json(nothing, doctor_verdict(nothing)).dump());
  EXPECT_TRUE(empty["round_trip_ms"].is_null());
  EXPECT_TRUE(empty["path"]["up_payload_bytes"].is_null());
  EXPECT_TRUE(empty["path"]["mtu_bytes"].is_null());
  EXPECT_TRUE(empty["clocks"]["server_ahead_ms"].is_null());
  EXPECT_TRUE(empty["clocks"]["drift_ppm"].is_null());
  EXPECT_TRUE(empty["machine"]["tick_us"].is_null());
}

TEST(DoctorReport, HasEachChangeInItsJsonInTheOrderOfUrgency) {
  const DoctorFindings found = sick_findings();
  const auto changes = doctor_json(found, doctor_verdict(found))["verdict"]["changes"];
  ASSERT_GT(changes.size(), 3U);
  EXPECT_EQ(changes[0]["where"], "network");
  for (std::size_t i = 1; i < changes.size(); ++i) {
    EXPECT_GE(changes[i - 1]["urgency"].get<double>(), changes[i]["urgency"].get<double>());
    EXPECT_FALSE(changes[i]["change"].get<std::string>().empty());
    EXPECT_FALSE(changes[i]["why"].get<std::string>().empty());
  }
}

}  // namespace
}  // namespace forcebound::client::commands
