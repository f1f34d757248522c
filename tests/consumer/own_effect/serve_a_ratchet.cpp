// A server whose scenes may ask for an effect that Forcebound does not have, and a client that feels it by UDP.
#include <forcebound/net/endpoint.hpp>
#include <forcebound/net/udp_link.hpp>
#include <forcebound/server/session/server.hpp>
#include <forcebound/time/steady_clock.hpp>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <random>
#include <stdexcept>
#include <utility>

#include "ratchet.hpp"

namespace {

namespace net = forcebound::net;
namespace scene = forcebound::scene;
namespace server = forcebound::server;
namespace wire = forcebound::wire;

/// A server on a free port of this machine, and a client:
///
///     client --UDP--> server, in one thread
class Exchange {
 public:
  explicit Exchange(server::SceneLibrary scenes)
      : server_({.scene = "ratchet"}, std::move(scenes), server_link_, clock_, unguessable) {}

  /// The server's answer, which has to be an `Answer`; texts in it are valid until the next question.
  template <class Answer>
  Answer ask(const wire::Message& question) {
    client_link_.send(codec_.encode(question), server_link_.local_address());
    const auto asked = receive(server_link_);
    server_.on_datagram(asked.datagram(), asked.from, clock_.now());
    answer_ = receive(client_link_);
    return std::get<Answer>(std::get<wire::Message>(codec_.decode(answer_.datagram())));
  }

 private:
  struct Datagram {
    std::array<std::byte, net::kDatagramBytesMax> buffer{};
    std::size_t bytes = 0;
    net::Address from{};
    std::span<const std::byte> datagram() const { return std::span(buffer).first(bytes); }
  };

  static std::uint64_t unguessable() {
    std::random_device device;
    return std::uint64_t{device()} << 32U | device();
  }

  static Datagram receive(net::UdpLink& link) {
    Datagram got;
    net::wait_readable(std::array{link.descriptor()}, std::chrono::seconds(5));
    const auto received = link.receive(got.buffer);
    if (!received) throw std::runtime_error("nothing came in 5 s");
    got.bytes = received->bytes;
    got.from = received->from;
    return got;
  }

  forcebound::time::SteadyClock clock_;
  net::UdpLink server_link_ = net::UdpLink::listen(net::resolve({"127.0.0.1", 0}));
  net::UdpLink client_link_ = net::UdpLink::towards(server_link_.local_address());
  server::Server server_;
  wire::Codec codec_;
  Datagram answer_;
};

/// Goes 10 mm forth along x and 4 mm back: the ratchet holds with 300 N/m * 4 mm, and the weight is 2 N.
bool felt(Exchange& exchange) {
  const auto welcome = exchange.ask<wire::Welcome>(
      wire::Hello{.client_nonce = 1, .degrees_of_freedom = 3, .device = "hand", .period_s = 1e-3});
  std::printf("%.*s\n", static_cast<int>(welcome.simulated.size()), welcome.simulated.data());
  wire::MotionSample motion{.session = welcome.session};
  wire::EnvironmentForce force;
  for (const double x_m : {0.0, 0.010, 0.006}) {
    ++motion.sequence;
    motion.device_time += std::chrono::milliseconds(1);
    motion.position = forcebound::control::Vector::Zero(3);
    motion.position[0] = x_m;
    force = exchange.ask<wire::EnvironmentForce>(motion);
    std::printf("at x = %4.1f mm: %.2f N along x, %.2f N along z\n", 1e3 * x_m, force.force[0], force.force[2]);
  }
  return std::abs(force.force[0] - 1.2) < 1e-9 && std::abs(force.force[2] + 2) < 1e-9;
}

}  // namespace

int main() try {
  scene::EffectRegistry registry = scene::EffectRegistry::standard();
  registry.add(ratchet_effect());
  server::SceneLibrary scenes;
  scenes.add(server::load_scene(SCENE_FILE, registry));
  Exchange exchange(std::move(scenes));
  return felt(exchange) ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "serve_a_ratchet: %s\n", error.what());
  return 1;
}
