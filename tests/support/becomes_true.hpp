#pragma once

#include <chrono>
#include <thread>

namespace forcebound::test {

/// How long tests wait for what must happen. Only a failure takes so long: no machine is that slow.
inline constexpr std::chrono::nanoseconds kPatience = std::chrono::minutes{2};

/// How tests wait for what other threads and programs do: looks about 1000 times a second whether `condition` holds.
/// False: it did not within `patience`.
template <class Condition>
[[nodiscard]] bool becomes_true(Condition condition, std::chrono::nanoseconds patience = kPatience) {
  const auto end = std::chrono::steady_clock::now() + patience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() >= end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds{1});
  }
  return true;
}

}  // namespace forcebound::test
