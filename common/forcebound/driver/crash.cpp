#include "forcebound/driver/crash.hpp"

#include <semaphore.h>
#include <signal.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "forcebound/time/real_time.hpp"
#include "forcebound/time/signal_stack.hpp"

namespace forcebound::driver {
namespace {

constexpr std::array kSignals{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
constexpr int kExit = 0;  // in place of a signal
constexpr std::array<char, 16> kThreadName{"fb-driver"};
constexpr int kPriority = 90;  // above all that may call a driver
constexpr int kLook_ms = 1;
constexpr int kStopMost_ms = 1000;
constexpr int kOnItsWay_ms = 20;  // a force of zero, with a driver whose own thread sends it
constexpr std::int64_t kAsked_ns = 1'000'000'000;

struct Call {
  const char* driver;
  const char* name;
  const char* kind;
};
constinit thread_local Call current{nullptr, nullptr, "driver"};

/// One line, in a signal handler.
class Line {
 public:
  Line& operator<<(std::string_view text) noexcept {
    const std::size_t bytes = std::min(text.size(), text_.size() - bytes_);
    std::copy_n(text.begin(), bytes, text_.begin() + static_cast<std::ptrdiff_t>(bytes_));
    bytes_ += bytes;
    return *this;
  }
  [[nodiscard]] std::string_view text() const noexcept { return {text_.data(), bytes_}; }

 private:
  std::array<char, 512> text_{};
  std::size_t bytes_ = 0;
};

/// Of the process; a signal handler has no other way to it.
struct Crashes {
  pid_t process = 0;
  sem_t stop_asked{};
  std::atomic<pid_t> stopper{0};
  std::atomic<bool> crashed{false};
  std::atomic<bool> opened{false};  ///< there was something to be stopped
  std::atomic<bool> stopped{false};
  std::atomic<bool> stop_crashed{false};
  std::atomic<bool> told{false};  ///< words are there
  Line words;
  std::atomic<std::int64_t> asked_ns{0};
  std::atomic<pid_t> asked_by{0};
  std::array<char, 64> newest_driver{"?"};
};
Crashes crashes;

/// What is to be stopped, and what the main thread's handlers run on. Never destroyed: a driver may crash at the very
/// end.
struct Stops {
  std::mutex lock;
  std::vector<const StopAtCrash*> all;
  std::unique_ptr<time::SignalStack> stack;
};
Stops& stops() {
  static auto* const kOnly = new Stops;
  return *kOnly;
}

std::int64_t now_ns() noexcept {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

void wait_ms(int ms) noexcept {
  const timespec pause{.tv_sec = 0, .tv_nsec = ms * 1'000'000L};
  ::nanosleep(&pause, nullptr);
}

[[noreturn]] void wait_for_ever() noexcept {
  for (;;) ::pause();
}

bool is_thread_of_driver() noexcept {
  std::array<char, 16> name{};
  return ::prctl(PR_GET_NAME, name.data()) == 0 && name == kThreadName;
}

bool is_attended() noexcept {
  return crashes.asked_by != 0 && crashes.asked_by != ::gettid() && now_ns() - crashes.asked_ns < kAsked_ns;
}

std::string_view words_of_stop() noexcept {
  if (!crashes.opened) return {};
  if (crashes.stopped) return "; it was stopped";
  return crashes.stop_crashed ? "; its stop crashed too, so that a force may be left"
                              : "; its stop does not return, so that a force may be left";
}

void say(int signal, const Call& call, bool of_driver) noexcept {
  const char* const what = signal == kExit ? nullptr : ::sigdescr_np(signal);
  Line& line = crashes.words;
  if (of_driver) {
    line << call.kind << " '" << (call.driver != nullptr ? call.driver : crashes.newest_driver.data()) << "' ";
    line << (signal == kExit ? "ended the program by exit() in " : "crashed in ");
    line << (call.name != nullptr ? call.name : "a thread of its own");
  } else {
    line << "crashed, in no call or thread of driver '" << crashes.newest_driver.data() << "'";
  }
  if (what != nullptr) line << " (" << what << ")";
  line << words_of_stop();
  crashes.told = true;
}

void print() noexcept {
  Line line;
  line << "\n" << ::program_invocation_short_name << ": " << crashes.words.text() << "\n";
  const std::string_view text = line.text();
  (void)!::write(STDERR_FILENO, text.data(), text.size());
}

/// What may be called in a signal handler alone. Comes back if the crash is not a driver's.
void end_with(int signal, const Call& call, bool of_driver) noexcept {
  if (crashes.crashed.exchange(true)) {
    if (::gettid() == crashes.stopper) crashes.stop_crashed = true;
    wait_for_ever();
  }
  ::sem_post(&crashes.stop_asked);
  for (int ms = 0; ms < kStopMost_ms && !crashes.stopped && !crashes.stop_crashed; ms += kLook_ms) wait_ms(kLook_ms);
  if (crashes.stopped) wait_ms(kOnItsWay_ms);
  say(signal, call, of_driver);
  for (int s = 0; of_driver && s < kEnds_s && is_attended(); ++s) {
    for (int ms = 0; ms < 1000; ms += kLook_ms) wait_ms(kLook_ms);
  }
  print();
  if (of_driver) ::_exit(kCrashExit);
}

void on_signal(int signal) {
  const bool here = ::getpid() == crashes.process;
  const Call call = current;
  if (here) end_with(signal, call, call.name != nullptr || is_thread_of_driver());
  ::signal(signal, SIG_DFL);
  ::raise(signal);
}

void on_exit() {
  if (::getpid() != crashes.process) return;
  const Call call = current;
  if (call.name != nullptr || is_thread_of_driver()) end_with(kExit, call, true);
}

void stop_when_asked() {
  (void)time::ask_for_first_in_first_out(kPriority);
  crashes.stopper = ::gettid();
  while (::sem_wait(&crashes.stop_asked) != 0) continue;
  const std::lock_guard lock(stops().lock);
  crashes.opened = !stops().all.empty();
  for (const StopAtCrash* stop : stops().all) stop->stop();
  crashes.stopped = true;
}

}  // namespace

void catch_crashes() {
  static std::mutex lock;
  const std::lock_guard alone(lock);
  // A child process has its parent's memory, and not its threads.
  if (crashes.process == ::getpid()) return;
  crashes.process = ::getpid();
  crashes.stopper = 0;
  ::sem_init(&crashes.stop_asked, 0, 0);
  // The main thread's lasts as long as the process.
  if (::gettid() == crashes.process) stops().stack = std::make_unique<time::SignalStack>();
  std::thread(stop_when_asked).detach();
  while (crashes.stopper == 0) wait_ms(kLook_ms);
  struct sigaction action {};
  action.sa_handler = on_signal;
  action.sa_flags = SA_ONSTACK;
  for (const int signal : kSignals) ::sigaction(signal, &action, nullptr);
  std::atexit(on_exit);
}

bool has_crashed() noexcept { return crashes.crashed; }

std::string_view crash_in_words() noexcept {
  crashes.asked_by.store(::gettid(), std::memory_order_relaxed);
  crashes.asked_ns.store(now_ns(), std::memory_order_relaxed);
  return crashes.told ? crashes.words.text() : std::string_view{};
}

CallInProgress::CallInProgress(const char* driver, const char* call, const char* kind) noexcept
    : driver_before_(current.driver), call_before_(current.name), kind_before_(current.kind) {
  current = {.driver = driver, .name = call, .kind = kind};
}

CallInProgress::~CallInProgress() { current = {.driver = driver_before_, .name = call_before_, .kind = kind_before_}; }

ThreadsOfDriver::ThreadsOfDriver() noexcept {
  ::prctl(PR_GET_NAME, before_.data());
  ::prctl(PR_SET_NAME, kThreadName.data());
  if (current.driver == nullptr) return;
  const std::string_view name = current.driver;
  // Its end stays zero, for who reads it meanwhile.
  crashes.newest_driver = {};
  std::copy_n(name.begin(), std::min(name.size(), crashes.newest_driver.size() - 1), crashes.newest_driver.begin());
}

ThreadsOfDriver::~ThreadsOfDriver() { ::prctl(PR_SET_NAME, before_.data()); }

StopAtCrash::StopAtCrash(std::function<void()> stop) : stop_(std::move(stop)) {
  const std::lock_guard lock(stops().lock);
  stops().all.push_back(this);
}

StopAtCrash::~StopAtCrash() {
  const std::lock_guard lock(stops().lock);
  std::erase(stops().all, this);
}

}  // namespace forcebound::driver
