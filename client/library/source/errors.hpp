#pragma once

#include <exception>
#include <string>
#include <string_view>
#include <utility>

#include "library/forcebound.h"

namespace forcebound::library {

/// Stores why a function failed, for fb_last_error of this thread: "FUNCTION: WHY". Noexcept, no allocation but for
/// what the first failure on a thread may take for its buffer.
void store_error(std::string_view function, std::string_view why) noexcept;

/// The same, and the status as the function returns it.
[[nodiscard]] inline fb_status refused(std::string_view function, std::string_view why,
                                       fb_status status = FB_INVALID) noexcept {
  store_error(function, why);
  return status;
}

/// Stores what the exception in flight says. @returns FB_INVALID for std::invalid_argument, FB_NO_MEMORY, or FB_FAILED
[[nodiscard]] fb_status store_exception(std::string_view function) noexcept;

/// A function of the C interface whose body may throw. @returns what `body` returns
template <class Body>
[[nodiscard]] fb_status guarded(std::string_view function, Body&& body) noexcept {
  try {
    return std::forward<Body>(body)();
  } catch (...) {
    return store_exception(function);
  }
}

/// The body of a thread of ours. @param body returns why it failed; empty: it did not @returns that, or what it threw
template <class Body>
[[nodiscard]] std::string failure_of(Body&& body) {
  try {
    return std::forward<Body>(body)();
  } catch (const std::exception& error) {
    return error.what();
  } catch (...) {
    return "an exception of an unknown kind";
  }
}

}  // namespace forcebound::library
