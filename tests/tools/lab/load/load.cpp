#include "tests/tools/lab/load/load.hpp"

#include <sched.h>
#include <sys/prctl.h>

#include <algorithm>
#include <cstring>
#include <random>
#include <stdexcept>
#include <utility>

#include "forcebound/net/endpoint.hpp"
#include "forcebound/time/real_time.hpp"
#include "forcebound/time/steady_clock.hpp"

namespace forcebound::lab {
namespace {

using namespace std::chrono_literals;

constexpr Nanoseconds kPeriod = 1ms;
// Later than this, a motion is not sent any more: a real client would send its next.
constexpr Nanoseconds kTooLate = 1ms;
// For answers to the last motions.
constexpr Nanoseconds kAfter = 100ms;
// Pause before a measurement: the system would stop a real-time thread that never sleeps.
constexpr Nanoseconds kRest = 100ms;
// Number of port unreachable (ICMP) reports after which the measurement gives up.
constexpr std::uint64_t kRefusalsBorne = 10;
// A server accepts 50 Hellos a second.
constexpr Nanoseconds kHelloPause = 21ms;
constexpr Nanoseconds kServerPatience = 5s;

Nanoseconds now() noexcept { return time::SteadyClock().now(); }

void stay_on(int processor) {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(static_cast<unsigned>(processor), &set);
  if (sched_setaffinity(0, sizeof set, &set) != 0) {
    throw std::runtime_error("cannot be pinned to processor " + std::to_string(processor) + ": " +
                             std::strerror(errno));
  }
}

LoadGenerator::Settings with_new_nonces(LoadGenerator::Settings settings) {
  std::random_device device;
  settings.first_nonce = std::uint64_t{device()} << 20U;
  return settings;
}

}  // namespace

Load::Line::Line(const net::Address& server, const LoadOptions& options, const time::Clock& clock)
    : link(net::UdpLink::towards(server)), batch(link) {
  if (!options.identity.any()) return;
  encryption = std::make_unique<client::Encryption>(options.identity, options.server, link, server, clock);
}

Load::Load(const LoadOptions& options)
    : options_(options),
      server_(net::resolve(net::parse_endpoint(options.server))),
      load_generator_(with_new_nonces(options.load_generator)) {
  prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL);
  if (options.processor) stay_on(*options.processor);
  if (options.priority && !time::ask_for_real_time(*options.priority).first_in_first_out) {
    throw std::runtime_error("real-time scheduling is not permitted");
  }
  for (std::size_t i = 0; i < options.sockets; ++i) {
    lines_.emplace_back(server_, options_, clock_);
    descriptors_.push_back(lines_.back().link.descriptor());
    lines_.back().link.wait_at_most(kPeriod);
  }
}

Load::~Load() {
  for (std::size_t client = 0; client < load_generator_.size() && !options_.load_generator.echo; ++client) {
    if (load_generator_.connected(client)) send(load_generator_.bye(client), client);
  }
}

LoadResult Load::run(std::size_t clients) {
  connect(clients);
  receive_scene(clients);
  LoadResult result{.clients = clients};
  rest(now() + kRest);
  const Nanoseconds begin = now();
  load_generator_.begin(begin);
  // Motion number i of all is due at begin + i of these; client i % clients sends it.
  const auto motions = static_cast<std::int64_t>(clients) * (options_.duration / kPeriod);
  const auto due = [&](std::int64_t i) { return begin + i * kPeriod / static_cast<std::int64_t>(clients); };
  for (std::int64_t i = 0; i < motions;) {
    for (Nanoseconds time = now(); time < due(i); time = now()) wait(due(i));
    const auto first = static_cast<std::size_t>(i) % clients;
    const Nanoseconds time = now();
    const LoadGenerator::Tally& tally = load_generator_.tally();
    given_up_ = tally.sent - std::min(tally.sent, tally.answered);
    // If late, sends all motions due at once, up to the last client of a socket.
    do {
      const auto client = static_cast<std::size_t>(i) % clients;
      if (client < first || &line_of(client) != &line_of(first)) break;
      if (time > due(i) + kTooLate) {
        ++result.unsent;
      } else {
        const auto motion = sealed(load_generator_.motion(client, time), client);
        if (!burst_.add(motion)) {
          result.unsent += send_burst(first);
          static_cast<void>(burst_.add(motion));
        }
      }
      ++i;
    } while (i < motions && due(i) <= time);
    result.unsent += send_burst(first);
    // Answers are read between sends even under full load, or the sockets would overflow.
    receive();
  }
  for (const Nanoseconds end = now() + kAfter;
       now() < end && load_generator_.tally().answered < load_generator_.tally().sent;)
    wait(end);
  if (!load_generator_.refusal().empty())
    throw std::runtime_error(options_.server + " refused: " + load_generator_.refusal());
  result.tally = load_generator_.tally();
  result.handed_over = load_generator_.handed_over();
  return result;
}

std::uint64_t Load::send_burst(std::size_t client) {
  const std::size_t size = burst_.size();
  if (size == 0) return 0;
  return burst_.send(line_of(client).link, server_) ? 0 : size;
}

void Load::connect(std::size_t clients) {
  load_generator_.grow(std::max(clients, load_generator_.size()));
  for (std::size_t client = 0; client < clients; ++client) {
    for (const Nanoseconds first = now(); !load_generator_.connected(client);) {
      if (!load_generator_.refusal().empty()) {
        if (!load_generator_.refused_for_now() || now() - first > kServerPatience)
          throw std::runtime_error(options_.server + " refused: " + load_generator_.refusal());
        load_generator_.forget_refusal();
      }
      const bool unreachable = line_of(client).link.counters().refused > kRefusalsBorne;
      if (unreachable || now() - first > kServerPatience) {
        const std::string problem =
            line_of(client).encryption ? line_of(client).encryption->handshaker().problem() : std::string();
        if (!problem.empty()) throw std::runtime_error(problem);
        throw std::runtime_error("no answer from " + options_.server +
                                 (unreachable ? ": port unreachable (ICMP)" : ""));
      }
      if (const Line& line = line_of(client); !line.encryption || line.encryption->link().ready()) {
        send(load_generator_.hello(client, now()), client);
      }
      rest(now() + kHelloPause);
    }
  }
}

void Load::receive_scene(std::size_t clients) {
  std::uint64_t pieces = load_generator_.handed_over().pieces;
  for (Nanoseconds heard = now();;) {
    bool wanted = false;
    for (std::size_t client = 0; client < clients; ++client) {
      if (!load_generator_.wants_pieces(client)) continue;
      wanted = true;
      send(load_generator_.motion(client, now()), client);
      receive();
    }
    if (!wanted) return;
    rest(now() + kPeriod);
    const std::uint64_t pieces_before = std::exchange(pieces, load_generator_.handed_over().pieces);
    if (pieces != pieces_before) heard = now();
    if (now() - heard > kServerPatience) {
      throw std::runtime_error("no further piece of the scene from " + options_.server);
    }
  }
}

void Load::rest(Nanoseconds until) {
  for (Nanoseconds time = now(); time < until; time = now()) {
    net::wait_readable(descriptors_, until - time);
    receive();
  }
}

void Load::wait(Nanoseconds until) {
  using Waiting = LoadOptions::Waiting;
  const LoadGenerator::Tally& tally = load_generator_.tally();
  const bool answer_missing = tally.answered + given_up_ < tally.sent;
  const bool asleep = options_.waiting == Waiting::asleep || (options_.waiting == Waiting::ping_pong && answer_missing);
  // With an answer to wait for on one socket, one call sleeps and receives, as sockperf's does.
  if (asleep && answer_missing && lines_.size() == 1) {
    return receive_arrived(lines_.front(), lines_.front().batch.wait_for_some());
  }
  if (asleep) net::wait_readable(descriptors_, until - now());
  receive();
}

void Load::receive() {
  for (Line& line : lines_) {
    receive_arrived(line, line.batch.receive_all());
    if (line.encryption) line.encryption->link().exchange();
  }
}

void Load::receive_arrived(Line& line, std::span<const net::UdpBatch::Arrived> arrived) {
  const Nanoseconds time = now();
  for (const auto& datagram : arrived) {
    std::span<const std::byte> bytes = datagram.bytes;
    if (line.encryption) {
      const auto opened = line.encryption->link().open(bytes, opened_);
      if (!opened) continue;
      bytes = std::span(opened_).first(*opened);
    }
    load_generator_.on_datagram(bytes, time - datagram.received.waited, time);
  }
}

std::span<const std::byte> Load::sealed(std::span<const std::byte> datagram, std::size_t client) noexcept {
  Line& line = line_of(client);
  return line.encryption ? line.encryption->link().seal(datagram) : datagram;
}

bool Load::send(std::span<const std::byte> datagram, std::size_t client) {
  Line& line = line_of(client);
  return (line.encryption ? static_cast<net::DatagramLink&>(line.encryption->link()) : line.link)
      .send(datagram, server_);
}

Load::Line& Load::line_of(std::size_t client) noexcept { return lines_[client / Burst::kDatagramsMax % lines_.size()]; }

}  // namespace forcebound::lab
