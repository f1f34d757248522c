#pragma once

#include <cstddef>
#include <span>

/// Ends the program, after zero force, where `condition` does not hold: for bugs of our own only, release builds
/// included. What others do wrong (a datagram, a file, a device) is counted or refused instead.
///
///     FORCEBOUND_ASSERT(force_N.allFinite(), "a force on its way to the device is finite");
///
/// @param what says in words what always holds. Real time: one branch; noexcept, no allocation.
#define FORCEBOUND_ASSERT(condition, what) \
  ((condition) ? static_cast<void>(0)      \
               : ::forcebound::control::end_by_assertion({#condition, (what), __FILE__, __LINE__}))

namespace forcebound::control {

/// A statement about our own code that turned out to be false.
struct FailedAssertion {
  const char* condition;
  const char* what;
  const char* file;
  int line;
};

/// What a program does about a failed assertion before it ends.
class LastResort {
 public:
  virtual ~LastResort() = default;

  /// Comes first, before anything is printed, on the thread that found the bug: zero force. noexcept, no allocation.
  virtual void make_safe() noexcept = 0;

  /// What a person needs to find the bug (state, seed), as text into `words`; gives how many characters it is.
  [[nodiscard]] virtual std::size_t describe(std::span<char> words) const noexcept = 0;
};

/// `resort` is called by every failed assertion of the process while this lives; then the one before is again.
/// Install it before the threads whose device it stops begin, and remove it after they ended.
class LastResortScope {
 public:
  explicit LastResortScope(LastResort& resort) noexcept;
  ~LastResortScope();
  LastResortScope(const LastResortScope&) = delete;
  LastResortScope& operator=(const LastResortScope&) = delete;

 private:
  LastResort* before_;
};

/// Makes safe, prints one line on stderr and aborts. A second failure on the way prints and aborts at once.
[[noreturn]] void end_by_assertion(const FailedAssertion& failed) noexcept;

}  // namespace forcebound::control
