#pragma once

#include <span>
#include <vector>

#include "forcebound/control/vector.hpp"
#include "forcebound/record/tick_record.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::lab {

using control::Vector;
using time::Nanoseconds;

/// Actual and correct force of a device on one tick.
struct DeviceTick {
  Nanoseconds time{0};  ///< of the reading
  bool answered = false;
  Nanoseconds motion_time{0};  ///< of the motion that the force in use answers, if `answered`
  Vector reference{};          ///< at the device's true position, now [N]
  Vector arrived{};            ///< the server's answer to that motion [N]
  Vector request{};            ///< after the late-force policy [N]
  Vector applied{};            ///< after the law [N]
  /// Not held: computed at the client, for where the device is.
  record::ForceOrigin rendering = record::ForceOrigin::held;
  Vector own{};  ///< the setting's own model at the device's true position, now [N]; no rows: the reference
  control::Handle handle{};
};

/// The error at the device, E = RMS |applied - reference| / RMS |reference| over all ticks, and its parts:
///
///     applied - reference(t) = model + extrapolation + age + hold + bounding
///     model     = arrived - reference(motion)           the server's model against the reference, at the same state
///     age       = reference(t - least) - reference(t)   the least age of any force in the run: network and computation
///     hold      = reference(motion) - reference(t - least) + request - arrived
///                                                       forces that were late, lost, rare, held or faded besides
///     bounding  = applied - request                     the law's reduction for passivity
///
/// That is where the force is the server's, held. On a tick that was rendered at the client it is nobody's age:
///
///     model         = own - reference(t)   the same model without a network, at the device's true position
///     extrapolation = request - own        what local models, encoder and change-overs make of it
///
/// and where the server's force for other parts is held beside, that difference counts as hold instead.
///
/// The errors e_i of the parts add up as vectors, on each tick, so that they partly cancel. The share of a part is its
/// component along the whole, E_i = <e_i, e> / (|e| |reference|): these add up to E exactly. A negative one compensates
/// others. `alone` is the part's error without the others, |e_i| / |reference|.
struct DeviceError {
  struct Part {
    double share = 0;
    double alone = 0;
  };
  double total = 0;  ///< E
  Part model{};
  Part extrapolation{};
  Part age{};
  Part hold{};
  Part bounding{};
  Nanoseconds least_age{0};
};

/// @param ticks in the order of time; before the first answer all the missing force counts as hold.
DeviceError device_error(std::span<const DeviceTick> ticks);

}  // namespace forcebound::lab
