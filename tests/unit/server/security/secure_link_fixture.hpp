#pragma once

#include <gmock/gmock.h>

#include <algorithm>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "forcebound/server/security/secure_link.hpp"
#include "tests/support/fake_clock.hpp"
#include "tests/support/fake_link.hpp"
#include "tests/unit/server/security/client_end.hpp"

namespace forcebound::server {

using namespace std::chrono_literals;

inline net::Address at_port(std::uint16_t port) {
  return {.ip = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff, 192, 0, 2, 1}, .port = port};
}

/// What is refused, in words.
class Refusals final : public ServerObserver {
 public:
  void on_refused(const net::Address&, std::string_view text) override { lines.emplace_back(text); }
  std::vector<std::string> lines;
};

/// One link, and ends of clients:
///
///     ClientEnd --arrive--> SecureLink --send--> FakeLink --> ClientEnd
///
/// No answer may be longer than its question, whatever the test.
class SecureLinkFixture : public testing::Test {
 protected:
  void start(ServerKeys keys, const SecureLimits& limits = {}) {
    link.emplace(
        std::move(keys), limits, inner, clock,
        [this](std::span<std::byte> bytes) {
          std::ranges::generate(bytes, [this] { return static_cast<std::byte>(random_() & 0xffU); });
        },
        &refusals);
  }

  /// With a list of one client, anna. @param more lines about her
  void start_with_list(const SecureLimits& limits = {}, const std::string& more = {}) {
    ServerKeys keys{.own = security::key_pair_from(security::key_bytes(2))};
    keys.clients = security::AllowedClients::parse(
        "[[client]]\nname = \"anna\"\npublic_key = \"" + security::public_text(1) + "\"\nscenes = [\"wall\"]\n" + more,
        "clients.toml");
    start(std::move(keys), limits);
  }

  /// With a list of two clients, anna and bert.
  void start_with_two(const SecureLimits& limits = {}) {
    start_with_list(limits, "[[client]]\nname = \"bert\"\npublic_key = \"" + security::public_text(4) + "\"\n");
  }

  void start_with_shared_key(const SecureLimits& limits = {}) {
    start(ServerKeys{.shared = security::secret_key(3)}, limits);
  }

  [[nodiscard]] ClientEnd anna_end(std::uint32_t number = 11) const {
    return {{.own = &anna, .server = &server}, number};
  }
  [[nodiscard]] ClientEnd shared_end(std::uint32_t number = 11) const { return {{.shared = &shared}, number}; }

  /// @return the content for the server, if there is any, and whose it is
  std::optional<std::pair<std::string, std::string>> arrive(std::span<const std::byte> datagram,
                                                            const net::Address& from = at_port(1)) {
    const std::size_t before = inner.sent.size();
    const auto content = link->accept(datagram, from, clock.time);
    while (link->has_waiting()) link->answer_waiting(clock.time);
    std::size_t answered = 0;
    for (std::size_t i = before; i < inner.sent.size(); ++i) {
      answered += inner.sent[i].bytes.size();
      EXPECT_EQ(inner.sent[i].peer, from);
    }
    EXPECT_LE(answered, datagram.size()) << "an answer longer than its question";
    if (!content) return std::nullopt;
    return std::pair(std::string(reinterpret_cast<const char*>(content->bytes.data()), content->bytes.size()),
                     content->client == nullptr ? std::string() : content->client->name);
  }

  /// What was sent since the last call.
  std::vector<test::FakeLink::Datagram> sent() { return std::exchange(inner.sent, {}); }

  Bytes only_answer() {
    const auto all = sent();
    EXPECT_EQ(all.size(), 1U);
    return all.empty() ? Bytes{} : all.front().bytes;
  }

  /// Until the client has a cookie.
  void get_cookie(ClientEnd& client, const net::Address& from = at_port(1)) {
    client.set_cookie({});
    EXPECT_FALSE(arrive(client.request(), from));
    EXPECT_TRUE(client.accept_offer(only_answer()).has_value());
  }

  /// Until the client has its answer.
  std::optional<security::Admission> shake_hands(ClientEnd& client, const net::Address& from = at_port(1)) {
    get_cookie(client, from);
    EXPECT_FALSE(arrive(client.request(), from));
    return client.accept_answer(only_answer(), clock.time);
  }

  /// Until the server knows that the client has the keys.
  void join(ClientEnd& client, const net::Address& from = at_port(1)) {
    const auto admission = shake_hands(client, from);
    ASSERT_TRUE(admission.has_value());
    ASSERT_EQ(admission->verdict, security::Verdict::let_in);
    ASSERT_TRUE(arrive(client.seal("hello", clock.time), from).has_value());
  }

  /// The content of what the client is sent at an address; empty: nothing that it can open.
  std::string received_by(ClientEnd& client, std::string_view content, const net::Address& to) {
    if (!link->send(bytes_of(content), to)) return "";
    const auto opened = client.open(only_answer(), clock.time);
    return opened ? std::string(reinterpret_cast<const char*>(opened->data()), opened->size()) : "";
  }

  [[nodiscard]] std::uint64_t records(security::Opening why) const { return link->counters().records[why]; }

  security::KeyPair anna = security::key_pair_from(security::key_bytes(1));
  security::KeyPair bert = security::key_pair_from(security::key_bytes(4));
  security::PublicKey server = security::public_key(2);
  security::SecretKey shared = security::secret_key(3);
  test::FakeLink inner;
  test::FakeClock clock;
  Refusals refusals;
  std::optional<SecureLink> link;

 private:
  std::mt19937_64 random_{20260101};
};

}  // namespace forcebound::server
