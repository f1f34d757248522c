#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "forcebound/control/reading_status.hpp"
#include "forcebound/record/blackout.hpp"
#include "forcebound/record/fault_counts.hpp"
#include "forcebound/time/clock.hpp"
#include "forcebound/wire/malformed.hpp"

/// Settings and totals of a run: with its ticks and forces, all that a summary needs.
namespace forcebound::record {

using time::Nanoseconds;
using KeyValues = std::map<std::string, std::string>;

inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();

/// Known when a run begins.
struct RunInfo {
  std::string program;              ///< with its version
  std::string law;                  ///< none, fba-less, ...
  std::string law_parameters;       ///< as text; empty: it has none
  std::string device;               ///< name
  std::string facts;                ///< the device's facts, as text
  std::string operator_name;        ///< who holds the device
  std::string hand;                 ///< mass, stiffness and damping of that hand, as text
  std::string scene;                ///< as asked for; empty: the server's own
  std::string simulated;            ///< what is simulated, as text
  std::string rendering{"remote"};  ///< as asked for: "remote" or "local"
  std::string network;              ///< emulated network conditions, as far as this side knows
  std::string encryption;           ///< of the datagrams: "none", "IKpsk2" or "NNpsk0"; empty: not said
  std::uint64_t seed = 0;
  Nanoseconds period{1'000'000};        ///< nominal length of a tick
  Nanoseconds hold{250'000'000};        ///< late-force policy: forces older than this fade
  Nanoseconds drop{1'000'000'000};      ///< ... and older than this are zero
  Nanoseconds epoch{0};                 ///< wall-clock time [since 1970, UTC] when the steady clock read zero
  bool audited = false;                 ///< the device knows P(t)
  bool device_simulated = false;        ///< device and hand are models within this program
  bool surface_true = false;            ///< penetration is that of the device's true position in the scene
  std::string guarantee;                ///< what the law guarantees of P without an audit; empty: nothing
  double settle_s = 0;                  ///< contact statistics leave out this long after the first contact
  double stiffness_depth_m_min = 1e-5;  ///< displayed stiffness is taken deeper than this only
  double force_N_max = kNoLimit;        ///< the device's largest force; larger requests are clipped whatever the law
  double rounding_N = 0;                ///< a force that differs less from the request was rounded, not bounded
};

/// An interval longer than the period by more than this is late.
inline constexpr Nanoseconds kLateBy = std::chrono::microseconds{500};

/// Wake-up intervals of a thread that only sleeps at the tick's period: the reference for the tick's own period.
struct IdleTimer {
  std::uint64_t wake_ups = 0;  ///< 0: not measured
  std::uint64_t late = 0;      ///< intervals more than 0.5 ms above the period
  double p50_us = 0;           ///< of the intervals between wake-ups
  double p99_us = 0;
  double p999_us = 0;
  double max_us = 0;
};

/// Known when a run ends. Counts of datagrams are those of the environment forces and motions, not of handshakes.
struct RunTotals : FaultCounts {
  std::uint64_t sent = 0;        ///< motions
  std::uint64_t received = 0;    ///< distinct forces
  std::uint64_t lost_up = 0;     ///< motions that the server did not see
  std::uint64_t lost_down = 0;   ///< forces sent that did not arrive
  std::uint64_t in_flight = 0;   ///< of `lost_up`: may still be on their way
  std::uint64_t unanswered = 0;  ///< motions that the server received, not answered
  std::uint64_t duplicated = 0;  ///< additional copies of motions or forces
  std::uint64_t reordered = 0;   ///< motions or forces that arrived after a newer one
  wire::MalformedCounts malformed{};
  control::ReadingCounts readings{};    ///< of each status that is refused: no force
  Blackout longest_blackout;            ///< without any new force
  std::uint64_t scene_pieces = 0;       ///< received, of scenes that run at the client
  std::uint64_t scene_piece_bytes = 0;  ///< of them
  std::uint64_t scenes_from_cache = 0;
  std::optional<Nanoseconds> server_ahead{};      ///< the server's clock less the client's, if that is known
  std::optional<Nanoseconds> server_ahead_off{};  ///< and by how much it may be off
  std::vector<std::string> notes;                 ///< one line for each fault that needs an explanation
  std::string scene;                              ///< as the server named it; empty: there was no session
  std::string simulated;                          ///< what the server said it simulates, as text
  IdleTimer idle_timer;
};

/// Outcome of the motions, each counted once, from both ends' counters:
///
///     sent = answered + unanswered + lost_up + lost_down + in_flight
struct MotionFates {
  std::uint64_t sent = 0;
  std::uint64_t answered = 0;  ///< their forces arrived
  /// Received by the server, which answered a newer one instead, or had ended the session.
  std::uint64_t unanswered = 0;
  std::uint64_t lost_up = 0;    ///< the server did not receive them
  std::uint64_t lost_down = 0;  ///< their forces did not arrive
  std::uint64_t in_flight = 0;  ///< too recent for either end to know
};
[[nodiscard]] MotionFates fates_of(const RunTotals& totals) noexcept;

/// "20000 sent = 18990 answered + 12 unanswered + 503 lost up + 490 lost down + 5 in flight"
[[nodiscard]] std::string words_of(const MotionFates& fates);

/// As the metadata of a recording holds them: one entry per field, numbers in full.
KeyValues to_key_values(const RunInfo& info);
KeyValues to_key_values(const RunTotals& totals);

/// Fields that are absent keep their default; unknown ones are ignored: an older or newer program wrote them.
/// @param problem if given, names the first field whose value is not a number where one belongs; such keep their
/// default
/// @throws std::invalid_argument the same, if not.
RunInfo run_info_from(const KeyValues& values, std::string* problem = nullptr);
RunTotals run_totals_from(const KeyValues& values, std::string* problem = nullptr);

/// The fault counts, each with its name in the summary and its meaning.
struct Fault {
  std::string name;
  std::uint64_t count;
  const char* one;   ///< "tick left out: the loop woke too late for it"
  const char* many;  ///< the same for any other count
  [[nodiscard]] const char* meaning() const noexcept { return count == 1 ? one : many; }
};
std::vector<Fault> faults_of(const RunTotals& totals);

}  // namespace forcebound::record
