#include <array>
#include <memory>
#include <optional>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/client/session/session.hpp"
#include "tests/fuzz/frame.hpp"
#include "tests/fuzz/input.hpp"
#include "tests/support/fake_clock.hpp"
#include "tests/support/fake_device.hpp"
#include "tests/support/fake_link.hpp"

namespace forcebound::fuzz {
namespace {

constexpr int kTicksMax = 512;
const net::Address kServerAddress{.ip = {1}, .port = 47800};

/// A client's session, and a server that does as the script says, knowing what the client sent last.
class ScriptedClient {
 public:
  ScriptedClient(Bytes bytes, std::string_view law, int dof)
      : script_(bytes),
        device_(dof),
        local_({.degrees_of_freedom = static_cast<std::uint32_t>(dof), .limits = small_limits()}),
        session_({.server = kServerAddress, .scene = "wall", .local = &local_}, device_,
                 baselines::shipped_laws().make(law, device_.facts()), link_, clock_, {.ticks = {}}) {}

  void run() {
    for (int step = 0; step < kTicksMax && !script_.ended(); ++step) {
      run_step();
      check();
    }
    for (int step = 0; step < 4; ++step) {
      advance(1000);
      (void)session_.close(clock_.time);
      check();
    }
    must((device_.applied.array() == 0).all(), "a force on the device after the session's end");
    (void)session_.totals();
  }

 private:
  static handover::Limits small_limits() {
    return {.triangles = 1000, .heights = 1000, .shape_bytes = 1U << 20U, .nodes_of_a_build = 100'000};
  }

  void run_step() {
    switch (script_.byte() % 12) {
      case 0:
        tick(1);
        break;
      case 1:
        tick(script_.byte());
        break;
      case 2:
        arrive(wire::Welcome{.client_nonce = nonce_,
                             .session = script_.byte(),
                             .scene_hash = script_.byte(),
                             .scene = "wall",
                             .offer = offer(),
                             .server_parts = static_cast<wire::ServerParts>(script_.byte() % 3)});
        break;
      case 3:
        arrive(force());
        break;
      case 4:
        arrive(wire::Refusal{.client_nonce = nonce_,
                             .session = script_.byte(),
                             .reason = static_cast<wire::RefusalReason>(script_.byte() % 8),
                             .text = "\x1b[31m",
                             .client_time = time::Nanoseconds{script_.value<std::int64_t>() >> 2}});
        break;
      case 5:
        arrive(wire::Bye{.session = script_.byte(), .motions_received = script_.value<std::uint64_t>()});
        break;
      case 6: {
        const std::uint64_t session = script_.byte();
        const std::uint64_t transmission = script_.byte();
        const std::uint32_t number = script_.byte();
        const Bytes content = script_.take(script_.byte());
        arrive(
            wire::ScenePiece{.session = session, .transmission = transmission, .number = number, .content = content});
        break;
      }
      case 7: {
        const std::uint8_t kind = script_.byte();
        link_.arrive(framed(kind, script_.take(script_.byte())), kServerAddress);
        break;
      }
      case 8:
        link_.arrive(script_.take(script_.value<std::uint16_t>() % net::kDatagramBytesMax), kServerAddress);
        break;
      case 9:
        for (double& place_m : device_.position) place_m = script_.value<std::int16_t>() * 1e-5;
        break;
      case 10:
        (void)local_.builder().work();
        break;
      default:
        advance(script_.value<std::uint16_t>());
        break;
    }
  }

  wire::SceneOffer offer() {
    const Bytes manifest = script_.take(script_.byte());
    if (manifest.empty()) return {};
    return {.manifest_sha256 = handover::hash_of(manifest),
            .manifest_bytes = static_cast<std::uint32_t>(manifest.size()),
            .pieces = 1U + script_.byte() % 4U};
  }

  control::Vector vector(double scale) {
    control::Vector vector = control::Vector::Zero(script_.byte() % (control::kDofMax + 1));
    for (double& number : vector) number = script_.value<std::int16_t>() * scale;
    return vector;
  }

  wire::EnvironmentForce force() {
    wire::EnvironmentForce force{.session = script_.byte(), .sequence = ++forces_ + script_.byte()};
    force.motion_sequence = motion_.sequence - script_.byte();
    force.motion_device_time = motion_.device_time - std::chrono::milliseconds{script_.byte()};
    force.answer.force = vector(1);
    force.position = vector(1e-5);
    force.answer.contact_normal = vector(1e-3);
    force.answer.penetration_m = script_.value<std::int16_t>() * 1e-5;
    force.server_receive_time = time::Nanoseconds{script_.value<std::int64_t>() >> 3};
    force.server_send_time = force.server_receive_time + time::Nanoseconds{script_.byte()};
    force.motions_received = script_.value<std::uint16_t>();
    force.answer.texture_N = script_.byte();
    force.answer.texture_wave = vector(1);
    force.server_law_numbers = control::ServerLawNumbers::Zero(script_.byte() % 17);
    for (double& number : force.server_law_numbers) number = script_.value<std::int16_t>() * 1e-2;
    force.answer.server_parts_N = vector(1);
    force.answer.torque_N_m = vector(1);
    return force;
  }

  void arrive(const wire::Message& message) { link_.arrive(codec_.encode(message), kServerAddress); }

  void advance(int milliseconds) { clock_.time += std::chrono::milliseconds{milliseconds}; }

  void tick(int milliseconds) {
    advance(milliseconds);
    session_.tick(clock_.time);
    for (const auto& sent : link_.sent) {
      const auto decoded = codec_.decode(sent.bytes);
      const auto* const message = std::get_if<wire::Message>(&decoded);
      must(message != nullptr, "a datagram that no server can read");
      if (const auto* const hello = std::get_if<wire::Hello>(message)) nonce_ = hello->client_nonce;
      if (const auto* const motion = std::get_if<wire::MotionSample>(message)) motion_ = *motion;
    }
    link_.sent.clear();
  }

  void check() const {
    must(device_.applied.allFinite(), "a force that is not finite");
    constexpr double kRounding = 1 + 1e-9;
    must(device_.applied.norm() <= device_.facts().force_N_max * kRounding, "a force above the device's largest");
  }

  Script script_;
  test::FakeDevice device_;
  test::FakeLink link_;
  test::FakeClock clock_;
  wire::Codec codec_;
  client::LocalRendering local_;
  client::Session session_;
  std::uint64_t nonce_ = 0;
  std::uint64_t forces_ = 0;
  wire::MotionSample motion_{};
};

}  // namespace

// First byte: the law. One degree of freedom or three.
void fuzz_client(Bytes bytes) {
  constexpr std::array<std::string_view, 4> kLaws{"none", "fba-less", "fba-more", "fba-exact"};
  const unsigned first = Script(bytes).byte();
  const int dof = first / kLaws.size() % 2 == 0 ? 1 : 3;
  ScriptedClient(bytes.subspan(std::min<std::size_t>(bytes.size(), 1)), kLaws[first % kLaws.size()], dof).run();
}

}  // namespace forcebound::fuzz
