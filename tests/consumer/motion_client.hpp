#pragma once

#include <forcebound/net/udp_link.hpp>
#include <forcebound/wire/codec.hpp>

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <span>
#include <stdexcept>
#include <variant>

/// A client without a device: sends positions by UDP, and waits for the forces.
class MotionClient {
  using Vector = forcebound::control::Vector;

 public:
  MotionClient(const forcebound::net::Address& server, std::uint32_t degrees_of_freedom)
      : link_(forcebound::net::UdpLink::towards(server)), server_(server) {
    const auto welcome = exchange<forcebound::wire::Welcome>(
        forcebound::wire::Hello{.client_nonce = std::uint64_t{link_.local_address().port} + 1,
                                .degrees_of_freedom = degrees_of_freedom,
                                .device = "hand",
                                .period_s = 1e-3});
    std::printf("%.*s\n", static_cast<int>(welcome.simulated.size()), welcome.simulated.data());
    motion_.session = welcome.session;
  }

  Vector force_at(const Vector& position_m) {
    ++motion_.sequence;
    motion_.device_time += std::chrono::milliseconds(1);
    motion_.position = position_m;
    return exchange<forcebound::wire::EnvironmentForce>(motion_).answer.force;
  }

 private:
  /// The answer to a message; texts in it are valid until the next call.
  template <class Answer>
  Answer exchange(const forcebound::wire::Message& message) {
    link_.send(codec_.encode(message), server_);
    forcebound::net::wait_readable(std::array{link_.descriptor()}, std::chrono::seconds(5));
    const auto received = link_.receive(buffer_);
    if (!received) throw std::runtime_error("nothing came in 5 s");
    return std::get<Answer>(
        std::get<forcebound::wire::Message>(codec_.decode(std::span(buffer_).first(received->bytes))));
  }

  forcebound::net::UdpLink link_;
  forcebound::net::Address server_;
  forcebound::wire::Codec codec_;
  forcebound::wire::MotionSample motion_;
  std::array<std::byte, forcebound::net::kDatagramBytesMax> buffer_{};
};
