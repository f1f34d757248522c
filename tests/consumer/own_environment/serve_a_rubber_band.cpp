// A consumer's own environment: one class and one line that adds it. Sessions, counting, limits and UDP come with the
// server.
#include <forcebound/server/runtime/udp_server.hpp>

#include <cmath>
#include <cstdio>
#include <exception>
#include <memory>
#include <optional>
#include <thread>

#include "../motion_client.hpp"

namespace server = forcebound::server;
using forcebound::control::Vector;

namespace {

/// Pulls back to where the device was first, until it tears.
class RubberBand final : public server::Environment {
 public:
  [[nodiscard]] server::Answer respond(const server::Motion& motion) noexcept override {
    if (!fixed_at_) fixed_at_ = motion.position;
    const Vector force_N = kStiffness_N_per_m * (*fixed_at_ - motion.position);
    torn_ = torn_ || force_N.norm() > kTorn_N;
    server::Answer answer{.force = torn_ ? Vector::Zero(force_N.rows()) : force_N};
    // A client that renders locally feels the band at its own rate between answers, as far as it cannot tear.
    answer.model.has_field = motion.wants_model && !torn_ && force_N.norm() < kTorn_N;
    if (answer.model.has_field) {
      answer.model.by_device_clock = true;
      answer.model.field.force_N.x() = force_N[0];
      answer.model.field.place_m.x() = motion.position[0];
      answer.model.field.jacobian_N_per_m(0, 0) = -kStiffness_N_per_m;
      answer.model.field.radius_m = (kTorn_N - force_N.norm()) / kStiffness_N_per_m;
    }
    return answer;
  }

 private:
  static constexpr double kStiffness_N_per_m = 300;
  static constexpr double kTorn_N = 5;

  std::optional<Vector> fixed_at_;
  bool torn_ = false;
};

server::EnvironmentKind rubber_band() {
  return {.name = "rubber band", .degrees_of_freedom = {1}, .make = [](const server::ClientFacts&) {
            return server::MadeEnvironment{std::make_unique<RubberBand>(), "a rubber band of 300 N/m, torn by 5 N"};
          }};
}

double force_N(MotionClient& client, double x_m) {
  const double force = client.force_at(Vector::Constant(1, x_m))[0];
  std::printf("at x = %5.1f mm: %5.2f N\n", 1e3 * x_m, force);
  return force;
}

bool is(double force_N, double expected_N) { return std::abs(force_N - expected_N) < 1e-9; }

/// Two hands at rubber bands of their own.
bool felt(const forcebound::net::Address& address) {
  MotionClient one(address, 1);
  MotionClient other(address, 1);
  const bool holds = is(force_N(one, 0.0), 0) && is(force_N(one, 0.010), -3);
  const bool is_its_own = is(force_N(other, 0.010), 0) && is(force_N(other, 0.0), 3);
  const bool tears = is(force_N(one, 0.020), 0) && is(force_N(one, 0.010), 0) && is(force_N(other, 0.0), 3);
  return holds && is_its_own && tears;
}

}  // namespace

int main() try {
  server::EnvironmentLibrary environments;
  environments.add(rubber_band());
  server::UdpServer udp(server::listen({"127.0.0.1", 0}), {.scene = "rubber band"}, environments);
  const auto address = udp.address();
  const std::jthread thread([&](const std::stop_token& stop) { udp.run(stop); });
  return felt(address) ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "serve_a_rubber_band: %s\n", error.what());
  return 1;
}
