#include "forcebound/server/session/server.hpp"

#include "forcebound/server/environment/scene_library.hpp"
#include "tests/fuzz/frame.hpp"
#include "tests/fuzz/input.hpp"
#include "tests/support/fake_clock.hpp"
#include "tests/support/fake_link.hpp"

namespace forcebound::fuzz {
namespace {

constexpr std::size_t kSessionsMax = 3;
constexpr int kStepsMax = 512;

server::EnvironmentLibrary small_library() {
  server::SceneLibrary scenes;
  for (const char* const name : {"wall", "sphere"}) scenes.add(server::load_scene(name));
  return scenes;
}

/// A server, and clients that do as the script says. Session numbers are 1, 2, 3, ..., so that a script meets them.
class ScriptedServer {
 public:
  explicit ScriptedServer(Bytes bytes) : script_(bytes) {}

  void run() {
    for (int step = 0; step < kStepsMax && !script_.ended(); ++step) {
      run_step();
      check();
    }
    server_.stop();
    check();
    must(server_.sessions() == 0, "a session outlived the server's stop");
  }

 private:
  void run_step() {
    constexpr std::string_view kScenes[] = {"", "wall", "sphere", "spere"};
    constexpr std::string_view kLaws[] = {"", "wave", "two-layer", "tdpa"};
    switch (script_.byte() % 9) {
      case 0: {
        wire::Hello hello{.client_nonce = script_.byte(),
                          .degrees_of_freedom = script_.byte() % 8U,
                          .device = "scripted",
                          .period_s = script_.byte() * 1e-4,
                          .force_N_max = 30,
                          .scene = kScenes[script_.byte() % std::size(kScenes)],
                          .client_time = time::Nanoseconds{script_.value<std::uint32_t>()},
                          .server_law = kLaws[script_.byte() % std::size(kLaws)]};
        const std::uint8_t wants = script_.byte();
        hello.renders_locally = wants % 2 == 1;
        hello.shows_scene = (wants & 2U) != 0;
        arrive(hello);
        break;
      }
      case 1:
        arrive(motion());
        break;
      case 2:
        arrive(wire::Bye{.session = script_.byte(), .motions_received = script_.byte()});
        break;
      case 3: {
        const std::uint8_t kind = script_.byte();
        arrive_bytes(framed(kind, script_.take(script_.byte())));
        break;
      }
      case 4:
        arrive_bytes(script_.take(script_.value<std::uint16_t>() % net::kDatagramBytesMax));
        break;
      case 5:
        server_.answer_waiting();
        break;
      case 6:
        (void)server_.answer_next();
        break;
      case 7:
        clock_.time += std::chrono::milliseconds{script_.value<std::uint16_t>()};
        break;
      default:
        server_.on_timer(clock_.time);
        break;
    }
  }

  wire::MotionSample motion() {
    wire::MotionSample motion{.session = script_.byte(),
                              .sequence = script_.value<std::uint64_t>(),
                              .device_time = time::Nanoseconds{script_.value<std::uint32_t>()}};
    motion.position = control::Vector::Zero(script_.byte() % (control::kDofMax + 1));
    for (double& place_m : motion.position) place_m = script_.value<std::int16_t>() * 1e-5;
    motion.server_law_numbers = control::ServerLawNumbers::Zero(script_.byte() % 17);
    for (double& number : motion.server_law_numbers) number = script_.value<std::int16_t>() * 1e-2;
    const std::uint8_t has = script_.byte();
    motion.pieces = {.wanted = has % 2 == 1, .newest = script_.byte(), .before = script_.byte()};
    if ((has & 2U) != 0) motion.handle.buttons = script_.byte();
    if ((has & 4U) != 0) motion.handle.gripper = script_.value<std::int16_t>() * 1e-3;
    if ((has & 8U) != 0) {
      for (double& number : motion.handle.orientation.emplace()) number = script_.value<std::int16_t>() * 1e-3;
    }
    return motion;
  }

  void arrive(const wire::Message& message) { arrive_bytes(client_.encode(message)); }

  void arrive_bytes(Bytes datagram) {
    const net::Address from{.ip = {}, .port = static_cast<std::uint16_t>(1 + script_.byte() % 4)};
    server_.receive(datagram, {.address = from}, clock_.time);
  }

  void check() {
    must(server_.sessions() <= kSessionsMax, "more sessions than allowed");
    for (const auto& sent : link_.sent) {
      must(sent.bytes.size() <= wire::kFrameBytesMax, "a datagram longer than the protocol allows");
      must(std::holds_alternative<wire::Message>(client_.decode(sent.bytes)), "an answer that no client can read");
    }
    link_.sent.clear();
  }

  Script script_;
  test::FakeLink link_;
  test::FakeClock clock_;
  wire::Codec client_;
  std::uint64_t last_session_ = 0;
  server::Server server_{{.scene = "wall", .sessions_max = kSessionsMax, .hellos_per_s_max = 1000},
                         [] {
                           static const server::EnvironmentLibrary kLibrary = small_library();
                           return kLibrary;
                         }(),
                         link_,
                         clock_,
                         [this] { return ++last_session_; }};
};

}  // namespace

void fuzz_server(Bytes bytes) { ScriptedServer(bytes).run(); }

}  // namespace forcebound::fuzz
