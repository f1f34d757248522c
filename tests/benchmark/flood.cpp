// Hostile datagrams at a rate, against a server on this machine: what deploy/attacks measures a real client beside.
//
//   flood KIND HOST:PORT RATE SECONDS [ADDRESSES [SERVER-KEY KEY...]]
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
// and of those who have a KEY, or have recorded who has:
//
//   bursts    handshake requests as the key's client makes them, with a good cookie: RATE at once, each second
//   replays   150 such requests, recorded before the server was restarted, again and again with a good cookie
//   greedy    sessions, as many as the server gives, with a motion each now and then
//
// They come from ADDRESSES of 127.0.0.0/16, 32 if not given. Says "ready" on stderr when all is prepared, and begins
// when it is sent a line. Prints what was sent and what came back, as JSON.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <exception>
#include <optional>
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
#include "forcebound/security/handshake_datagram.hpp"
#include "forcebound/time/steady_clock.hpp"
#include "forcebound/wire/codec.hpp"
#include "tests/benchmark/flood_keys.hpp"

namespace {

using namespace forcebound;
using Bytes = std::vector<std::byte>;

constexpr std::size_t kAddressesPerNetwork = 250;

/// One of the addresses from which datagrams come.
struct Source {
  explicit Source(std::size_t number)
      : link(net::UdpLink::listen(net::resolve({"127.0." + std::to_string(number / kAddressesPerNetwork) + "." +
                                                    std::to_string(2 + number % kAddressesPerNetwork),
                                                0}))),
        batch(link) {}

  net::UdpLink link;
  net::UdpBatch batch;
  security::Cookie cookie{};
  std::vector<std::uint64_t> sessions;
  std::size_t next_session = 0;
  BegunHandshake* sealed_by = nullptr;  ///< null: no session of keys
};

struct Totals {
  std::uint64_t sent = 0;
  std::uint64_t sent_bytes = 0;
  std::uint64_t answers = 0;
  std::uint64_t answer_bytes = 0;
  std::uint64_t sessions = 0;
};

/// What is sent, and how.
struct Attack {
  std::string kind;
  double rate = 0;  ///< datagrams a second
  double seconds = 0;
  std::size_t addresses = 32;
  std::optional<KeyHolders> keys{};

  [[nodiscard]] bool in_bursts() const { return kind == "bursts"; }
  [[nodiscard]] std::uint64_t all() const { return static_cast<std::uint64_t>(rate * seconds); }
  [[nodiscard]] std::uint64_t due(double elapsed_s) const {
    const double units = in_bursts() ? std::floor(elapsed_s) + 1 : elapsed_s;
    return std::min(all(), static_cast<std::uint64_t>(rate * units));
  }
};

constexpr std::size_t kRecorded = 150;
constexpr int kAsksMost = 40;

class Flood {
 public:
  Flood(Attack attack, const std::string& server)
      : attack_(std::move(attack)), server_(net::resolve(net::parse_peer(server))) {
    for (std::size_t i = 0; i < attack_.addresses; ++i) sources_.emplace_back(i);
    if (attack_.in_bursts()) attack_.keys.value().begin(attack_.all(), KeyHolders::Until::request, random_);
    if (attack_.kind == "replays") attack_.keys.value().begin(kRecorded, KeyHolders::Until::request, random_);
    if (attack_.kind == "greedy") attack_.keys.value().begin(1, KeyHolders::Until::session, random_);
  }

  void run() {
    if (attack_.keys || attack_.kind == "shaken") get_cookies();
    if (attack_.kind == "greedy") shake_hands();
    std::fputs("ready\n", stderr);
    (void)std::getchar();
    const time::Nanoseconds begin = clock_.now();
    while (totals_.sent < attack_.all()) {
      const double elapsed_s = time::to_seconds(clock_.now() - begin);
      if (elapsed_s > 2 * attack_.seconds) break;  // this machine cannot send so many
      for (const std::uint64_t due = attack_.due(elapsed_s); totals_.sent < due; ++totals_.sent) {
        Source& source = sources_[totals_.sent % sources_.size()];
        const auto datagram = next(source);
        totals_.sent_bytes += datagram.size();
        source.batch.send(datagram, server_);
      }
      exchange(std::chrono::microseconds(500));
    }
    exchange(std::chrono::milliseconds(100));
  }

  void print() const {
    std::printf(
        "{\"kind\":\"%s\",\"sent\":%llu,\"sent_bytes\":%llu,\"answers\":%llu,\"answer_bytes\":%llu,\"sessions\":%llu}"
        "\n",
        attack_.kind.c_str(), static_cast<unsigned long long>(totals_.sent),
        static_cast<unsigned long long>(totals_.sent_bytes), static_cast<unsigned long long>(totals_.answers),
        static_cast<unsigned long long>(totals_.answer_bytes), static_cast<unsigned long long>(totals_.sessions));
  }

 private:
  /// Sends what waits, and takes in what comes meanwhile.
  void exchange(std::chrono::microseconds pause) {
    for (Source& source : sources_) source.batch.flush();
    std::this_thread::sleep_for(pause);
    for (Source& source : sources_) receive(source);
  }

  void get_cookies() {
    const auto lacks_one = [](const Source& source) { return source.cookie == security::Cookie{}; };
    // A server in the clear has none to give.
    for (int i = 0; i < kAsksMost && std::ranges::any_of(sources_, lacks_one); ++i) {
      for (Source& source : sources_) {
        if (lacks_one(source)) source.batch.send(request({}), server_);
      }
      exchange(std::chrono::milliseconds(50));
    }
  }

  void shake_hands() {
    while (sources_[0].sealed_by == nullptr) {
      sources_[0].batch.send(whole_request(0, sources_[0].cookie), server_);
      exchange(std::chrono::milliseconds(50));
    }
  }

  std::span<const std::byte> next(Source& source) {
    const std::string& kind = attack_.kind;
    if (attack_.in_bursts() || kind == "replays") return whole_request(totals_.sent, source.cookie);
    if (kind == "greedy") return sources_[0].sealed_by->seal(hello_or_motion(sources_[0]), clock_.now());
    if (kind == "hellos") return hello();
    if (kind == "fill") return hello_or_motion(source);
    if (kind == "asked") return request({});
    if (kind == "shaken") return request(source.cookie);
    if (kind == "motions") return motion(random_(), ++number_);
    if (kind == "ahead") return motion(random_(), std::uint64_t{1} << 63U);
    by_chance(100);
    if (kind == "sealed") {
      bytes_[0] = std::byte{'F'};
      bytes_[1] = std::byte{'S'};
      bytes_[2] = std::byte{1};
    }
    return bytes_;
  }

  std::span<const std::byte> hello_or_motion(Source& source) {
    if (source.sessions.empty() || random_() % 8 == 0) return hello();
    return motion(source.sessions[source.next_session++ % source.sessions.size()], ++number_);
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

  std::span<const std::byte> whole_request(std::size_t number, const security::Cookie& cookie) {
    bytes_.assign(security::kRequestBytes, std::byte{0});
    const BegunHandshake& begun = (*attack_.keys)[number];
    attack_.kind == "replays" ? begun.write_recorded(cookie, bytes_) : begun.write_request(cookie, bytes_);
    return bytes_;
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
        receive(source, datagram.bytes);
      }
    }
  }

  void receive(Source& source, std::span<const std::byte> datagram) {
    const auto read = security::read_handshake(datagram);
    if (const auto* offer = std::get_if<security::CookieOffer>(&read)) source.cookie = offer->cookie;
    const bool greedy = attack_.kind == "greedy";
    const auto* const answer = std::get_if<security::HandshakeAnswer>(&read);
    if (greedy && answer != nullptr && (*attack_.keys)[0].accept_answer(*answer, clock_.now())) {
      source.sealed_by = &(*attack_.keys)[0];
    }
    if (attack_.kind != "fill" && source.sealed_by == nullptr) return;
    const auto decoded = codec_.decode(greedy ? source.sealed_by->open(datagram, clock_.now()) : datagram);
    const auto* message = std::get_if<wire::Message>(&decoded);
    const auto* welcome = message != nullptr ? std::get_if<wire::Welcome>(message) : nullptr;
    if (welcome == nullptr) return;
    source.sessions.push_back(welcome->session);
    ++totals_.sessions;
  }

  Attack attack_;
  const time::SteadyClock clock_;
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
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() < 4) {
    std::fputs("flood KIND HOST:PORT RATE SECONDS [ADDRESSES [SERVER-KEY KEY...]]\n", stderr);
    return 2;
  }
  try {
    Attack attack{.kind = words[0],
                  .rate = std::strtod(words[2].c_str(), nullptr),
                  .seconds = std::strtod(words[3].c_str(), nullptr)};
    if (words.size() > 4) attack.addresses = std::stoul(words[4]);
    if (words.size() > 6) attack.keys.emplace(words[5], std::span(words).subspan(6));
    Flood flood(std::move(attack), words[1]);
    flood.run();
    flood.print();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "flood: %s\n", error.what());
    return 1;
  }
  return 0;
}
