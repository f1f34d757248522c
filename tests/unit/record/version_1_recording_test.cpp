// Recordings as programs of version 1 of the protocol wrote them: messages and embedded schemas are made from the
// message descriptions of that version. Only the container, MCAP, which has not changed, is written by today's code.

#include <gmock/gmock.h>
#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/dynamic_message.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "forcebound/record/mcap_writer.hpp"
#include "forcebound/record/recording_reader.hpp"
#include "forcebound/record/summary.hpp"
#include "forcebound/text/file.hpp"
#include "tests/unit/record/sample_run.hpp"

namespace forcebound::record {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// The message descriptions of version 1.
class SchemaOfVersion1 {
 public:
  SchemaOfVersion1() : embedded_(text::read_file(FORCEBOUND_SCHEMA_OF_VERSION_1)) {
    google::protobuf::FileDescriptorSet files;
    EXPECT_TRUE(files.ParseFromString(embedded_));
    for (const auto& file : files.file()) EXPECT_NE(pool_.BuildFile(file), nullptr) << file.name();
  }

  /// As a recording embeds them: a serialized FileDescriptorSet.
  [[nodiscard]] const std::string& embedded() const { return embedded_; }

  /// A message of fields in Protocol Buffers' text format, by their names then.
  [[nodiscard]] std::string bytes(const std::string& message, const std::string& fields) {
    const auto* type = pool_.FindMessageTypeByName(message);
    const std::unique_ptr<google::protobuf::Message> made(messages_.GetPrototype(type)->New());
    EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(fields, made.get())) << fields;
    return made->SerializeAsString();
  }

 private:
  std::string embedded_;
  google::protobuf::DescriptorPool pool_;
  google::protobuf::DynamicMessageFactory messages_;
};

/// Writes the container as programs of version 1 did.
class RecordingOfVersion1 {
 public:
  explicit RecordingOfVersion1(const std::filesystem::path& file)
      : out_(file, std::ios::binary), mcap_(out_, "forcebound-client 0.1.0") {
    mcap_.add_metadata("forcebound.run", {{"program", "forcebound-client 0.1.0"},
                                          {"law", "fba-more"},
                                          {"law_parameters", ""},
                                          {"device", "wall-1dof"},
                                          {"facts", "wall-1dof: 1 degree of freedom"},
                                          {"operator", "press"},
                                          {"hand", "press: 0.08 kg, 150 N/m, 0.3 N s/m"},
                                          {"scene", "wall"},
                                          {"simulated", ""},
                                          {"network", ""},
                                          {"seed", "1"},
                                          {"period_ns", "1000000"},
                                          {"hold_ns", "250000000"},
                                          {"drop_ns", "1000000000"},
                                          {"epoch_ns", "1700000000000000000"},
                                          {"audited", "true"},
                                          {"settle_s", "0"},
                                          {"stiffness_depth_m_min", "1e-05"},
                                          {"force_N_max", "30"},
                                          {"rounding_N", "0"}});
  }

  void write(const std::string& topic, const std::string& message, const std::string& fields) {
    const auto known = channels_.find(message);
    const auto channel =
        known != channels_.end()
            ? known->second
            : channels_.emplace(message, mcap_.add_channel(topic, message, "protobuf", schema_.embedded(), "protobuf"))
                  .first->second;
    mcap_.write(channel, 1, 1'700'000'000'000'000'123, schema_.bytes(message, fields));
  }

  void finish(const KeyValues& totals) {
    mcap_.add_metadata("forcebound.totals", totals);
    mcap_.close();
  }

 private:
  SchemaOfVersion1 schema_;
  std::ofstream out_;
  mcap::Writer mcap_;
  std::map<std::string, std::uint16_t> channels_;
};

class Opened final : public RecordingSink {
 public:
  void on_start(const RunInfo& info) override { summary.emplace(info); }
  void on_end(const RunTotals& ended) override {
    totals = ended;
    summary->finish(ended);
  }
  void on_tick(const TickRecord& tick) noexcept override {
    contacts.push_back(tick.contact);
    last = tick;
    summary->on_tick(tick);
  }
  void on_force(const ForceRecord& force) noexcept override {
    forces.push_back(force.force);
    summary->on_force(force);
  }
  void on_motion(const MotionRecord& motion) override { motions.push_back(motion); }
  void on_sent(const SentForceRecord& force) override { forces.push_back(force.force); }

  std::optional<Summary> summary;
  RunTotals totals;
  TickRecord last;
  std::vector<bool> contacts;
  std::vector<wire::EnvironmentForce> forces;
  std::vector<MotionRecord> motions;
};

std::string tick_of_version_1(int number, const std::string& penetration_m) {
  return "tick: " + std::to_string(number) + " time_ns: " + std::to_string(number) +
         "000000 interval_ns: 1000000 latency_ns: 15000 state: ACTIVE policy: FRESH motion_sequence: 7 "
         "force_sequence: 6 force_age_ns: 5000000 position_m: 0.001 joint: 0.001 request_N: -5 applied_N: -4 "
         "penetration_m: " +
         penetration_m + " displayed_N: 4 energy_J: 0.25 xi: 0.5 audit_J: 0.002 audit_minimum_J: 0";
}

const KeyValues kTotalsOfVersion1{{"sent", "1000"},
                                  {"received", "900"},
                                  {"lost_up", "60"},
                                  {"lost_down", "30"},
                                  {"duplicated", "3"},
                                  {"reordered", "2"},
                                  {"malformed_corrupt", "5"},
                                  {"nobody_listening", "4"},
                                  {"longest_silence_ns", "300000000"},
                                  {"longest_silence_over", "true"},
                                  {"longest_silence_counted", "true"},
                                  {"longest_silence_server_left", "false"},
                                  {"longest_silence_motions", "300"},
                                  {"longest_silence_lost_up", "299"},
                                  {"longest_silence_answers", "1"},
                                  {"longest_silence_lost_down", "0"},
                                  {"note_000000", "nothing came back for 0.3 s"},
                                  {"scene", "wall"}};

TEST(RecordingOfVersion1, OfAClientOpensWithItsTicksForcesAndTotals) {
  const test::TemporaryFile file("client-1.mcap");
  RecordingOfVersion1 recording(file.path());
  recording.write("/force", "forcebound.v1.ForceRecord",
                  "receive_time_ns: 900000 round_trip_ns: 400000 force { session: 9 sequence: 1 motion_sequence: 6 "
                  "motion_device_time_ns: 500000 force_N: -5 position_m: 0.001 contact_normal: -1 penetration_m: 0.001 "
                  "server_receive_time_ns: 10 server_send_time_ns: 20 compute_time_ns: 5 motions_received: 6 "
                  "texture_N: 0.5 texture_wave_rad_per_m: 3000 port: [1, 2] }");
  recording.write("/tick", "forcebound.v1.TickRecord", tick_of_version_1(1, "0"));
  recording.write("/tick", "forcebound.v1.TickRecord", tick_of_version_1(2, "0.001"));
  recording.finish(kTotalsOfVersion1);

  Opened run;
  ASSERT_TRUE(read_recording(file.path(), run));
  EXPECT_THAT(run.contacts, ElementsAre(false, true)) << "version 1 had no field for it";
  EXPECT_EQ(run.last.tick, 2U);
  EXPECT_EQ(run.last.time, Nanoseconds{2'000'000});
  EXPECT_EQ(run.last.state, SessionState::active);
  EXPECT_EQ(run.last.policy, ForcePolicy::fresh);
  EXPECT_EQ(run.last.force_age, Nanoseconds{5'000'000});
  EXPECT_EQ(run.last.request, test::vector_of({-5}));
  EXPECT_EQ(run.last.applied, test::vector_of({-4}));
  EXPECT_EQ(run.last.displayed_N, 4);
  EXPECT_EQ(run.last.energy_J, 0.25);
  EXPECT_EQ(run.last.xi, 0.5);
  EXPECT_EQ(run.last.audit_J, 0.002);
  ASSERT_EQ(run.forces.size(), 1U);
  EXPECT_EQ(run.forces[0].force, test::vector_of({-5}));
  EXPECT_EQ(run.forces[0].texture_N, 0.5);
  EXPECT_EQ(run.forces[0].server_law_numbers, test::vector_of({1, 2})) << "the field was `port`";
}

TEST(RecordingOfVersion1, GivesASummaryWithWhatItsMetadataCalledOtherwise) {
  const test::TemporaryFile file("summary-1.mcap");
  RecordingOfVersion1 recording(file.path());
  for (int i = 1; i <= 10; ++i) recording.write("/tick", "forcebound.v1.TickRecord", tick_of_version_1(i, "0.001"));
  recording.finish(kTotalsOfVersion1);

  Opened run;
  ASSERT_TRUE(read_recording(file.path(), run));
  const auto summary = nlohmann::json::parse(run.summary->to_json());
  EXPECT_EQ(summary["ticks"], 10);
  EXPECT_EQ(summary["contact_ticks"], 10);
  EXPECT_EQ(summary["verdict"], "passive");
  EXPECT_EQ(summary["motions"]["unanswered"], 10) << "not counted then: what is left of those sent";
  EXPECT_EQ(summary["faults"]["port_unreachable"], 4) << "nobody_listening";
  EXPECT_EQ(summary["faults"]["malformed_corrupt"], 5);
  EXPECT_EQ(summary["blackouts"]["longest"]["died"], "up") << "longest_silence_...";
  EXPECT_EQ(summary["blackouts"]["longest"]["motions"], 300);
  EXPECT_EQ(run.totals.longest_blackout.duration, std::chrono::milliseconds{300});
  EXPECT_TRUE(run.totals.longest_blackout.over);
  EXPECT_EQ(summary["run"]["device_simulated"], true) << "it has an audit";
  EXPECT_THAT(run.summary->to_text(), HasSubstr("datagrams refused by the server's machine"));
}

TEST(RecordingOfVersion1, OfAServerOpensWithTheNumbersOfTheServerSideLaw) {
  const test::TemporaryFile file("server-1.mcap");
  RecordingOfVersion1 recording(file.path());
  recording.write("/motion", "forcebound.v1.MotionSample",
                  "session: 9 sequence: 8 device_time_ns: 7 position_m: [0.5, -2] port: [0.25, 0.5, 1]");
  recording.write("/force", "forcebound.v1.EnvironmentForce", "session: 9 sequence: 1 motion_sequence: 8 port: -3");
  recording.finish({});

  Opened run;
  ASSERT_TRUE(read_recording(file.path(), run));
  ASSERT_EQ(run.motions.size(), 1U);
  EXPECT_EQ(run.motions[0].receive_time, Nanoseconds{123});
  EXPECT_EQ(run.motions[0].motion.position, test::vector_of({0.5, -2}));
  EXPECT_EQ(run.motions[0].motion.server_law_numbers, test::vector_of({0.25, 0.5, 1}));
  ASSERT_EQ(run.forces.size(), 1U);
  EXPECT_EQ(run.forces[0].server_law_numbers, test::vector_of({-3}));
}

TEST(RunTotals, TakeThePresentNameWhereARecordingHasTheEarlierOneToo) {
  EXPECT_EQ(run_totals_from({{"nobody_listening", "4"}, {"port_unreachable", "6"}}).port_unreachable, 6U);
  EXPECT_EQ(run_totals_from({{"overtaken", "4"}, {"sent", "100"}}).unanswered, 4U);
}

}  // namespace
}  // namespace forcebound::record
