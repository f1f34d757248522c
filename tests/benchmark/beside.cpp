// Somebody beside the path between a client and a server, who sees each handshake request and has cookies of his own at
// the client 20 ms before the server's answer: what deploy/attacks measures a real client against.
//
//   beside HOST:PORT FORGED --listen HOST:PORT
//
// Passes datagrams on to the server at once, and back 20 ms later. For each request FORGED cookies go back at once, by
// chance, with the server's own key. Ends on SIGTERM, and prints how many were forged.
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <exception>
#include <map>
#include <random>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include "forcebound/net/endpoint.hpp"
#include "forcebound/net/udp_link.hpp"
#include "forcebound/security/handshake_datagram.hpp"
#include "forcebound/time/steady_clock.hpp"

namespace {

using namespace forcebound;
using namespace std::chrono_literals;

constexpr time::Nanoseconds kAhead = 20ms;

volatile std::sig_atomic_t ended = 0;

struct Waiting {
  time::Nanoseconds due;
  std::vector<std::byte> bytes;
};

/// A client, and what the server has said to it.
struct Flow {
  explicit Flow(const net::Address& server) : to_server(net::UdpLink::towards(server)) {}

  net::UdpLink to_server;
  security::CookieOffer offer{};  ///< the newest
  std::deque<Waiting> waiting{};
};

class Beside {
 public:
  Beside(const char* server, unsigned long forged, const char* listen)
      : server_(net::resolve(net::parse_peer(server))),
        forged_(forged),
        to_clients_(net::UdpLink::listen(net::resolve(net::parse_endpoint(listen)))) {}

  void run() {
    std::vector<int> descriptors;
    while (ended == 0) {
      descriptors.assign(1, to_clients_.descriptor());
      for (const auto& [client, flow] : flows_) descriptors.push_back(flow.to_server.descriptor());
      net::wait_readable(descriptors, 1ms);
      while (const auto received = to_clients_.receive(buffer_)) {
        Flow& flow = flows_.try_emplace(received->from, server_).first->second;
        pass_on(std::span(buffer_).first(received->bytes), received->from, flow);
      }
      for (auto& [client, flow] : flows_) pass_back(client, flow);
    }
    std::printf("{\"forged\":%llu}\n", static_cast<unsigned long long>(sent_));
  }

 private:
  void pass_on(std::span<const std::byte> datagram, const net::Address& client, Flow& flow) {
    flow.to_server.send(datagram, server_);
    const auto read = security::read_handshake(datagram);
    const auto* const request = std::get_if<security::HandshakeRequest>(&read);
    if (request == nullptr) return;
    std::array<std::byte, security::kCookieOfferBytes> bytes{};
    flow.offer.topic = request->topic;
    for (unsigned long i = 0; i < forged_; ++i, ++sent_) {
      for (std::byte& byte : flow.offer.cookie) byte = static_cast<std::byte>(random_());
      to_clients_.send(std::span(bytes).first(security::write(flow.offer, bytes)), client);
    }
  }

  void pass_back(const net::Address& client, Flow& flow) {
    const time::Nanoseconds now = clock_.now();
    while (const auto received = flow.to_server.receive(buffer_)) {
      const auto datagram = std::span(buffer_).first(received->bytes);
      const auto read = security::read_handshake(datagram);
      if (const auto* const offer = std::get_if<security::CookieOffer>(&read)) flow.offer = *offer;
      flow.waiting.push_back({.due = now + kAhead, .bytes = {datagram.begin(), datagram.end()}});
    }
    for (; !flow.waiting.empty() && flow.waiting.front().due <= now; flow.waiting.pop_front()) {
      to_clients_.send(flow.waiting.front().bytes, client);
    }
  }

  const time::SteadyClock clock_;
  net::Address server_;
  unsigned long forged_;
  net::UdpLink to_clients_;
  std::map<net::Address, Flow> flows_;
  std::mt19937 random_{1};
  std::uint64_t sent_ = 0;
  std::array<std::byte, net::kDatagramBytesMax> buffer_{};
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5 || std::string_view(argv[3]) != "--listen") {
    std::fputs("beside HOST:PORT FORGED --listen HOST:PORT\n", stderr);
    return 2;
  }
  std::signal(SIGTERM, [](int) { ended = 1; });
  try {
    Beside(argv[1], std::strtoul(argv[2], nullptr, 10), argv[4]).run();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "beside: %s\n", error.what());
    return 1;
  }
  return 0;
}
