#include "forcebound/record/recording_watch.hpp"

#include <gmock/gmock.h>

#include "tests/unit/record/sample_run.hpp"

namespace forcebound::record {
namespace {

TEST(RecordingWatch, TellsOfAFullDiskOnceAndBeforeTheEnd) {
  Recorder recorder;
  RecordingWriter writer("/dev/full", test::sample_info());
  RecordingWatch watch;
  test::play_sample_run(recorder, 3000);
  recorder.drain(writer);
  EXPECT_THAT(watch.take(recorder, writer),
              testing::AllOf(testing::HasSubstr("/dev/full"), testing::HasSubstr("No space left on device")));
  EXPECT_EQ(watch.take(recorder, writer), "");
}

TEST(RecordingWatch, TellsOfADiskThatIsTooSlow) {
  const test::TemporaryFile file("slow.mcap");
  Recorder recorder(100);
  RecordingWriter writer(file.path(), test::sample_info());
  RecordingWatch watch;
  EXPECT_EQ(watch.take(recorder, writer), "");
  test::play_sample_run(recorder, 1000);
  EXPECT_THAT(watch.take(recorder, writer), testing::HasSubstr("more slowly than they come"));
  EXPECT_EQ(watch.take(recorder, writer), "");
}

TEST(RecordingWatch, IsSilentOfARecordingThatIsWhole) {
  const test::TemporaryFile file("whole.mcap");
  Recorder recorder;
  RecordingWriter writer(file.path(), test::sample_info());
  RecordingWatch watch;
  test::play_sample_run(recorder, 1000);
  recorder.drain(writer);
  writer.flush();
  EXPECT_EQ(watch.take(recorder, writer), "");
}

}  // namespace
}  // namespace forcebound::record
