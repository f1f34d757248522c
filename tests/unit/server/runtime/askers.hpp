#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <variant>

#include "forcebound/net/udp_link.hpp"
#include "forcebound/time/steady_clock.hpp"
#include "forcebound/wire/codec.hpp"
#include "tests/support/vector_of.hpp"
#include "tests/unit/server/security/client_end.hpp"

namespace forcebound::server {

/// The other end of a server by UDP, a plain client.
class Asker {
 public:
  explicit Asker(const net::Address& server) : link_(net::UdpLink::towards(server)), server_(server) {}

  void send(const wire::Message& question) { link_.send(codec_.encode(question), server_); }

  template <class Answer>
  Answer ask(const wire::Message& question) {
    send(question);
    return receive<Answer>();
  }

  template <class Answer>
  Answer receive() {
    return std::get<Answer>(receive_any());
  }

  wire::Message receive_any() { return std::get<wire::Message>(codec_.decode(receive_datagram())); }

  /// The next that is one, whatever comes before.
  template <class Answer>
  Answer await() {
    while (true) {
      const wire::Message answer = receive_any();
      if (const auto* const found = std::get_if<Answer>(&answer)) return *found;
    }
  }

  /// Its address changes.
  void move() { link_ = net::UdpLink::towards(server_); }

 private:
  std::span<const std::byte> receive_datagram() {
    net::wait_readable(std::array{link_.descriptor()}, std::chrono::seconds{10});
    const auto received = link_.receive(buffer_);
    if (!received) throw std::runtime_error("nothing came in 10 s");
    return std::span(buffer_).first(received->bytes);
  }

  net::UdpLink link_;
  net::Address server_;
  wire::Codec codec_;
  std::array<std::byte, net::kDatagramBytesMax> buffer_{};
};

/// The same, but encrypts: as the client of key 1, of a server of key 2.
class SecureAsker {
 public:
  explicit SecureAsker(const net::Address& server, std::uint32_t number = 7)
      : link_(net::UdpLink::towards(server)), server_(server), end_({.own = &own_, .server = &server_key_}, number) {
    link_.send(end_.request(), server_);
    EXPECT_TRUE(end_.accept_offer(receive_datagram()).has_value());
    link_.send(end_.request(), server_);
    EXPECT_TRUE(end_.accept_answer(receive_datagram(), clock_.now()).has_value());
  }

  void send(const wire::Message& question) { link_.send(end_.seal(codec_.encode(question), clock_.now()), server_); }

  template <class Answer>
  Answer ask(const wire::Message& question) {
    send(question);
    return receive<Answer>();
  }

  template <class Answer>
  Answer receive() {
    return std::get<Answer>(receive_any());
  }

  wire::Message receive_any() {
    content_ = end_.open(receive_datagram(), clock_.now()).value();
    return std::get<wire::Message>(codec_.decode(content_));
  }

  template <class Answer>
  Answer await() {
    while (true) {
      const wire::Message answer = receive_any();
      if (const auto* const found = std::get_if<Answer>(&answer)) return *found;
    }
  }

  void move() { link_ = net::UdpLink::towards(server_); }

 private:
  std::span<const std::byte> receive_datagram() {
    net::wait_readable(std::array{link_.descriptor()}, std::chrono::seconds{10});
    const auto received = link_.receive(buffer_);
    if (!received) throw std::runtime_error("nothing came in 10 s");
    return std::span(buffer_).first(received->bytes);
  }

  time::SteadyClock clock_;
  net::UdpLink link_;
  net::Address server_;
  security::KeyPair own_ = security::key_pair_from(security::key_bytes(1));
  security::PublicKey server_key_ = security::public_key(2);
  ClientEnd end_;
  wire::Codec codec_;
  Bytes content_;
  std::array<std::byte, net::kDatagramBytesMax> buffer_{};
};

inline wire::Hello hello_of(std::uint64_t nonce, std::string_view scene = {}) {
  return {.client_nonce = nonce, .degrees_of_freedom = 1, .period_s = 1e-3, .scene = scene};
}

inline wire::MotionSample motion_of(std::uint64_t session, std::uint64_t sequence) {
  return {.session = session, .sequence = sequence, .position = test::vector_of({0.02})};
}

}  // namespace forcebound::server
