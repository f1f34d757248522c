#include "forcebound/client/commands/check_device/checked_process.hpp"

#include <poll.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

#include "forcebound/child/in_child.hpp"
#include "forcebound/client/app/known_devices.hpp"
#include "forcebound/client/commands/check_device/call_watch.hpp"
#include "forcebound/client/commands/check_device/check_progress.hpp"
#include "forcebound/client/commands/check_device/device_checks.hpp"
#include "forcebound/client/commands/check_device/thread_cost.hpp"
#include "forcebound/client/commands/check_device/untouched.hpp"
#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/simulated_device.hpp"
#include "forcebound/text/lines.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/time/real_time.hpp"
#include "forcebound/time/steady_clock.hpp"

namespace forcebound::client::commands {
namespace {

constexpr std::chrono::seconds kAllWithin{120};
constexpr std::chrono::seconds kPersonWithin{240};  // besides
constexpr std::chrono::seconds kGrace{10};          // of the process that waits

/// Memory of two processes.
class SharedProgress {
 public:
  SharedProgress()
      : page_(::mmap(nullptr, sizeof(CheckProgress), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)) {
    if (page_ == MAP_FAILED) throw std::runtime_error("no memory to share with a child process");
    progress_ = new (page_) CheckProgress;
  }
  ~SharedProgress() { ::munmap(page_, sizeof(CheckProgress)); }
  SharedProgress(const SharedProgress&) = delete;
  SharedProgress& operator=(const SharedProgress&) = delete;
  [[nodiscard]] CheckProgress& operator*() const { return *progress_; }

 private:
  void* page_;
  CheckProgress* progress_ = nullptr;
};

std::atomic<bool>* cancelled_by_signal = nullptr;

void cancel_check(int /*signal*/) {
  if (cancelled_by_signal != nullptr) cancelled_by_signal->store(true);
}

/// While it lives, the signals that end a program cancel the checks.
class CancelledBySignals {
 public:
  explicit CancelledBySignals(std::atomic<bool>& cancelled) {
    cancelled_by_signal = &cancelled;
    for (std::size_t i = 0; i < kSignals.size(); ++i) before_[i] = std::signal(kSignals[i], cancel_check);
  }
  ~CancelledBySignals() {
    for (std::size_t i = 0; i < kSignals.size(); ++i) std::signal(kSignals[i], before_[i]);
    cancelled_by_signal = nullptr;
  }
  CancelledBySignals(const CancelledBySignals&) = delete;
  CancelledBySignals& operator=(const CancelledBySignals&) = delete;

 private:
  static constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};
  std::array<void (*)(int), kSignals.size()> before_{};
};

/// As the client ticks: with real-time scheduling from the first tick on, where the system grants it.
class RealPace final : public Pace {
 public:
  ~RealPace() override {
    const ::sched_param ordinary{};
    ::sched_setscheduler(0, SCHED_OTHER, &ordinary);
  }
  Nanoseconds now() override { return clock_.now(); }
  void wait_until(Nanoseconds time_point) override {
    if (!std::exchange(asked_, true)) (void)time::ask_for_first_in_first_out(kTickPriority);
    const ::timespec until{.tv_sec = static_cast<std::time_t>(time_point.count() / 1'000'000'000),
                           .tv_nsec = static_cast<long>(time_point.count() % 1'000'000'000)};
    while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) continue;
  }
  CallCost cost_of(const std::function<void()>& call) override { return thread_cost_of(call); }

 private:
  static constexpr int kTickPriority = 70;  // below the watch's

  time::SteadyClock clock_;
  bool asked_ = false;
};

/// At the terminal of this process.
class PersonAtTerminal final : public Person {
 public:
  ~PersonAtTerminal() override { std::fputc('\n', stderr); }

  void ask(const std::string& what, double left_s) override {
    const int left = static_cast<int>(left_s);
    if (what == asked_ && left == left_) return;
    if (what != asked_) forget_keys();
    std::fprintf(stderr, "%s%s %d s left \r", what == asked_ || asked_.empty() ? "" : "\n", what.c_str(), left);
    asked_ = what;
    left_ = left;
  }

  bool is_done() override { return forget_keys(); }

 private:
  /// @returns whether there were any
  static bool forget_keys() {
    bool any = false;
    std::array<char, 256> bytes{};
    ::pollfd keys{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
    while (::poll(&keys, 1, 0) > 0 && ::read(STDIN_FILENO, bytes.data(), bytes.size()) > 0) any = true;
    return any;
  }

  std::string asked_;
  int left_ = 0;
};

bool is_of_simulated_family(const std::string& device) {
  const auto shipped = device::shipped_device_names();
  // A setting may be a path: force-dimension:library=/opt/libdhd.so.
  return device::names_a_file(device.substr(0, device.find(':'))) ||
         std::ranges::find(shipped, device) != shipped.end();
}

std::unique_ptr<device::HapticDevice> untouched_device(const std::string& name) {
  if (!is_of_simulated_family(name)) return client::known_devices().make({.device = name});
  device::DeviceDescription description = device::load_device(name);
  auto nobody = std::make_unique<Nobody>(description.facts.translations());
  return std::make_unique<device::SimulatedDevice>(std::move(description), std::move(nobody));
}

DeviceCheck check_unknown_setting(const std::string& device) {
  DeviceCheck check{.name = "unknown setting", .measured = "refused", .accepted = "an error that names it"};
  if (is_of_simulated_family(device)) {
    check.verdict = Verdict::not_checked;
    check.measured = "a simulated device has none";
    return check;
  }
  constexpr const char* kSetting = "no_such_setting";
  try {
    (void)untouched_device(device + (device.find(':') == std::string::npos ? ':' : ',') + kSetting + "=1");
  } catch (const std::exception& error) {
    if (std::string(error.what()).find(kSetting) != std::string::npos) return check;
    check.verdict = Verdict::failed;
    check.measured = "refused: " + std::string(error.what());
    return check;
  }
  check.verdict = Verdict::failed;
  check.measured = std::string(kSetting) + "=1 is accepted";
  return check;
}

nlohmann::json json_of(const DeviceCheck& check) {
  const auto words = [](Verdict verdict) {
    if (verdict == Verdict::passed) return "passed";
    return verdict == Verdict::failed ? "failed" : "not checked";
  };
  return {{"check", check.name},
          {"verdict", words(check.verdict)},
          {"measured", check.measured},
          {"accepted", check.accepted}};
}

/// The part of the child process.
class ChecksInChild {
 public:
  ChecksInChild(const CheckDeviceRequest& request, CheckProgress& progress)
      : request_(request), progress_(progress), watch_(progress, all_within()) {}

  [[nodiscard]] std::chrono::seconds all_within() const {
    return kAllWithin + (request_.guided ? kPersonWithin : std::chrono::seconds{0});
  }

  void run() {
    if (check_once()) check_again();
    progress_.end = CheckEnd::finished;
  }

 private:
  void found(const DeviceCheck& check) { progress_.add_row(json_of(check).dump()); }
  void failed(const char* name, const std::string& why) { found({name, Verdict::failed, why, ""}); }

  template <class Call>
  auto watched(const char* check, const char* call_name, Call call) {
    const Watched in_progress(watch_, check, call_name);
    return call();
  }

  /// @returns whether all of it could be done
  bool check_once() {
    std::unique_ptr<device::HapticDevice> device;
    try {
      device = watched("open", "open", [this] { return untouched_device(request_.device); });
    } catch (const std::runtime_error& error) {
      failed("open", error.what());
      return false;
    }
    watch_.guard(device.get());
    const bool done = drive(*device);
    watched("open again", "close", [&] {
      watch_.guard(nullptr);
      device.reset();
    });
    return done;
  }

  bool drive(device::HapticDevice& device) {
    RealPace pace;
    std::unique_ptr<PersonAtTerminal> person;
    if (request_.guided) person = std::make_unique<PersonAtTerminal>();
    try {
      (void)check_device(device, pace,
                         {.force_share = request_.force_share,
                          .speed_m_per_s_max = request_.speed_m_per_s_max,
                          .person = person.get(),
                          .cancelled = [this] { return progress_.cancelled.load(); },
                          .calls = &watch_,
                          .found = [this](const DeviceCheck& check) { found(check); }});
      return true;
    } catch (const std::runtime_error& error) {
      watch_.end();
      failed(progress_.check.text(), error.what());
      return false;
    }
  }

  void check_again() {
    watched("unknown setting", "open", [this] { found(check_unknown_setting(request_.device)); });
    try {
      watched("open again", "open", [this] { (void)untouched_device(request_.device); });
      found({"open again", Verdict::passed, "opened after close", "opens"});
    } catch (const std::runtime_error& error) {
      failed("open again", error.what());
    }
    if (!request_.guided) {
      found({"unplugging", Verdict::not_checked, "needs a person who unplugs it: only with --guided", ""});
      found({"buttons", Verdict::not_checked, "needs a person who presses them: only with --guided", ""});
    }
  }

  /// A call that is told to the watch.
  class Watched {
   public:
    Watched(CallWatch& watch, const char* check, const char* call) : watch_(watch) { watch_.begin(check, call); }
    ~Watched() { watch_.end(); }
    Watched(const Watched&) = delete;
    Watched& operator=(const Watched&) = delete;

   private:
    CallWatch& watch_;
  };

  const CheckDeviceRequest& request_;
  CheckProgress& progress_;
  CallWatch watch_;
};

/// In the child process. @returns empty, or why the device is wrong use
std::string checked(const CheckDeviceRequest& request, CheckProgress& progress) {
  std::signal(SIGINT, SIG_IGN);  // the parent tells
  std::signal(SIGHUP, SIG_IGN);
  cancelled_by_signal = &progress.cancelled;
  std::signal(SIGTERM, cancel_check);
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);  // not SIGKILL, which would leave a force on
  try {
    ChecksInChild(request, progress).run();
  } catch (const std::invalid_argument& error) {
    progress.end = CheckEnd::finished;
    return error.what();
  }
  return {};
}

std::string seconds_in_words(std::chrono::seconds seconds) { return std::to_string(seconds.count()) + " s"; }

/// How the child ended, where it did not end by itself.
DeviceCheck end_of(const CheckProgress& progress, const std::string& otherwise) {
  const std::string call = progress.call.text();
  const std::string where = std::string(", in check '") + progress.check.text() + "'; ";
  const std::string stopped =
      progress.stopped ? "the device was stopped then" : "stop, called after that, did not return either";
  DeviceCheck check{.name = "calls", .verdict = Verdict::failed, .measured = {}, .accepted = "calls return"};
  switch (progress.end.load()) {
    case CheckEnd::crashed:
      check.measured = std::string("in check '") + progress.check.text() + "' " + progress.crash.text();
      return check;
    case CheckEnd::hung: {
      const auto most = call == "close"                     ? kClosesWithin
                        : call == "open" || call == "start" ? kStartsWithin
                                                            : kReturnsWithin;
      check.measured = call + " did not return within " + seconds_in_words(most) + where + stopped;
      return check;
    }
    case CheckEnd::overdue:
      check.measured = "all checks took too long; the last call was " + call + where + stopped;
      return check;
    case CheckEnd::none:
    case CheckEnd::finished:
      check.measured = call + " ended the process" + where + otherwise;
      return check;
  }
  return check;
}

nlohmann::json rows_of(const CheckProgress& progress) {
  nlohmann::json rows = nlohmann::json::array();
  const std::string_view text(progress.rows.data(), progress.row_bytes);
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    rows.push_back(nlohmann::json::parse(text.substr(at, end - at)));
    at = end + 1;
  }
  return rows;
}

}  // namespace

nlohmann::json check_in_process(const CheckDeviceRequest& request) {
  const SharedProgress shared;
  CheckProgress& progress = *shared;
  const CancelledBySignals cancelled(progress.cancelled);
  std::fprintf(stderr, "device '%s' is being checked and moves: let nobody touch it\n", request.device.c_str());
  const auto within = kAllWithin + (request.guided ? kPersonWithin : std::chrono::seconds{0}) + kGrace;
  std::string wrong_use;
  std::string otherwise;
  try {
    wrong_use = child::in_child([&] { return checked(request, progress); }, {.time = within, .opens_files = true});
  } catch (const std::exception& error) {
    otherwise = error.what();
  }
  if (!wrong_use.empty()) throw std::invalid_argument("--device: " + wrong_use);
  nlohmann::json rows = rows_of(progress);
  if (progress.end != CheckEnd::finished) rows.push_back(json_of(end_of(progress, otherwise)));
  return rows;
}

}  // namespace forcebound::client::commands
