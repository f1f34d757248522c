#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "forcebound/record/mcap_writer.hpp"
#include "forcebound/record/recording_reader.hpp"
#include "forcebound/record/recording_writer.hpp"
#include "forcebound/record/summary.hpp"
#include "tests/unit/record/sample_run.hpp"

namespace forcebound::record {
namespace {

using record::test::TemporaryFile;
using record::test::vector_of;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// Summarises the run and counts records.
class Collector final : public RecordingSink {
 public:
  void on_start(const RunInfo& info) override { summary.emplace(info); }
  void on_end(const RunTotals& totals) override { summary->finish(totals); }
  void on_tick(const TickRecord& tick) noexcept override {
    ticks.push_back(tick);
    summary->on_tick(tick);
  }
  void on_force(const ForceRecord& force) noexcept override {
    forces.push_back(force);
    summary->on_force(force);
  }
  void on_motion(const MotionRecord& motion) override { motions.push_back(motion); }
  void on_sent(const SentForceRecord& force) override { sent.push_back(force); }

  std::optional<Summary> summary;
  std::vector<TickRecord> ticks;
  std::vector<ForceRecord> forces;
  std::vector<MotionRecord> motions;
  std::vector<SentForceRecord> sent;
};

void record_sample(const std::filesystem::path& file, std::uint64_t ticks) {
  RecordingWriter writer(file, test::sample_info());
  test::DirectSink sink(writer);
  test::play_sample_run(sink, ticks);
  writer.finish(test::sample_totals());
  ASSERT_EQ(writer.problem(), "");
  ASSERT_EQ(writer.unwritten(), 0U);
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void write_bytes(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
}

std::string refusal_of(const std::filesystem::path& file) {
  Collector collector;
  try {
    (void)read_recording(file, collector);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return {};
}

TEST(Recording, GivesTheLiveSummaryAgainByteForByte) {
  const TemporaryFile file("summary.mcap");
  Summary live(test::sample_info());
  test::play_sample_run(live, 3000);
  live.finish(test::sample_totals());
  record_sample(file.path(), 3000);

  Collector collector;
  EXPECT_TRUE(read_recording(file.path(), collector));
  EXPECT_EQ(collector.summary->to_json(), live.to_json());
  EXPECT_EQ(collector.summary->to_text(), live.to_text());
}

TEST(Recording, KeepsEveryFieldOfATickAndAForce) {
  const TemporaryFile file("fields.mcap");
  struct Keep final : TickSink {
    void on_tick(const TickRecord& tick) noexcept override { ticks.push_back(tick); }
    void on_force(const ForceRecord& force) noexcept override { forces.push_back(force); }
    std::vector<TickRecord> ticks;
    std::vector<ForceRecord> forces;
  } kept;
  test::play_sample_run(kept, 50);
  record_sample(file.path(), 50);
  Collector read;
  ASSERT_TRUE(read_recording(file.path(), read));
  ASSERT_EQ(read.ticks.size(), kept.ticks.size());
  ASSERT_EQ(read.forces.size(), kept.forces.size());
  for (std::size_t i = 0; i < kept.ticks.size(); ++i) {
    const TickRecord& a = kept.ticks[i];
    const TickRecord& b = read.ticks[i];
    EXPECT_EQ(std::tie(a.tick, a.time, a.interval, a.latency, a.state, a.policy, a.motion_sequence, a.force_sequence,
                       a.force_age, a.contact, a.penetration_m, a.displayed_N, a.energy_J, a.xi, a.audit_J,
                       a.audit_minimum_J),
              std::tie(b.tick, b.time, b.interval, b.latency, b.state, b.policy, b.motion_sequence, b.force_sequence,
                       b.force_age, b.contact, b.penetration_m, b.displayed_N, b.energy_J, b.xi, b.audit_J,
                       b.audit_minimum_J));
    EXPECT_EQ(a.position, b.position);
    EXPECT_EQ(a.joint, b.joint);
    EXPECT_EQ(a.request, b.request);
    EXPECT_EQ(a.applied, b.applied);
    EXPECT_EQ(std::tie(a.rendering, a.local_scene, a.local_scene_age, a.model_deviation_m, a.model_trust),
              std::tie(b.rendering, b.local_scene, b.local_scene_age, b.model_deviation_m, b.model_trust));
    EXPECT_EQ(a.handle, b.handle);
    EXPECT_EQ(a.remote, b.remote);
    EXPECT_EQ(a.request_torque_N_m, b.request_torque_N_m);
    EXPECT_EQ(a.applied_torque_N_m, b.applied_torque_N_m);
    EXPECT_EQ(a.local, b.local);
    EXPECT_EQ(a.model, b.model);
  }
  for (std::size_t i = 0; i < kept.forces.size(); ++i) {
    const wire::EnvironmentForce& a = kept.forces[i].force;
    const wire::EnvironmentForce& b = read.forces[i].force;
    EXPECT_EQ(kept.forces[i].receive_time, read.forces[i].receive_time);
    EXPECT_EQ(kept.forces[i].round_trip, read.forces[i].round_trip);
    EXPECT_EQ(std::tie(a.session, a.sequence, a.motion_sequence, a.motion_device_time, a.answer.penetration_m,
                       a.server_receive_time, a.server_send_time, a.compute_time, a.motions_received,
                       a.motions_duplicated, a.motions_reordered),
              std::tie(b.session, b.sequence, b.motion_sequence, b.motion_device_time, b.answer.penetration_m,
                       b.server_receive_time, b.server_send_time, b.compute_time, b.motions_received,
                       b.motions_duplicated, b.motions_reordered));
    EXPECT_EQ(a.answer.force, b.answer.force);
    EXPECT_EQ(a.position, b.position);
    EXPECT_EQ(a.answer.contact_normal, b.answer.contact_normal);
  }
}

TEST(Recording, OfAServerKeepsMotionAndForce) {
  const TemporaryFile file("server.mcap");
  RecordingWriter writer(file.path(), test::sample_info());
  writer.write(MotionRecord{
      Nanoseconds{123}, {7, 8, Nanoseconds{9}, vector_of({1.5, -2}), control::ServerLawNumbers::Constant(16, 0.5)}});
  SentForceRecord force;
  force.force.session = 7;
  force.force.answer.force = vector_of({0.25});
  force.force.server_send_time = Nanoseconds{456};
  force.force.server_law_numbers = control::ServerLawNumbers::Constant(2, -0.25);
  writer.write(force);
  writer.finish({});
  Collector read;
  ASSERT_TRUE(read_recording(file.path(), read));
  ASSERT_EQ(read.motions.size(), 1U);
  EXPECT_EQ(read.motions[0].receive_time, Nanoseconds{123});
  EXPECT_EQ(read.motions[0].motion.sequence, 8U);
  EXPECT_EQ(read.motions[0].motion.position, vector_of({1.5, -2}));
  EXPECT_EQ(read.motions[0].motion.server_law_numbers, control::ServerLawNumbers::Constant(16, 0.5));
  ASSERT_EQ(read.sent.size(), 1U);
  EXPECT_EQ(read.sent[0].force.session, 7U);
  EXPECT_EQ(read.sent[0].force.answer.force, vector_of({0.25}));
  EXPECT_EQ(read.sent[0].force.server_law_numbers, control::ServerLawNumbers::Constant(2, -0.25));
}

TEST(Recording, OfAKilledProcessLacksAtMostTheLastSecond) {
  const TemporaryFile file("killed.mcap");
  std::string left;
  {
    RecordingWriter writer(file.path(), test::sample_info());
    test::DirectSink sink(writer);
    test::play_sample_run(sink, 5500);
    left = bytes_of(file.path());  // what the operating system would have if the process were killed here
  }
  write_bytes(file.path(), left);
  Collector read;
  EXPECT_FALSE(read_recording(file.path(), read));
  EXPECT_GE(read.ticks.size(), 4499U);
}

TEST(Recording, CutAnywhereIsReadUpToThereOrRefusedWithItsName) {
  const TemporaryFile whole("whole.mcap");
  record_sample(whole.path(), 1200);
  const std::string bytes = bytes_of(whole.path());
  const TemporaryFile cut("cut.mcap");
  for (std::size_t length = 0; length < bytes.size(); length += 1 + length / 37) {
    SCOPED_TRACE(length);
    write_bytes(cut.path(), bytes.substr(0, length));
    Collector read;
    try {
      EXPECT_FALSE(read_recording(cut.path(), read));
      EXPECT_LE(read.ticks.size(), 1200U);
    } catch (const std::runtime_error& error) {
      EXPECT_LT(length, 1500U);  // only as long as the run's metadata is missing
      EXPECT_THAT(error.what(), HasSubstr(cut.path().string()));
    }
  }
}

TEST(Recording, WithAnyByteFlippedIsReadAndSaysSo) {
  const TemporaryFile whole("flip-whole.mcap");
  record_sample(whole.path(), 60);
  const std::string bytes = bytes_of(whole.path());
  const TemporaryFile flipped("flip.mcap");
  int damaged_files = 0;
  for (std::size_t at = 0; at < bytes.size(); at += 1 + at / 61) {
    SCOPED_TRACE(at);
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x55);
    write_bytes(flipped.path(), damaged);
    Collector read;
    const mcap::Ending ending = read_recording(flipped.path(), read);
    damaged_files += ending.damaged > 0 ? 1 : 0;
    // All is in one chunk: it is there or not.
    EXPECT_TRUE(read.ticks.size() == 60 || (read.ticks.empty() && !ending)) << read.ticks.size();
    ASSERT_TRUE(read.summary.has_value());
  }
  EXPECT_GT(damaged_files, 50);
}

TEST(Recording, LeavesOutADamagedChunkNamingTheByteAndShowsTheRest) {
  const TemporaryFile file("damaged.mcap");
  record_sample(file.path(), 5500);
  std::string bytes = bytes_of(file.path());
  const std::size_t at = bytes.find("zstd", bytes.find("zstd") + 4) + 1000;  // within the second chunk
  bytes[at] = static_cast<char>(bytes[at] ^ 1);
  write_bytes(file.path(), bytes);
  Collector read;
  const mcap::Ending ending = read_recording(file.path(), read);
  EXPECT_FALSE(ending);
  EXPECT_TRUE(ending.complete);
  EXPECT_GE(read.ticks.size(), 4490U);
  EXPECT_LT(read.ticks.size(), 5500U);
  EXPECT_EQ(read.ticks.back().tick, 5500U);
  EXPECT_THAT(incomplete_in_words(file.path(), ending),
              AllOf(HasSubstr("damaged.mcap: incomplete: 1 damaged record, with "), HasSubstr(" messages (at byte "),
                    HasSubstr("chunk is damaged: "), HasSubstr("; shown is what is whole")));
}

TEST(Recording, WithDamagedSettingsIsShownWithoutThem) {
  const TemporaryFile file("settings.mcap");
  record_sample(file.path(), 1200);
  const std::string bytes = bytes_of(file.path());
  const auto with = [&](std::string_view old, std::string_view other) {
    std::string damaged = bytes;
    damaged.replace(damaged.find(old), old.size(), other);
    write_bytes(file.path(), damaged);
    Collector read;
    const mcap::Ending ending = read_recording(file.path(), read);
    EXPECT_EQ(read.ticks.size(), 1200U);
    return mcap::in_words(ending);
  };
  std::string seed = std::to_string(test::sample_info().seed);
  const std::string right = std::exchange(seed, "x" + seed.substr(1));
  EXPECT_THAT(with(right, seed), HasSubstr("metadata 'forcebound.run': field 'seed' must be a number, got '" + seed));
  EXPECT_THAT(with("forcebound.run", "forceb0und.run"), HasSubstr("the checksum of all records is wrong"));
  EXPECT_THAT(with(std::string("\x07\0\0\0program", 11), std::string("\x07\0\1\0program", 11)),
              HasSubstr("a field of 65543 bytes does not fit"));
}

TEST(Recording, RefusesWhatIsNotOne) {
  const TemporaryFile file("text.mcap");
  write_bytes(file.path(), "time_s,x0_m\n");
  EXPECT_THAT(refusal_of(file.path()), AllOf(HasSubstr("byte 0"), HasSubstr("not an MCAP file")));
  EXPECT_THAT(refusal_of("/nowhere/at-all.mcap"), AllOf(HasSubstr("/nowhere/at-all.mcap"), HasSubstr("No such file")));
  EXPECT_THAT(refusal_of("/tmp"), HasSubstr("directory"));
}

TEST(Recording, OfVersion1IsRefused) {
  const TemporaryFile file("version-1.mcap");
  std::ofstream out(file.path(), std::ios::binary);
  mcap::Writer writer(out, "forcebound-client 0.1.0");
  KeyValues settings = to_key_values(test::sample_info());
  settings.erase("device_simulated");
  settings.erase("guarantee");
  writer.add_metadata("forcebound.run", settings);
  writer.close();
  out.close();
  EXPECT_EQ(refusal_of(file.path()), file.path().string() + ": a recording of protocol version 1, expected version 2");
}

TEST(Recording, OnAFullDiskCountsWhatIsMissingAndGoesOn) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  RecordingWriter writer("/dev/full", test::sample_info());
  test::DirectSink sink(writer);
  test::play_sample_run(sink, 2500);
  writer.flush();
  // Ticks and forces; pictures of them are not counted.
  EXPECT_EQ(writer.unwritten(), 2500U + 2491U - 399U);
  EXPECT_THAT(writer.problem(), AllOf(HasSubstr("/dev/full"), HasSubstr("No space left on device")));
  EXPECT_NO_THROW(writer.finish({}));
}

TEST(Recording, ThatCannotBeCreatedIsRefusedAtOnce) {
  try {
    RecordingWriter writer("/nowhere/run.mcap", {});
    FAIL() << "created a file in a directory that does not exist";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("/nowhere/run.mcap"), HasSubstr("No such file or directory")));
  }
}

TEST(Recording, RefusesABeginningBeyondAllTimes) {
  KeyValues values = to_key_values(test::sample_info());
  values["epoch_ns"] = "9223372036854775807";
  EXPECT_THAT(
      [&] { (void)run_info_from(values); },
      testing::ThrowsMessage<std::invalid_argument>("field 'epoch_ns' must be within 2^61, got 9223372036854775807"));
}

TEST(RunInfo, ComesBackFromItsKeyValues) {
  RunInfo info = test::sample_info();
  info.audited = false;
  info.settle_s = 0.1;
  info.rounding_N = 1.0 / 3;
  const KeyValues values = to_key_values(info);
  EXPECT_EQ(to_key_values(run_info_from(values)), values);
  EXPECT_EQ(run_info_from(values).rounding_N, 1.0 / 3);
  EXPECT_EQ(run_info_from(values).force_N_max, kNoLimit);
  const KeyValues totals = to_key_values(test::sample_totals());
  EXPECT_EQ(to_key_values(run_totals_from(totals)), totals);
}

TEST(RunTotals, KeepAServersClockThatIsNotKnownApartFromOneThatIsExact) {
  RunTotals totals = test::sample_totals();
  EXPECT_FALSE(run_totals_from(to_key_values(totals)).server_ahead_off.has_value());
  totals.server_ahead = Nanoseconds{-5};
  totals.server_ahead_off = Nanoseconds::zero();
  const RunTotals back = run_totals_from(to_key_values(totals));
  EXPECT_EQ(back.server_ahead, Nanoseconds{-5});
  EXPECT_EQ(back.server_ahead_off, Nanoseconds::zero());
}

TEST(RunInfo, RefusesAnInvalidNumber) {
  try {
    (void)run_info_from({{"seed", "12x"}});
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("'seed'"), HasSubstr("'12x'")));
  }
}

}  // namespace
}  // namespace forcebound::record
