#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "forcebound/time/clock.hpp"
#include "tests/tools/netem/random.hpp"

namespace forcebound::netem {

using time::Nanoseconds;

enum class DelayShape : std::uint8_t { uniform, normal, pareto, paretonormal };

/// `delay TIME [JITTER [CORR]] [distribution normal|pareto|paretonormal]`
struct Delay {
  Nanoseconds mean{0};
  Nanoseconds jitter{0};  ///< half the width of the uniform shape, one sigma of the others
  Share correlation = 0;
  DelayShape shape = DelayShape::uniform;
  bool operator==(const Delay&) const = default;
};

/// `loss PCT [CORR]`: each packet independently.
struct RandomLoss {
  Chance chance{};
  bool operator==(const RandomLoss&) const = default;
};

/// `loss gemodel P [R [1-H [1-K]]]`: a good and a bad state. Mean loss (P(1-H) + R(1-K)) / (P + R), mean burst 1/R at
/// 1-H = 100 %.
struct GilbertElliottLoss {
  Share good_to_bad = 0;      ///< P
  Share bad_to_good = 0;      ///< R
  Share bad_loss = kCertain;  ///< 1-H
  Share good_loss = 0;        ///< 1-K
  bool operator==(const GilbertElliottLoss&) const = default;
};

/// `loss state P13 [P31 [P32 [P23 [P14]]]]`: 1 good, 2 good inside a burst, 3 burst loss, 4 one isolated loss.
struct FourStateLoss {
  Share p13 = 0;
  Share p31 = 0;
  Share p32 = 0;
  Share p23 = kCertain;
  Share p14 = 0;
  bool operator==(const FourStateLoss&) const = default;
};

using Loss = std::variant<std::monostate, RandomLoss, GilbertElliottLoss, FourStateLoss>;

/// `reorder PCT [CORR] [gap N]`: packets that go at once, ahead of all delayed ones.
struct Reorder {
  Chance chance{};
  std::uint32_t gap = 0;  ///< at most every N-th packet; 0: no reordering
  bool operator==(const Reorder&) const = default;
};

/// `rate RATE [OVERHEAD [CELL [CELL_OVERHEAD]]]`
struct Rate {
  std::uint64_t bits_per_second = 0;  ///< 0: unlimited
  std::int32_t packet_overhead_bytes = 0;
  std::uint32_t cell_bytes = 0;  ///< 0: no cells
  std::int32_t cell_overhead_bytes = 0;
  bool operator==(const Rate&) const = default;
};

/// `slot MIN [MAX] [packets N] [bytes N]`: packets leave only at slot times.
struct Slot {
  Nanoseconds shortest{0};
  Nanoseconds longest{0};     ///< 0: no slots
  std::uint64_t packets = 0;  ///< most packets in each, 0: any number
  std::uint64_t bytes = 0;    ///< a slot closes after this many, 0: any number
  bool operator==(const Slot&) const = default;
};

/// Most waiting packets without `limit`.
inline constexpr std::uint32_t kLimitPackets = 1000;
/// The same under a trace of round trips. Its long delays were measured on packets that did arrive, and at 1 kHz a
/// delay of one second alone would fill netem's default.
inline constexpr std::uint32_t kTracedLimitPackets = 100'000;

/// One direction of a bad network, in the words of `tc ... netem`. Without any: a perfect one.
struct NetemParameters {
  Delay delay{};
  Loss loss{};
  Chance duplicate{};
  Chance corrupt{};
  Reorder reorder{};
  Rate rate{};
  std::optional<std::uint32_t> limit_packets{};  ///< not given: kLimitPackets, or kTracedLimitPackets under a trace
  Slot slot{};
  bool operator==(const NetemParameters&) const = default;
};

/// Reads the words that would follow `netem` on a command line of tc: "delay 50ms 10ms loss 5%".
///
/// As there: a time without unit is microseconds; `distribution` needs delay and jitter; `reorder` needs delay; `gap`
/// needs reorder. Unlike there, nothing may be given twice, and words are not abbreviated.
///
/// @throws std::invalid_argument naming the offending word and what would be accepted.
NetemParameters parse_netem(std::string_view words);

/// Warnings about legal but unlikely settings, one line each. Empty if there are none.
std::vector<std::string> netem_warnings(const NetemParameters& parameters);

/// The grammar in a form fit for `--help`.
std::string_view netem_help() noexcept;

}  // namespace forcebound::netem
