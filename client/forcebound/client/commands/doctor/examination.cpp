#include "forcebound/client/commands/doctor/examination.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <memory>
#include <random>
#include <stdexcept>
#include <thread>

#include "forcebound/client/commands/doctor/introduction.hpp"
#include "forcebound/client/commands/doctor/path_size.hpp"
#include "forcebound/client/runtime/priority.hpp"
#include "forcebound/record/idle_thread.hpp"
#include "forcebound/record/wake_ups.hpp"
#include "forcebound/time/periodic_timer.hpp"
#include "forcebound/time/steady_clock.hpp"
#include "forcebound/wire/codec.hpp"

namespace forcebound::client::commands {
namespace {

using namespace std::chrono_literals;

constexpr Nanoseconds kExaminedPeriod = 1ms;
constexpr Nanoseconds kEndPatience = 3s;
constexpr Nanoseconds kDisplayPause = 50ms;
// The most usual first.
constexpr std::array kDegreesOfFreedom{3, 1, 2, 6, 4, 5};

// How often a size is tried, against losses, and the pause between: the server answers only the newest of a batch.
constexpr int kSizeTries = 8;
constexpr Nanoseconds kSizePause = 5ms;
constexpr Nanoseconds kSizePatience_min = 250ms;
constexpr Nanoseconds kSizePatience_max = 1s;
// Longer than a motion of six degrees of freedom, and less than what every IPv4 network carries (576 bytes, RFC 791).
constexpr std::size_t kSizeLeast_bytes = 256;
constexpr std::size_t kSizeResolution_bytes = 8;

std::uint64_t random_seed() {
  std::random_device device;
  return std::uint64_t{device()} << 32U | device();
}

/// With the first degrees of freedom that the scene accepts.
/// @throws std::runtime_error if there is no session
std::unique_ptr<DoctorLine> introduced_line(const ExaminationSettings& settings, DoctorFindings& findings,
                                            const time::Clock& clock) {
  // Answers are fewer than ticks, and copies are not kept.
  const auto ticks = static_cast<std::size_t>(time::from_seconds(settings.seconds) / kExaminedPeriod);
  std::unique_ptr<DoctorLine> line;
  for (const int degrees_of_freedom : kDegreesOfFreedom) {
    line = first_to_answer(settings.server,
                           {.scene = settings.scene,
                            .degrees_of_freedom = degrees_of_freedom,
                            .seed = random_seed(),
                            .answers = ticks + 1},
                           clock);
    findings.degrees_of_freedom = degrees_of_freedom;
    if (line->session.handshake().refused_for != wire::RefusalReason::wrong_degrees_of_freedom) break;
  }
  if (line->session.connected()) return line;
  throw std::runtime_error(in_words(settings.server, line->address) + " refused: " + line->session.handshake().refusal);
}

/// Sends motions as a client's tick does.
void tick_for(Nanoseconds duration, DoctorSession& session, MachineFindings& machine, const time::Clock& clock) {
  record::WakeUps wake_ups(kExaminedPeriod);
  machine.grant = time::ask_for_real_time(client::kTickPriority);
  time::touch_stack();
  time::PeriodicTimer timer(clock, kExaminedPeriod);
  const Nanoseconds begin = timer.wait();
  wake_ups.add(begin);
  for (Nanoseconds now = begin; now - begin < duration;) {
    session.tick();
    now = timer.wait();
    wake_ups.add(now);
  }
  machine.tick = wake_ups.figures();
  machine.missed_ticks = timer.missed();
}

/// Ends the session, so that nothing is on its way any more.
void end_session(DoctorLine& line, const time::Clock& clock) {
  for (const Nanoseconds end = clock.now() + kEndPatience; !line.session.close() && clock.now() < end;)
    wait_for_datagrams(line.link, kExaminedPeriod);
}

void measure(const ExaminationSettings& settings, DoctorLine& line, DoctorFindings& findings, const time::Clock& clock,
             const std::function<void(double, const std::string&)>& progress) {
  const Nanoseconds duration = time::from_seconds(settings.seconds);
  Nanoseconds gap{0};
  {
    record::IdleThread idle(clock, kExaminedPeriod, client::kTickPriority);
    std::atomic<bool> done = false;
    std::jthread ticks([&] {
      tick_for(duration, line.session, findings.machine, clock);
      gap = line.session.longest_gap();
      done = true;
    });
    for (const Nanoseconds begin = clock.now(); !done;) {
      std::this_thread::sleep_for(kDisplayPause);
      progress(std::min(1.0, time::to_seconds(clock.now() - begin) / settings.seconds), "measuring");
    }
    ticks.join();
    findings.machine.idle = idle.stop();
  }
  const Nanoseconds end = clock.now();
  end_session(line, clock);

  const DoctorSession& session = line.session;
  findings.handshake = session.handshake();
  findings.network = network_findings(session.answers(), session.counts(), gap);
  findings.clocks.known = session.clocks().known();
  if (findings.clocks.known) {
    findings.clocks.ahead_ms = 1e3 * time::to_seconds(session.clocks().ahead());
    findings.clocks.uncertain_ms = 1e3 * time::to_seconds(session.clocks().uncertainty(end));
  }
  findings.pieces_received = session.pieces_received();
  findings.piece_bytes = session.piece_bytes();
  findings.malformed = session.malformed();
  findings.overflowed = line.link.counters().overflowed;
  findings.unreachable = line.link.counters().refused;
}

/// Whether a datagram of that size that may not be taken apart is answered.
bool size_passes(std::size_t bytes, Nanoseconds patience, DoctorLine& line, const time::Clock& clock) {
  std::uint64_t first = 0;
  const auto answered_within = [&](Nanoseconds time) {
    for (const Nanoseconds end = clock.now() + time; clock.now() < end;) {
      line.session.receive();
      if (first != 0 && line.session.is_answered_since(first)) return true;
      wait_for_datagrams(line.link, std::min(kExaminedPeriod, end - clock.now()));
    }
    return false;
  };
  for (int i = 0; i < kSizeTries; ++i) {
    const std::uint64_t motion = line.session.send_motion(bytes);
    if (first == 0) first = motion;
    if (answered_within(kSizePause)) return true;
  }
  return first != 0 && answered_within(patience);
}

PathFindings path_findings(const net::Address& address, const ExaminationSettings& settings,
                           const DoctorFindings& so_far, const time::Clock& clock) {
  DoctorLine line(settings.server,
                  {.server = address,
                   .scene = settings.scene,
                   .degrees_of_freedom = so_far.degrees_of_freedom,
                   .renders_locally = false,
                   .seed = random_seed()},
                  clock);
  PathFindings path{
      .up_most_bytes = wire::kFrameBytesMax,
      .header_bytes = header_bytes(address) + (settings.server.identity.any() ? security::kRecordOverhead : 0)};
  path.up_tried = introduce(line, clock);
  if (path.up_tried) {
    const Nanoseconds patience =
        std::clamp(time::from_seconds(2e-3 * so_far.network.round_trip.max_ms), kSizePatience_min, kSizePatience_max);
    set_fragments(line.link, address, Fragments::never);
    path.up_bytes = largest_that_passes({.least = kSizeLeast_bytes, .most = path.up_most_bytes}, kSizeResolution_bytes,
                                        [&](std::size_t bytes) { return size_passes(bytes, patience, line, clock); });
    set_fragments(line.link, address, Fragments::as_usual);
    end_session(line, clock);
  }
  path.mtu = believed_mtu(line.link, address);
  path.down_bytes = line.session.largest_bytes();
  return path;
}

}  // namespace

DoctorFindings examine(const ExaminationSettings& settings,
                       const std::function<void(double, const std::string&)>& progress) {
  const time::SteadyClock clock;
  DoctorFindings findings{.seconds = settings.seconds};
  findings.machine = machine_findings();
  net::Address address;
  std::size_t down_bytes = 0;
  {
    const std::unique_ptr<DoctorLine> line = introduced_line(settings, findings, clock);
    address = line->address;
    findings.server = in_words(settings.server, address);
    measure(settings, *line, findings, clock, progress);
    down_bytes = line->session.largest_bytes();
  }
  if (findings.network.round_trip.count == 0) {
    throw std::runtime_error(findings.server + " opened a session, but no force arrived in " +
                             std::to_string(findings.network.up.sent) + " ticks");
  }
  progress(1, "trying sizes of datagrams");
  findings.path = path_findings(address, settings, findings, clock);
  findings.path.down_bytes = std::max(findings.path.down_bytes, down_bytes);
  return findings;
}

}  // namespace forcebound::client::commands
