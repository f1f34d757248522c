#include "forcebound/client/page/relay_control.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <span>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "forcebound/net/endpoint.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::client {
namespace {

// Where nobody is there that is known at once.
constexpr int kAskedMost = 8;
constexpr std::chrono::milliseconds kAskAgain{125};

/// "50ms", "1s", "500us": in ms. Nothing: it is no time.
std::optional<double> milliseconds(std::string_view word) {
  struct Unit {
    std::string_view ending;
    double ms;
  };
  constexpr std::array<Unit, 3> kUnits{{{"ms", 1.0}, {"us", 1e-3}, {"s", 1e3}}};
  for (const auto& [ending, ms] : kUnits) {
    if (!word.ends_with(ending)) continue;
    const auto number = text::finite_number(word.substr(0, word.size() - ending.size()));
    if (number) return *number * ms;
  }
  return std::nullopt;
}

}  // namespace

std::string words_of_network(const page::Network& network) {
  constexpr std::string_view kBoth = "both ";
  const std::string line = relay_line(network);
  return line.size() > kBoth.size() ? line.substr(kBoth.size()) : "perfect";
}

std::string relay_line(const page::Network& network) {
  std::string line = "both";
  if (network.delay_ms > 0 || network.jitter_ms > 0) {
    line += " delay " + text::to_text(network.delay_ms) + "ms";
    if (network.jitter_ms > 0) line += " " + text::to_text(network.jitter_ms) + "ms";
  }
  if (network.loss_percent > 0) line += " loss " + text::to_text(network.loss_percent) + "%";
  return line;
}

std::optional<page::Network> network_of(std::string_view answer) {
  constexpr std::string_view kUp = "up: ";
  if (!answer.starts_with(kUp)) return std::nullopt;
  std::istringstream words{std::string(answer.substr(kUp.size(), answer.find(';') - kUp.size()))};
  page::Network network;
  std::string word;
  std::string before;
  while (words >> word) {
    if (before == "delay") {
      network.delay_ms = milliseconds(word).value_or(0);
      before = "delayed";
      continue;
    }
    if (before == "delayed") {
      if (const auto jitter = milliseconds(word)) network.jitter_ms = *jitter;
    }
    if (before == "loss" && word.ends_with('%')) {
      network.loss_percent = text::finite_number(word.substr(0, word.size() - 1)).value_or(0);
    }
    before = word;
  }
  return network;
}

RelayControl::RelayControl(const std::string& address, const time::Clock& clock, net::Resolver resolver)
    : lookup_(net::parse_peer(address), std::move(resolver)), link_(lookup_, clock, net::PeerLink::Found::by_answer) {}

page::Network RelayControl::network() { return ask("status"); }
page::Network RelayControl::set(const page::Network& network) { return ask(relay_line(network)); }

page::Network RelayControl::ask(const std::string& line) {
  constexpr std::size_t kLongest = 2048;
  std::array<std::byte, kLongest> buffer{};
  while (link_.receive(buffer)) {
    // An answer that came too late for the question before.
  }
  const std::array descriptors{link_.descriptor()};
  std::optional<net::Received> received;
  for (int asked = 0; asked < kAskedMost && !received; ++asked, received = link_.receive(buffer)) {
    (void)link_.send(std::as_bytes(std::span(line)), net::PeerLink::kPeer);
    net::wait_readable(descriptors, kAskAgain);
  }
  if (!received) {
    throw std::runtime_error("no answer from a relay at " + lookup_.in_words() +
                             ", which needs forcebound-relay --control");
  }
  const auto bytes = std::span(buffer).first(std::min(received->bytes, buffer.size()));
  const std::string answer(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const auto network = network_of(answer);
  if (!network) throw std::runtime_error("the relay at " + lookup_.in_words() + " says: " + text::printable(answer));
  return *network;
}

}  // namespace forcebound::client
