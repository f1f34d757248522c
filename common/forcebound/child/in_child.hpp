#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>

namespace forcebound::child {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kLimitsMemoryOfChildren = false;  ///< a sanitizer has terabytes of its own
#else
inline constexpr bool kLimitsMemoryOfChildren = true;
#endif

/// What a child process may take.
struct ChildLimits {
  std::chrono::milliseconds time{20'000};
  std::size_t memory_bytes = std::size_t{1} << 30U;  ///< beyond what this process has; see kLimitsMemoryOfChildren
  std::size_t answer_bytes = std::size_t{1} << 30U;
  bool opens_files = false;  ///< else it can open none and write none
};

/// Runs work by a library that may crash, on untrusted input for example, in a child process: a copy of this one.
/// Neither a crash nor damaged memory reaches this process.
///
/// Other threads may hold locks at the moment of the copy, for ever as the child sees it: `work` must need none of its
/// program's own. Memory is all right. Blocks until the child has ended, at the latest when its time is over.
///
/// @param work its result is the child's answer, its exception the child's error
/// @throws std::runtime_error in one line: the error of `work`, or what limit was reached, or the signal that ended it
[[nodiscard]] std::string in_child(const std::function<std::string()>& work, const ChildLimits& limits = {});

}  // namespace forcebound::child
