#include "forcebound/client/commands/doctor/introduction.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <stdexcept>
#include <thread>
#include <utility>

#include "forcebound/net/address_turns.hpp"
#include "forcebound/wire/codec.hpp"

namespace forcebound::client::commands {
namespace {

using namespace std::chrono_literals;

constexpr Nanoseconds kHandshakePatience = 5s;
constexpr Nanoseconds kLookUpPause = 500ms;
constexpr Nanoseconds kReadWait = 1ms;
// Number of port unreachable (ICMP) reports after which nobody is expected there.
constexpr std::uint64_t kUnreachableBorne = 3;

bool is_unreachable(const DoctorLine& line) { return line.link.counters().refused >= kUnreachableBorne; }
bool is_refused(const DoctorLine& line) { return !line.session.handshake().refusal.empty(); }

/// Looks for the server at its addresses.
class Search {
 public:
  Search(const ExaminedServer& server, const DoctorSession::Settings& settings, const time::Clock& clock)
      : server_(server), settings_(settings), clock_(clock), end_(clock.now() + kHandshakePatience) {}

  std::unique_ptr<DoctorLine> run() {
    while (clock_.now() < end_ && !all_unreachable()) {
      if (addresses_.empty() && !look_up()) continue;
      if (tried_ < addresses_.size() && (clock_.now() >= next_ || unreachable_lines() == lines_.size())) try_next();
      for (auto& line : lines_) {
        line->session.keep_connected();
        if (line->session.connected() || is_refused(*line)) return std::move(line);
      }
      wait();
    }
    throw std::runtime_error(why_none());
  }

 private:
  bool look_up() {
    try {
      addresses_ = server_.resolver(net::parse_peer(server_.name));
      return true;
    } catch (const std::runtime_error& error) {
      problem_ = error.what();
      std::this_thread::sleep_for(kLookUpPause);
      return false;
    }
  }

  void try_next() {
    next_ = clock_.now() + net::AddressTurns::kTurnLeast;
    settings_.server = addresses_[tried_++];
    try {
      lines_.push_back(std::make_unique<DoctorLine>(server_, settings_, clock_));
    } catch (const std::runtime_error& error) {
      problem_ = error.what();
      next_ = clock_.now();
    }
  }

  [[nodiscard]] std::size_t unreachable_lines() const {
    return static_cast<std::size_t>(
        std::ranges::count_if(lines_, [](const auto& line) { return is_unreachable(*line); }));
  }
  [[nodiscard]] bool all_unreachable() const {
    return !addresses_.empty() && tried_ == addresses_.size() && unreachable_lines() == lines_.size();
  }

  void wait() const {
    std::vector<int> descriptors;
    for (const auto& line : lines_) {
      if (!is_unreachable(*line)) descriptors.push_back(line->link.descriptor());
    }
    net::wait_readable(descriptors, kReadWait);
  }

  [[nodiscard]] std::string why_none() const {
    if (addresses_.empty() || lines_.empty()) return "no answer from " + server_.name + ": " + problem_;
    for (const auto& line : lines_) {
      const std::string problem = line->encryption ? line->encryption->handshaker().problem() : std::string();
      if (!problem.empty()) return problem + "; " + words_of_addresses();
    }
    if (all_unreachable()) {
      return "no answer from " + words_of_addresses() + ": port unreachable (ICMP); is forcebound-server running?";
    }
    return "no answer from " + words_of_addresses() + " within 5 s; is forcebound-server listening there, and does " +
           "the network let UDP packets of " + std::to_string(wire::kFrameBytesMax + 28) + " bytes through both ways?";
  }

  [[nodiscard]] std::string words_of_addresses() const {
    if (net::is_numeric(net::parse_peer(server_.name))) return server_.name;
    std::string words = server_.name + " (at ";
    for (const net::Address& address : addresses_) {
      words += (&address == addresses_.data() ? "" : ", ") + net::to_string(address);
    }
    return words + ")";
  }

  const ExaminedServer& server_;
  DoctorSession::Settings settings_;
  const time::Clock& clock_;
  const Nanoseconds end_;
  std::vector<net::Address> addresses_;
  std::size_t tried_ = 0;
  Nanoseconds next_{0};
  std::vector<std::unique_ptr<DoctorLine>> lines_;
  std::string problem_;
};

}  // namespace

DoctorLine::DoctorLine(const ExaminedServer& server, const DoctorSession::Settings& settings, const time::Clock& clock)
    : address(settings.server),
      link(net::UdpLink::towards(address)),
      encryption(server.identity.any()
                     ? std::make_unique<client::Encryption>(server.identity, server.name, link, address, clock)
                     : nullptr),
      session(settings, encryption ? static_cast<net::DatagramLink&>(encryption->link()) : link, clock) {}

void wait_for_datagrams(const net::UdpLink& link, Nanoseconds duration) {
  const int descriptor = link.descriptor();
  net::wait_readable(std::span(&descriptor, 1), duration);
}

bool introduce(DoctorLine& line, const time::Clock& clock) {
  for (const Nanoseconds end = clock.now() + kHandshakePatience; clock.now() < end;) {
    line.session.keep_connected();
    if (line.session.connected()) return true;
    if (is_refused(line) || is_unreachable(line)) return false;
    wait_for_datagrams(line.link, kReadWait);
  }
  return false;
}

std::unique_ptr<DoctorLine> first_to_answer(const ExaminedServer& server, const DoctorSession::Settings& settings,
                                            const time::Clock& clock) {
  return Search(server, settings, clock).run();
}

std::string in_words(const ExaminedServer& server, const net::Address& found) {
  if (net::is_numeric(net::parse_peer(server.name))) return server.name;
  return server.name + " (at " + net::to_string(found) + ")";
}

}  // namespace forcebound::client::commands
