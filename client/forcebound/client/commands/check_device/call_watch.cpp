#include "forcebound/client/commands/check_device/call_watch.hpp"

#include <unistd.h>

#include <algorithm>
#include <limits>
#include <string_view>

#include "forcebound/driver/crash.hpp"
#include "forcebound/time/real_time.hpp"
#include "forcebound/time/steady_clock.hpp"

namespace forcebound::client::commands {
namespace {

constexpr std::chrono::milliseconds kLook{1};
constexpr std::chrono::milliseconds kStopPatience{2000};
constexpr std::chrono::milliseconds kOnItsWay{20};  // a force of zero, with a driver whose own thread sends it
constexpr int kPriority = 80;

std::int64_t now_ns() { return time::SteadyClock{}.now().count(); }

bool may_move_by_itself(std::string_view call) { return call == "open" || call == "start"; }

std::int64_t longest_ns(std::string_view call) {
  const auto most = [&]() -> std::chrono::nanoseconds {
    if (may_move_by_itself(call)) return kStartsWithin;
    return call == "close" ? kClosesWithin : kReturnsWithin;
  };
  return most().count();
}

}  // namespace

CallWatch::CallWatch(CheckProgress& progress, std::chrono::seconds all_within)
    : progress_(progress),
      all_until_ns_(now_ns() + std::chrono::nanoseconds(all_within).count()),
      stopper_([this](const std::stop_token& ending) { stop_when_asked(ending); }),
      watcher_([this](const std::stop_token& ending) { watch(ending); }) {}

CallWatch::~CallWatch() {
  watcher_.request_stop();
  watcher_.join();
  stopper_.request_stop();
  asked_.release();
}

void CallWatch::guard(device::HapticDevice* device) noexcept {
  if (device != nullptr && device->is_simulated()) device = nullptr;
  if (device != nullptr && device->facts().releases) {
    hold_ns_ = std::min(time::from_seconds(device->facts().hold_s_max), Nanoseconds(kStopMost)).count();
  }
  device_ = device;
}

void CallWatch::begin(const std::string& check, const char* call) {
  while (driver::has_crashed()) ::pause();
  progress_.check.set(check);
  progress_.call.set(call);
  within_ns_ = longest_ns(call);
  stop_after_ns_ = may_move_by_itself(call) ? std::numeric_limits<std::int64_t>::max() : hold_ns_;
  progress_.called_ns = now_ns();
}

void CallWatch::watch(const std::stop_token& ending) {
  (void)time::ask_for_first_in_first_out(kPriority);
  std::int64_t stopped_in = 0;
  while (!ending.stop_requested()) {
    std::this_thread::sleep_for(kLook);
    if (const std::string_view crash = driver::crash_in_words(); !crash.empty()) end_with(crash);
    const std::int64_t now = now_ns();
    // First, lest a call that is over is measured by the limits of the next.
    const std::int64_t within = within_ns_;
    const std::int64_t stop_after = stop_after_ns_;
    const std::int64_t called = progress_.called_ns;
    CheckEnd end = CheckEnd::none;
    if (called != 0 && now - called > within) end = CheckEnd::hung;
    if (now > all_until_ns_) end = CheckEnd::overdue;
    CheckEnd none = CheckEnd::none;
    if (end != CheckEnd::none && progress_.end.compare_exchange_strong(none, end)) end_process();
    if (called == 0 || called == stopped_in || now - called <= stop_after) continue;
    stopped_in = called;
    asked_.release();
  }
}

void CallWatch::stop_when_asked(const std::stop_token& ending) {
  (void)time::ask_for_first_in_first_out(kPriority);
  while (true) {
    asked_.acquire();
    if (ending.stop_requested()) return;
    if (device::HapticDevice* const device = device_; device != nullptr) device->stop(Nanoseconds(now_ns()));
    ++stops_;
  }
}

void CallWatch::end_with(std::string_view crash) {
  progress_.crash.set(crash);
  CheckEnd none = CheckEnd::none;
  progress_.end.compare_exchange_strong(none, CheckEnd::crashed);
  ::_exit(1);
}

void CallWatch::end_process() {
  const std::uint64_t stops = stops_;
  asked_.release();
  const std::int64_t until = now_ns() + Nanoseconds(kStopPatience).count();
  while (stops_ == stops && now_ns() < until) std::this_thread::sleep_for(kLook);
  progress_.stopped = stops_ != stops;
  if (progress_.stopped) std::this_thread::sleep_for(kOnItsWay);
  ::_exit(1);
}

}  // namespace forcebound::client::commands
