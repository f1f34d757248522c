#pragma once

#include <array>
#include <functional>
#include <string_view>

namespace forcebound::driver {

/// A driver's crash ends with zero force, and says which driver it was and in which call.
///
/// A crash is SIGSEGV, SIGBUS, SIGFPE, SIGILL or SIGABRT (an uncaught exception among them), or exit(), in a call of a
/// driver or in a thread that one began in `open` or `start`. The thread that it came in never goes on. On another one
/// all that is to be stopped is stopped (StopAtCrash); no other call reaches a driver from then on. Then
/// `crash_in_words` says what happened, to whom asks: who did within the last second, on another thread than that
/// crash's, has kEnds_s to end the program in its own way. Else, or after that, the line goes to stderr, and the
/// program ends with kCrashExit.
///
/// Likewise all is stopped where what crashes is none of a driver's: the program then ends by that signal.
///
/// What this cannot see: a driver that ends the process by _exit or SIGKILL, too deep a recursion in a thread of its
/// own, which has no spare stack, and a thread of it that gives itself another name than the one it was born with.

/// The program's exit code.
inline constexpr int kCrashExit = 6;
inline constexpr int kEnds_s = 10;

/// From now on, for this process and not for its children. On the main thread, before the first call of a driver that
/// may crash; again: nothing.
void catch_crashes();

/// Whether there was one. Any thread.
[[nodiscard]] bool has_crashed() noexcept;

/// "driver 'pen' crashed in read (Segmentation fault); it was stopped"; empty: there was none, or stopping it still
/// takes. Any thread.
[[nodiscard]] std::string_view crash_in_words() noexcept;

/// A call of a driver, or another plug-in, on this thread, while it lives. Real time.
class CallInProgress {
 public:
  /// The texts must last. @param driver its name @param kind of plug-in
  CallInProgress(const char* driver, const char* call, const char* kind = "driver") noexcept;
  ~CallInProgress();
  CallInProgress(const CallInProgress&) = delete;
  CallInProgress& operator=(const CallInProgress&) = delete;

 private:
  const char* driver_before_;
  const char* call_before_;
  const char* kind_before_;
};

/// While it lives, threads that this thread begins are known as a driver's, also to who looks at the system's list.
class ThreadsOfDriver {
 public:
  ThreadsOfDriver() noexcept;
  ~ThreadsOfDriver();
  ThreadsOfDriver(const ThreadsOfDriver&) = delete;
  ThreadsOfDriver& operator=(const ThreadsOfDriver&) = delete;

 private:
  std::array<char, 16> before_{};
};

/// What is done at a crash, while it lives: on another thread than the crash's, at most once.
class StopAtCrash {
 public:
  explicit StopAtCrash(std::function<void()> stop);
  ~StopAtCrash();
  StopAtCrash(const StopAtCrash&) = delete;
  StopAtCrash& operator=(const StopAtCrash&) = delete;

  void stop() const { stop_(); }

 private:
  std::function<void()> stop_;
};

}  // namespace forcebound::driver
