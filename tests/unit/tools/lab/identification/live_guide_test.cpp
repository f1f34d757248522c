#include "forcebound/client/commands/identify/live_guide.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <memory>

#include "tests/tools/lab/identification/hidden_device.hpp"

namespace forcebound::lab::identification {
namespace {

using client::commands::identify::Guide;

/// A device that no simulation knows of, whose bus blocks until somebody stops it.
class BlockingDevice final : public device::HapticDevice {
 public:
  BlockingDevice(device::HapticDevice& device, std::atomic<bool>& stop) : device_(device), stop_(stop) {}
  [[nodiscard]] const control::DeviceFacts& facts() const noexcept override { return device_.facts(); }
  device::Reading read(time::Nanoseconds now) noexcept override {
    ++reads_;
    constexpr int kBlocksAt = 20;
    constexpr int kEnough = 40;
    if (reads_ == kBlocksAt) {
      stopped_.wait(false);
    }
    if (reads_ == kEnough) stop_ = true;
    return device_.read(now);
  }
  void apply(time::Nanoseconds now, const control::Vector& force_N) noexcept override { device_.apply(now, force_N); }
  void stop(time::Nanoseconds /*now*/) noexcept override {
    stopped_ = true;
    stopped_.notify_all();
  }
  [[nodiscard]] std::optional<time::Nanoseconds> released_at() const noexcept override { return std::nullopt; }
  [[nodiscard]] int reads() const noexcept { return reads_; }

 private:
  device::HapticDevice& device_;
  std::atomic<bool>& stop_;
  std::atomic<bool> stopped_{false};
  int reads_ = 0;
};

TEST(LiveGuide, HasAWatchdogThatStopsTheDeviceWhenItsTickDoesNotRun) {
  const HiddenDevice hidden = draw_hidden_device(1);
  const auto simulated = without_hand(hidden.description);
  std::atomic<bool> stop{false};
  BlockingDevice device(*simulated, stop);
  Guide guide(declared_facts(hidden), {});
  // Without the watchdog it blocks for ever.
  const std::uint64_t stops = run_live(guide, device, 1e-3, stop, [](double, const std::string&) {});
  EXPECT_GE(stops, 1U);
  EXPECT_GE(device.reads(), 40) << "it goes on afterwards";
}

}  // namespace
}  // namespace forcebound::lab::identification
