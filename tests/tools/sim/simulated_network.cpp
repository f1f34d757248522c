#include "tests/tools/sim/simulated_network.hpp"

#include <algorithm>

namespace forcebound::sim {
namespace {

// A socket's room for unread datagrams.
constexpr std::size_t kInboxMax = 4096;

constexpr std::uint16_t kServerPort = 47800;

netem::Impairment make_way(const SimulatedNetworkSettings& settings, Direction direction, Nanoseconds origin) {
  return netem::Impairment({.netem = direction == Direction::up ? settings.up : settings.down,
                            .trace = settings.trace,
                            .seed = netem::direction_seed(settings.seed, direction),
                            .origin = origin});
}

// 10.0.0.0 and up, as an IPv4 address.
Address numbered(std::uint32_t number, std::uint16_t port) {
  Address address{.ip = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff, 10}, .port = port};
  address.ip[13] = static_cast<std::uint8_t>(number >> 16U);
  address.ip[14] = static_cast<std::uint8_t>(number >> 8U);
  address.ip[15] = static_cast<std::uint8_t>(number);
  return address;
}

std::uint32_t number_of(const Address& address) {
  return std::uint32_t{address.ip[13]} << 16U | std::uint32_t{address.ip[14]} << 8U | address.ip[15];
}

}  // namespace

class SimulatedNetwork::ClientLink final : public net::DatagramLink {
 public:
  ClientLink(SimulatedNetwork& network, std::size_t client) : network_(network), client_(client) {}

  bool send(std::span<const std::byte> datagram, const Address& to) noexcept override {
    return to == network_.server_address() && network_.send(Direction::up, datagram, client_);
  }
  std::optional<net::Received> receive(std::span<std::byte> buffer) noexcept override {
    return network_.take(inbox, buffer);
  }
  Inbox inbox;

 private:
  SimulatedNetwork& network_;
  std::size_t client_;
};

class SimulatedNetwork::ServerLink final : public net::DatagramLink {
 public:
  explicit ServerLink(SimulatedNetwork& network) : network_(network) {}

  bool send(std::span<const std::byte> datagram, const Address& to) noexcept override {
    // Client 0 has number 1.
    const std::size_t client = std::size_t{number_of(to)} - 1;
    if (client >= network_.clients_.size() || network_.client_address(client) != to) return false;
    return network_.send(Direction::down, network_.tamper_ ? network_.tamper_(datagram, network_.now()) : datagram,
                         client);
  }
  std::optional<net::Received> receive(std::span<std::byte> buffer) noexcept override {
    return network_.take(inbox, buffer);
  }
  Inbox inbox;

 private:
  SimulatedNetwork& network_;
};

SimulatedNetwork::SimulatedNetwork(const time::Clock& clock, const SimulatedNetworkSettings& settings)
    : clock_(clock),
      ways_{make_way(settings, Direction::up, clock.now()), make_way(settings, Direction::down, clock.now())},
      server_(std::make_unique<ServerLink>(*this)) {}

SimulatedNetwork::~SimulatedNetwork() = default;

net::DatagramLink& SimulatedNetwork::add_client() {
  return *clients_.emplace_back(std::make_unique<ClientLink>(*this, clients_.size()));
}

Address SimulatedNetwork::client_address(std::size_t client) const noexcept {
  return numbered(static_cast<std::uint32_t>(client) + 1, 50000);
}

net::DatagramLink& SimulatedNetwork::server_link() noexcept { return *server_; }

Address SimulatedNetwork::server_address() const noexcept { return numbered(0, kServerPort); }

void SimulatedNetwork::set_server_handler(ServerHandler handler) { handler_ = std::move(handler); }

void SimulatedNetwork::detach_server() noexcept {
  server_attached_ = false;
  server_->inbox.clear();
}

void SimulatedNetwork::set_blackhole(Direction direction, bool on) noexcept {
  blackhole_[static_cast<std::size_t>(direction)] = on;
}

bool SimulatedNetwork::send(Direction direction, std::span<const std::byte> datagram, std::uint64_t client) {
  // An impairment's queue holds due packets until they are popped.
  if (!event_time_) deliver_due(clock_.now());
  counters_.bytes_sent[static_cast<std::size_t>(direction)] += datagram.size();
  if (blackhole_[static_cast<std::size_t>(direction)]) {
    ++counters_.blackholed;
    return true;
  }
  const netem::Verdicts verdicts = way(direction).push(now(), datagram, client);
  if (observer_) {
    for (const netem::Verdict& verdict : verdicts) observer_(direction, verdict);
  }
  return true;
}

void SimulatedNetwork::deliver_due(Nanoseconds until) {
  if (event_time_) return;  // called from within the handler: the loop below goes on with it
  for (std::optional<Nanoseconds> next = next_event(); next && *next <= until; next = next_event()) {
    event_time_ = next;
    // At equal times, up is first: its answer may be due at once as well.
    for (const Direction direction : {Direction::up, Direction::down}) {
      if (const auto departure = way(direction).pop(*next)) {
        deliver(direction, *departure);
        break;
      }
    }
  }
  event_time_.reset();
}

std::optional<Nanoseconds> SimulatedNetwork::next_event() const noexcept {
  const auto up = ways_[0].next_departure();
  const auto down = ways_[1].next_departure();
  if (!up || !down) return up ? up : down;
  return std::min(*up, *down);
}

void SimulatedNetwork::deliver(Direction direction, const netem::Departure& departure) {
  const auto client = static_cast<std::size_t>(departure.tag);
  if (direction == Direction::down) return put(clients_[client]->inbox, departure.bytes, server_address());
  if (!server_attached_) {
    ++counters_.server_detached;
  } else if (handler_) {
    handler_(departure.bytes, client_address(client), *event_time_);
  } else {
    put(server_->inbox, departure.bytes, client_address(client));
  }
}

void SimulatedNetwork::put(Inbox& inbox, std::span<const std::byte> bytes, const Address& from) {
  if (inbox.size() == kInboxMax) {
    ++counters_.inbox_full;
    return;
  }
  inbox.push_back({{bytes.begin(), bytes.end()}, from, now()});
}

std::optional<net::Received> SimulatedNetwork::take(Inbox& inbox, std::span<std::byte> buffer) {
  deliver_due(clock_.now());
  if (inbox.empty()) return std::nullopt;
  const Datagram& datagram = inbox.front();
  const net::Received received{datagram.bytes.size(), datagram.from, clock_.now() - datagram.arrival};
  std::copy_n(datagram.bytes.begin(), std::min(datagram.bytes.size(), buffer.size()), buffer.begin());
  inbox.pop_front();
  return received;
}

const netem::ImpairmentCounters& SimulatedNetwork::counters(Direction direction) const noexcept {
  return ways_[static_cast<std::size_t>(direction)].counters();
}

}  // namespace forcebound::sim
