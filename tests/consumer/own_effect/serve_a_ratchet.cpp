// A server whose scenes may use an effect that Forcebound does not have, and a client that uses it by UDP.
#include <forcebound/server/environment/scene_library.hpp>
#include <forcebound/server/runtime/udp_server.hpp>

#include <cmath>
#include <cstdio>
#include <exception>
#include <thread>

#include "../motion_client.hpp"
#include "ratchet.hpp"

namespace scene = forcebound::scene;
namespace server = forcebound::server;
using forcebound::control::Vector;

namespace {

/// Goes 10 mm forth along x and 4 mm back: the ratchet holds with 300 N/m * 4 mm, and the weight is 2 N.
bool felt(const forcebound::net::Address& address) {
  MotionClient client(address, 3);
  Vector force;
  for (const double x_m : {0.0, 0.010, 0.006}) {
    Vector position = Vector::Zero(3);
    position[0] = x_m;
    force = client.force_at(position);
    std::printf("at x = %4.1f mm: %.2f N along x, %.2f N along z\n", 1e3 * x_m, force[0], force[2]);
  }
  return std::abs(force[0] - 1.2) < 1e-9 && std::abs(force[2] + 2) < 1e-9;
}

}  // namespace

int main() try {
  scene::Registry registry = scene::Registry::standard();
  registry.add(ratchet_effect());
  server::SceneLibrary scenes;
  scenes.add(server::load_scene(SCENE_FILE, registry));
  server::UdpServer udp(server::listen({"127.0.0.1", 0}), {.scene = "ratchet"}, scenes);
  const auto address = udp.address();
  const std::jthread thread([&](const std::stop_token& stop) { udp.run(stop); });
  return felt(address) ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "serve_a_ratchet: %s\n", error.what());
  return 1;
}
