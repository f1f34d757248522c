#include <algorithm>
#include <cstring>
#include <deque>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "forcebound/client/security/handshaker.hpp"
#include "forcebound/client/security/secure_link.hpp"
#include "forcebound/server/security/secure_link.hpp"
#include "tests/fuzz/input.hpp"
#include "tests/support/fake_clock.hpp"
#include "tests/support/fake_link.hpp"
#include "tests/unit/security/handshakes.hpp"

namespace forcebound::fuzz {
namespace {

using time::Nanoseconds;

/// The same bytes in every run.
auto counted_up(std::uint64_t from) {
  return [from](std::span<std::byte> bytes) mutable {
    for (std::byte& byte : bytes) {
      from = from * 6364136223846793005ULL + 1442695040888963407ULL;
      byte = static_cast<std::byte>(from >> 56U);
    }
  };
}

client::Identity identity_of(bool with_key_pairs) {
  client::Identity identity{.server = "haptics:47800"};
  identity.pattern = with_key_pairs ? security::Pattern::ik_psk2 : security::Pattern::nn_psk0;
  if (with_key_pairs) {
    identity.own = security::key_pair_from(security::key_bytes(1));
    identity.server_key = security::public_key(2);
  }
  identity.shared = security::secret_key(3);
  return identity;
}

server::ServerKeys keys_of(bool with_key_pairs) {
  server::ServerKeys keys{.shared = security::secret_key(3)};
  if (with_key_pairs) keys.own = security::key_pair_from(security::key_bytes(2));
  return keys;
}

/// A client's link and a server's, and a network between them that does as the script says: it delivers in any order,
/// repeats, changes bits, delivers from elsewhere, and says things of its own.
///
///     client::SecureLink --> held --> server::SecureLink
class ScriptedNetwork {
 public:
  explicit ScriptedNetwork(Bytes bytes) : script_(bytes) {}

  void run() {
    for (int step = 0; step < kStepsMost && !script_.ended(); ++step) {
      run_step();
      must(server_.confirmed() <= limits_.confirmed_most(), "more sessions of keys than allowed");
      must(server_.unconfirmed() <= server::SecureLink::kUnconfirmedMost, "too many sessions that nobody confirmed");
    }
  }

 private:
  static constexpr int kStepsMost = 512;
  static constexpr std::size_t kHeldMost = 64;
  static constexpr net::Address kServer{.ip = {1}, .port = 1};

  struct Held {
    std::vector<std::byte> bytes;
    bool to_server = true;
    std::uint16_t port = 1;
  };

  void run_step() {
    switch (script_.byte() % 10) {
      case 0:
        client_tick();
        break;
      case 1:
        say_to_server();
        break;
      case 2:
        say_to_client();
        break;
      case 3:
        deliver(true, false);
        break;
      case 4:
        deliver(false, false);
        break;
      case 5:
        deliver(false, true);
        break;
      case 6: {
        const bool to_server = script_.byte() % 2 == 0;
        const Bytes noise = script_.take(script_.byte());
        arrive({.bytes = {noise.begin(), noise.end()}, .to_server = to_server, .port = port()}, false);
        break;
      }
      case 7:
        clock_.time += std::chrono::milliseconds{script_.value<std::uint16_t>()};
        server_.on_timer(clock_.time);
        break;
      case 8:
        make_room();
        break;
      default:
        join();
        break;
    }
  }

  std::uint16_t port() { return static_cast<std::uint16_t>(1 + script_.byte() % 4); }

  void client_tick() {
    clock_.time += std::chrono::milliseconds{1};
    client_.exchange();
    handshaker_.work(clock_.time);
    client_.exchange();
    hold_all(from_client_, true);
  }

  /// A network that for once does what it should: until both have keys.
  void join() {
    for (int tick = 0; tick < 16; ++tick) {
      client_tick();
      deliver_all();
    }
    say_to_server();
    deliver_all();
  }

  void deliver_all() {
    for (std::size_t left = held_.size(); left > 0; --left) deliver(true, false, 0);
  }

  static std::string content(char side, int number) { return side + std::to_string(number); }

  void say_to_server() {
    const std::string text = content('c', ++said_);
    if (!client_.ready()) return;
    if (client_.send(std::as_bytes(std::span(text)), kServer)) on_the_way_.insert(text);
    hold_all(from_client_, true);
  }

  void say_to_client() {
    const std::string text = content('s', ++said_);
    const net::Address to{.ip = {2}, .port = port()};
    if (server_.send(std::as_bytes(std::span(text)), to)) on_the_way_.insert(text);
    hold_all(from_server_, false);
  }

  void hold_all(test::FakeLink& link, bool to_server) {
    for (auto& datagram : link.sent) {
      must(datagram.bytes.size() <= net::kDatagramBytesMax, "a datagram longer than the protocol allows");
      if (to_server) must(datagram.peer == kServer, "the client sent to somebody else");
      held_.push_back({std::move(datagram.bytes), to_server, to_server ? std::uint16_t{1} : datagram.peer.port});
    }
    link.sent.clear();
    while (held_.size() > kHeldMost) held_.pop_front();
  }

  void make_room() {
    if (!held_.empty()) held_.erase(held_.begin() + script_.byte() % static_cast<int>(held_.size()));
  }

  void deliver(bool once, bool changed) { deliver(once, changed, script_.byte()); }

  void deliver(bool once, bool changed, std::size_t which) {
    if (held_.empty()) return;
    which %= held_.size();
    Held datagram = held_[which];
    if (once) {
      held_.erase(held_.begin() + static_cast<std::ptrdiff_t>(which));
    } else {
      datagram.port = port();
    }
    if (changed) {
      const std::size_t bit = script_.value<std::uint16_t>() % (8 * datagram.bytes.size());
      datagram.bytes[bit / 8] ^= std::byte{1} << bit % 8;
    }
    arrive(std::move(datagram), changed);
  }

  void arrive(Held datagram, bool changed) {
    if (datagram.to_server) {
      const net::Address from{.ip = {2}, .port = datagram.port};
      const auto opened = server_.accept(datagram.bytes, from, clock_.time);
      while (server_.has_waiting()) server_.answer_waiting(clock_.time);
      if (opened) on_opened(opened->bytes, 'c', changed);
      std::size_t answered = 0;
      for (const auto& sent : from_server_.sent) {
        must(sent.peer == from, "an answer to somebody else");
        answered += sent.bytes.size();
      }
      must(answered <= datagram.bytes.size(), "an answer longer than its question");
      hold_all(from_server_, false);
      return;
    }
    std::array<std::byte, net::kDatagramBytesMax> buffer{};
    if (const auto length = client_.open(datagram.bytes, buffer)) {
      on_opened(std::span(buffer).first(*length), 's', changed);
    }
    must(from_client_.sent.empty(), "an answer of the client to what arrived");
  }

  void on_opened(Bytes bytes, char side, bool changed) {
    const std::string text(text_of(bytes));
    must(!changed, "a changed datagram was opened");
    must(on_the_way_.erase(text) == 1, "what was opened was never said, or was opened twice");
    must(text.front() == side, "an end opened what it said itself");
  }

  Script script_;
  bool with_key_pairs_ = script_.byte() % 2 == 0;
  test::FakeClock clock_;
  test::FakeLink from_client_;
  test::FakeLink from_server_;
  server::SecureLimits limits_{.sessions_max = 1};
  client::Handshaker handshaker_{identity_of(with_key_pairs_), counted_up(1)};
  client::SecureLink client_{from_client_, kServer, handshaker_, clock_};
  server::SecureLink server_{keys_of(with_key_pairs_), limits_, from_server_, clock_, counted_up(2)};
  std::deque<Held> held_;
  std::set<std::string> on_the_way_;
  int said_ = 0;
};

}  // namespace

void fuzz_encryption(Bytes bytes) { ScriptedNetwork(bytes).run(); }

}  // namespace forcebound::fuzz
