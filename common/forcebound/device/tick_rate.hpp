#pragma once

#include <stdexcept>

#include "forcebound/control/classic_text.hpp"
#include "forcebound/control/device_facts.hpp"

namespace forcebound::device {

/// Ticks per second that can be asked for in place of a device's own. A slower loop shows walls that are too soft to
/// feel hard; a faster one leaves other threads no time.
inline constexpr double kTickRateLeast_Hz = 500;
inline constexpr double kTickRateMost_Hz = 4000;

/// The same device with another length of a tick, so that the law's figures are those of that length: the stiffest
/// wall is proportional to the rate. Everything else is the device's own and stays, its hold time too.
///
/// @param rate_Hz ticks per second; 0: the device's own
/// @throws std::invalid_argument outside 500 to 4000, or if the device would let go of each force before the next tick
[[nodiscard]] inline control::DeviceFacts at_tick_rate(control::DeviceFacts facts, double rate_Hz) {
  if (rate_Hz == 0) return facts;
  if (!(rate_Hz >= kTickRateLeast_Hz && rate_Hz <= kTickRateMost_Hz)) {
    throw std::invalid_argument(control::joined("ticks per second must be from ", kTickRateLeast_Hz, " to ",
                                                kTickRateMost_Hz, ", got ", rate_Hz));
  }
  facts.period_s = 1 / rate_Hz;
  if (facts.releases && facts.hold_s_max < facts.period_s) {
    control::ClassicText text;
    text << "device '" << facts.name << "' holds a force for " << facts.hold_s_max * 1e3 << " ms, less than a tick of "
         << facts.period_s * 1e3 << " ms: at least " << 1 / facts.hold_s_max << " ticks per second are accepted, got "
         << rate_Hz;
    throw std::invalid_argument(text.str());
  }
  return facts;
}

}  // namespace forcebound::device
