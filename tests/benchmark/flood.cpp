// Hostile datagrams at a rate, against a server on this machine: what deploy/attacks measures a real client beside.
//
//   flood KIND HOST:PORT RATE SECONDS
//
//   hellos    requests for sessions in the clear, another nonce in each
//   fill      the same, and motions for every session that is opened: takes all places
//   asked     handshake requests without a cookie
//   shaken    handshake requests with a good cookie, and a message that is not authentic
//   sealed    datagrams that look sealed, of sessions by chance
//   motions   motions of sessions by chance
//   ahead     motions of sessions by chance, numbered 2^63
//   bytes     bytes by chance
//
// They come from 32 addresses, 127.0.0.2 to 127.0.0.33. Prints what was sent and what came back, as JSON.
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <exception>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <variant>
#include <vector>

#include "forcebound/net/endpoint.hpp"
#include "forcebound/net/udp_batch.hpp"
#include "forcebound/net/udp_link.hpp"
#include "forcebound/security/channel.hpp"
#include "forcebound/security/handshake_datagram.hpp"
#include "forcebound/time/steady_clock.hpp"
#include "forcebound/wire/codec.hpp"

namespace {

using namespace forcebound;
using Bytes = std::vector<std::byte>;

constexpr std::size_t kAddresses = 32;

/// One of the addresses from which datagrams come.
struct Source {
  explicit Source(std::size_t number)
      : link(net::UdpLink::listen(net::resolve({"127.0.0." + std::to_string(2 + number), 0}))), batch(link) {}

  net::UdpLink link;
  net::UdpBatch batch;
  security::Cookie cookie{};
  std::vector<std::uint64_t> sessions;
  std::size_t next_session = 0;
};

struct Totals {
  std::uint64_t sent = 0;
  std::uint64_t sent_bytes = 0;
  std::uint64_t answers = 0;
  std::uint64_t answer_bytes = 0;
  std::uint64_t sessions = 0;
};

class Flood {
 public:
  Flood(std::string kind, const std::string& server)
      : kind_(std::move(kind)), server_(net::resolve(net::parse_peer(server))) {
    for (std::size_t i = 0; i < kAddresses; ++i) sources_.emplace_back(i);
  }

  void run(double rate, double seconds) {
    const time::SteadyClock clock;
    const time::Nanoseconds begin = clock.now();
    const auto all = static_cast<std::uint64_t>(rate * seconds);
    while (totals_.sent < all) {
      const double elapsed_s = time::to_seconds(clock.now() - begin);
      if (elapsed_s > 2 * seconds) break;  // this machine cannot send so many
      const auto due = static_cast<std::uint64_t>(rate * elapsed_s);
      for (; totals_.sent < std::min(due, all); ++totals_.sent) {
        Source& source = sources_[totals_.sent % kAddresses];
        const auto datagram = next(source);
        totals_.sent_bytes += datagram.size();
        source.batch.send(datagram, server_);
      }
      for (Source& source : sources_) {
        source.batch.flush();
        receive(source);
      }
      std::this_thread::sleep_for(std::chrono::microseconds(500));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    for (Source& source : sources_) receive(source);
  }

  void print() const {
    std::printf(
        "{\"kind\":\"%s\",\"sent\":%llu,\"sent_bytes\":%llu,\"answers\":%llu,\"answer_bytes\":%llu,\"sessions\":%llu}"
        "\n",
        kind_.c_str(), static_cast<unsigned long long>(totals_.sent),
        static_cast<unsigned long long>(totals_.sent_bytes), static_cast<unsigned long long>(totals_.answers),
        static_cast<unsigned long long>(totals_.answer_bytes), static_cast<unsigned long long>(totals_.sessions));
  }

 private:
  std::span<const std::byte> next(Source& source) {
    if (kind_ == "hellos") return hello();
    if (kind_ == "fill") {
      if (source.sessions.empty() || random_() % 8 == 0) return hello();
      return motion(source.sessions[source.next_session++ % source.sessions.size()], ++number_);
    }
    if (kind_ == "asked") return request({});
    if (kind_ == "shaken") return request(source.cookie);
    if (kind_ == "motions") return motion(random_(), ++number_);
    if (kind_ == "ahead") return motion(random_(), std::uint64_t{1} << 63U);
    by_chance(100);
    if (kind_ == "sealed") {
      bytes_[0] = std::byte{'F'};
      bytes_[1] = std::byte{'S'};
      bytes_[2] = std::byte{1};
    }
    return bytes_;
  }

  void by_chance(std::size_t size) {
    bytes_.resize(size);
    for (std::byte& byte : bytes_) byte = static_cast<std::byte>(random_());
  }

  std::span<const std::byte> hello() {
    return codec_.encode(wire::Hello{
        .client_nonce = random_(), .degrees_of_freedom = 3, .device = "flood", .period_s = 1e-3, .force_N_max = 1});
  }

  std::span<const std::byte> motion(std::uint64_t session, std::uint64_t number) {
    return codec_.encode(wire::MotionSample{.session = session,
                                            .sequence = number,
                                            .device_time = time::Nanoseconds{static_cast<std::int64_t>(number)},
                                            .position = control::Vector::Zero(3)});
  }

  std::span<const std::byte> request(const security::Cookie& cookie) {
    by_chance(security::Handshake::overhead(security::Pattern::ik_psk2, 0));
    const Bytes message = bytes_;
    bytes_.assign(security::kRequestBytes, std::byte{0});
    security::write(
        security::HandshakeRequest{
            .topic = {.client = static_cast<std::uint32_t>(random_() | 1U)}, .cookie = cookie, .message = message},
        bytes_);
    return bytes_;
  }

  void receive(Source& source) {
    for (auto arrived = source.batch.receive_all(); !arrived.empty(); arrived = source.batch.receive_all()) {
      for (const auto& datagram : arrived) {
        ++totals_.answers;
        totals_.answer_bytes += datagram.bytes.size();
        const auto read = security::read_handshake(datagram.bytes);
        if (const auto* offer = std::get_if<security::CookieOffer>(&read)) source.cookie = offer->cookie;
        if (kind_ != "fill") continue;
        const auto decoded = codec_.decode(datagram.bytes);
        const auto* message = std::get_if<wire::Message>(&decoded);
        const auto* welcome = message != nullptr ? std::get_if<wire::Welcome>(message) : nullptr;
        if (welcome == nullptr) continue;
        source.sessions.push_back(welcome->session);
        ++totals_.sessions;
      }
    }
  }

  std::string kind_;
  net::Address server_;
  std::deque<Source> sources_;
  std::mt19937_64 random_{1};
  std::uint64_t number_ = 0;
  wire::Codec codec_;
  Bytes bytes_;
  Totals totals_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fputs("flood KIND HOST:PORT RATE SECONDS\n", stderr);
    return 2;
  }
  try {
    Flood flood(argv[1], argv[2]);
    flood.run(std::strtod(argv[3], nullptr), std::strtod(argv[4], nullptr));
    flood.print();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "flood: %s\n", error.what());
    return 1;
  }
  return 0;
}
