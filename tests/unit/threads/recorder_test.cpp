#include "forcebound/record/recorder.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "forcebound/record/recording_reader.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/unit/record/sample_run.hpp"

namespace forcebound::record {
namespace {

class TickCounter final : public RecordingSink {
 public:
  void on_start(const RunInfo&) override {}
  void on_end(const RunTotals&) override {}
  void on_tick(const TickRecord& tick) noexcept override {
    in_order = in_order && tick.tick == ticks + 1;
    ++ticks;
  }
  void on_force(const ForceRecord&) noexcept override { ++forces; }
  std::uint64_t ticks = 0;
  std::uint64_t forces = 0;
  bool in_order = true;
};

TEST(Recorder, HandsEveryRecordOverInOrderWhileAnotherThreadWrites) {
  const test::TemporaryFile file("recorder.mcap");
  Recorder recorder;
  RecordingWriter writer(file.path(), test::sample_info());
  std::atomic<bool> done = false;
  std::thread drain([&] {
    while (!done) {
      recorder.drain(writer);
      std::this_thread::yield();
    }
  });
  test::play_sample_run(recorder, 5000);
  done = true;
  drain.join();
  recorder.drain(writer);
  writer.finish({});
  TickCounter counter;
  ASSERT_TRUE(read_recording(file.path(), counter));
  EXPECT_EQ(counter.ticks + counter.forces + recorder.dropped(), 5000U + 4991U - 399U);
  EXPECT_EQ(recorder.dropped(), 0U);
  EXPECT_TRUE(counter.in_order);
}

TEST(Recorder, CountsWhatFindsItsQueueFull) {
  Recorder recorder(1000);
  test::play_sample_run(recorder, 20'000);
  const test::TemporaryFile file("full.mcap");
  RecordingWriter writer(file.path(), test::sample_info());
  EXPECT_EQ(recorder.drain(writer), 1000U);
  EXPECT_EQ(recorder.dropped(), 20'000U + 19'991U - 399U - 1000U);
  recorder.on_tick({});  // there is room again
  EXPECT_EQ(recorder.drain(writer), 1U);
}

TEST(Recorder, DoesNotAllocateEvenWhenFull) {
  if (!forcebound::time::kCountsHeapOperations) GTEST_SKIP() << "allocations are not counted under sanitizers";
  Recorder recorder(1000);
  const auto before = forcebound::time::heap_operations_of_this_thread();
  test::play_sample_run(recorder, 2000);
  EXPECT_EQ(forcebound::time::heap_operations_of_this_thread(), before);
  EXPECT_GT(recorder.dropped(), 0U);
}

}  // namespace
}  // namespace forcebound::record
