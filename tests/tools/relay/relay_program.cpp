#include "tests/tools/relay/relay_program.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/prctl.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <initializer_list>
#include <memory>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "forcebound/program/command_line.hpp"
#include "forcebound/program/log.hpp"
#include "forcebound/text/terminal.hpp"
#include "forcebound/time/real_time.hpp"
#include "forcebound/time/steady_clock.hpp"
#include "tests/tools/relay/control.hpp"
#include "tests/tools/relay/log_writer.hpp"
#include "tests/tools/relay/options.hpp"
#include "tests/tools/relay/summary.hpp"
#include "tests/tools/relay/udp_upstream.hpp"

namespace forcebound::relay {
namespace {

// Also bounds the delay of a signal that comes just before the wait.
constexpr Nanoseconds kLongestWait = std::chrono::milliseconds(50);

std::atomic<bool> stop_asked{false};  // any thread may get the signal

void ask_to_stop(int) { stop_asked = true; }

Nanoseconds now() { return time::SteadyClock().now(); }

std::uint64_t new_seed() {
  std::random_device device;  // 32 bits are enough to distinguish runs, and short enough to type
  return device();
}

void stop_on_signals() {
  struct sigaction action {};
  action.sa_handler = ask_to_stop;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

/// The relay's own jitter adds to every delay. Missing permissions are not an error: the summary shows how late packets
/// left.
void wake_up_precisely() {
  prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL);
  if (time::ask_for_first_in_first_out(20) != 0)
    spdlog::info("no real-time scheduling permitted: packets may leave a little late, see the summary");
}

RelaySettings settings_of(const Options& options, Nanoseconds start) {
  std::optional<netem::NetworkTrace> trace;
  if (!options.trace.empty()) trace = netem::load_trace(options.trace);
  const auto direction = [&](netem::Direction which, const netem::NetemParameters& netem,
                             const std::vector<netem::Blackhole>& blackholes) {
    return netem::ImpairmentSettings{.netem = netem,
                                     .trace = trace,
                                     .blackholes = blackholes,
                                     .seed = netem::direction_seed(options.seed, which),
                                     .origin = start};
  };
  return {.up = direction(netem::Direction::up, options.up, options.up_blackholes),
          .down = direction(netem::Direction::down, options.down, options.down_blackholes),
          .upstream = net::PeerLink::kPeer};
}

std::string words(const std::string& netem, const std::vector<netem::Blackhole>& blackholes) {
  std::string text = netem;
  for (const netem::Blackhole& hole : blackholes) {
    text += fmt::format("{}dead from {:g} s to {:g} s", text.empty() ? "" : ", ", time::to_seconds(hole.from),
                        time::to_seconds(hole.to));
  }
  return text.empty() ? "perfect" : text;
}

void announce(const Options& options, const Address& listen, const std::string& upstream) {
  std::string text = fmt::format("forcebound-relay: listening on {}, upstream {}, seed {}\n", to_string(listen),
                                 upstream, options.seed);
  text += fmt::format("  up:     {}\n  down:   {}\n", words(options.up_words, options.up_blackholes),
                      words(options.down_words, options.down_blackholes));
  if (!options.trace.empty()) text += fmt::format("  trace:  {}\n", options.trace);
  fmt::print("{}", text::wrapped_below_descriptions(text, 2));
  std::fflush(stdout);
  for (const netem::NetemParameters* netem : {&options.up, &options.down}) {
    if (netem == &options.down && options.down == options.up) continue;
    for (const std::string& warning : netem::netem_warnings(*netem)) spdlog::warn("{}", warning);
  }
}

/// New impairments from this machine, while the relay runs.
class ControlSocket {
 public:
  /// @throws std::invalid_argument if others than this machine could send there; std::runtime_error if it is in use.
  ControlSocket(const net::Endpoint& at, Control control) : link_(listen(at)), control_(std::move(control)) {}

  /// One line at most, so that a flood of them delays no packet for long.
  void receive() {
    const auto received = link_.receive(buffer_);
    if (!received) return;
    const std::size_t bytes = std::min(received->bytes, buffer_.size());
    const std::string_view line(reinterpret_cast<const char*>(buffer_.data()), bytes);
    const Control::Answer answer = control_.answer(line, now());
    if (answer.changed) spdlog::info("{}", answer.text);
    const std::string text = answer.text + "\n";
    (void)link_.send(std::as_bytes(std::span(text)), received->from);
  }

  [[nodiscard]] int descriptor() const noexcept { return link_.descriptor(); }
  [[nodiscard]] Address address() const noexcept { return link_.local_address(); }

 private:
  static net::UdpLink listen(const net::Endpoint& at) {
    const Address address = net::resolve(at);
    if (!net::is_loopback(address)) {
      throw std::invalid_argument("--control: " + to_string(address) +
                                  " can be reached from other machines; expected an address of this one alone, such "
                                  "as 127.0.0.1:47802");
    }
    return net::UdpLink::listen(address);
  }

  net::UdpLink link_;
  Control control_;
  std::array<std::byte, net::kDatagramBytesMax> buffer_{};
};

/// Says where the server was found, and why its name leads nowhere.
class ServerWords {
 public:
  ServerWords(UdpUpstream& upstream, const net::NameLookup& lookup) : upstream_(upstream), lookup_(lookup) {}

  void say_what_is_new() {
    for (const std::string& found : upstream_.take_news()) spdlog::info("server {}", found);
    const std::uint64_t lookups = lookup_.ended();
    if (lookups == std::exchange(reported_of_, lookups)) return;
    std::string problem = lookup_.problem();
    if (problem == std::exchange(problem_, problem) || problem.empty()) return;
    spdlog::warn("{}; trying again while clients are there", problem);
  }

 private:
  UdpUpstream& upstream_;
  const net::NameLookup& lookup_;
  std::uint64_t reported_of_ = 0;
  std::string problem_{};
};

void run(Relay& relay, const net::UdpLink& downstream, UdpUpstream& upstream, const net::NameLookup& server,
         std::optional<ControlSocket>& control) {
  std::vector<int> descriptors;
  ServerWords words(upstream, server);
  while (!stop_asked) {
    relay.forward(now());
    relay.receive(now());
    relay.forward(now());
    if (control) control->receive();
    if (server.is_name()) words.say_what_is_new();
    descriptors = upstream.descriptors();
    descriptors.push_back(downstream.descriptor());
    if (control) descriptors.push_back(control->descriptor());
    const Nanoseconds time = now();
    const Nanoseconds wake = std::min(relay.next_departure().value_or(Nanoseconds::max()), time + kLongestWait);
    if (wake > time) net::wait_readable(descriptors, wake - time);
  }
}

/// Whether what is sent to `upstream` comes back to a socket bound to `listen`: an any-address takes a loopback's too.
bool is_itself(const Address& upstream, const Address& listen) {
  const auto starts_with = [](const Address& address, std::initializer_list<std::uint8_t> bytes) {
    return std::equal(bytes.begin(), bytes.end(), address.ip.begin());
  };
  const auto is_any = [&](const Address& address) {
    return starts_with(address, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff, 0, 0, 0, 0}) ||
           starts_with(address, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  };
  const auto is_loopback = [&](const Address& address) {
    return starts_with(address, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff, 127}) ||
           starts_with(address, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1});
  };
  if (upstream == listen) return true;
  return upstream.port == listen.port && is_any(listen) && (is_any(upstream) || is_loopback(upstream));
}

/// The addresses of --upstream. @throws std::invalid_argument if one of them is the relay itself
net::Resolver resolver_but_for(const Address& listen) {
  return [listen](const net::Endpoint& upstream) {
    std::vector<Address> found = net::look_up(upstream);
    for (const Address& address : found) {
      if (is_itself(address, listen)) {
        throw std::invalid_argument("--upstream: " + to_string(address) +
                                    " is --listen, the relay itself; expected the server's address");
      }
    }
    return found;
  };
}

int relay_until_stopped(const Options& options) {
  const time::SteadyClock clock;
  const Address listen_address = net::resolve(options.listen);
  net::NameLookup server(options.upstream, resolver_but_for(listen_address));
  if (!server.is_name() && server.addresses().empty()) throw std::runtime_error(server.problem());
  const Nanoseconds start = now();
  RelaySettings settings = settings_of(options, start);
  if (const std::size_t room = UdpUpstream::make_room(settings.flows_max); room < settings.flows_max) {
    spdlog::warn("the limit on open files (ulimit -n) leaves room for {}, not for {} at once",
                 text::counted(room, "client"), settings.flows_max);
    settings.flows_max = room;
  }
  net::UdpLink downstream = net::UdpLink::listen(listen_address);
  UdpUpstream upstream(server, clock);
  std::unique_ptr<LogWriter> log;
  if (!options.log.empty()) {
    log = std::make_unique<LogWriter>(options.log, start, [&options](const std::string& why) {
      spdlog::error("the log '{}' is incomplete: {}; the relay goes on", options.log, why);
    });
  }
  Relay relay(settings, downstream, upstream, log.get());
  std::optional<ControlSocket> control;
  if (options.control) control.emplace(*options.control, Control(relay, {options.up_words, options.down_words}));

  stop_on_signals();
  announce(options, downstream.local_address(), server.in_words());
  if (control) spdlog::info("new impairments are taken at {}", to_string(control->address()));
  wake_up_precisely();
  run(relay, downstream, upstream, server, control);

  fmt::print("{}", summary(relay));
  if (upstream.refused() != 0)
    fmt::print("{} refused by {}: port unreachable (ICMP)\n", text::counted(upstream.refused(), "datagram"),
               server.in_words());
  if (downstream.counters().overflowed != 0)
    fmt::print("{} of clients lost: the socket was full\n",
               text::counted(downstream.counters().overflowed, "datagram"));
  if (log) {
    const LogResult result = log->finish();
    fmt::print("log: {} in {}\n", text::counted(result.written, "row"), options.log);
    if (result.missing != 0 || !result.problem.empty())
      fmt::print("log: {} missing: {}\n", text::counted(result.missing, "row"), result.problem);
    if (result.missing != 0 || !result.problem.empty()) return program::kOutputLost;
  }
  return program::kDone;
}

}  // namespace

int run_program(int argc, const char* const* argv) {
  return program::run(kProgram, [&] {
    const Options options = read_command_line(argc, argv, new_seed());
    program::log_to_stderr(kProgram);
    return relay_until_stopped(options);
  });
}

}  // namespace forcebound::relay
