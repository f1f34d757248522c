// Cost of one motion in the server's core, from the datagram to its answer, with a number of clients connected. Build
// it optimised:
//
//     cmake --preset release && cmake --build --preset release --target server_benchmark
//     build/release/bin/server_benchmark

#include <benchmark/benchmark.h>

#include <algorithm>
#include <vector>

#include "forcebound/server/environment/scene_library.hpp"
#include "forcebound/server/session/server.hpp"
#include "tests/support/fake_clock.hpp"

namespace forcebound::server {
namespace {

using namespace std::chrono_literals;

/// Drops all datagrams, and keeps the session of the last Welcome.
class Nowhere final : public net::DatagramLink {
 public:
  bool send(std::span<const std::byte> datagram, const net::Address&) noexcept override {
    benchmark::DoNotOptimize(datagram.data());
    if (!connecting) return true;
    const auto decoded = codec_.decode(datagram);
    session = std::get<wire::Welcome>(std::get<wire::Message>(decoded)).session;
    return true;
  }
  std::optional<net::Received> receive(std::span<std::byte>) noexcept override { return std::nullopt; }

  bool connecting = true;
  std::uint64_t session = 0;

 private:
  wire::Codec codec_;
};

void server_motion(benchmark::State& timing) {
  const auto clients = static_cast<std::size_t>(timing.range(0));
  Nowhere link;
  test::FakeClock clock;
  wire::Codec codec;
  std::uint64_t ids = 0;
  Server server({.scene = "sphere", .sessions_max = clients, .hellos_per_s_max = 10000}, SceneLibrary::shipped(), link,
                clock, [&] { return ids += 0x9e3779b97f4a7c15; });
  std::vector<std::uint64_t> sessions;
  for (std::size_t client = 0; client < clients; ++client) {
    const net::Address address{.ip = {}, .port = static_cast<std::uint16_t>(client + 1)};
    const wire::Hello hello{.client_nonce = client + 1, .degrees_of_freedom = 3, .period_s = 1e-3, .force_N_max = 3};
    server.on_datagram(codec.encode(hello), address, clock.time);
    sessions.push_back(link.session);
  }
  link.connecting = false;

  // A thousand motions of each, encoded before; a millisecond passes for each of a client's.
  constexpr std::size_t kAhead = 1000;
  std::vector<std::vector<std::byte>> datagrams;
  wire::MotionSample motion{.position = control::Vector::Constant(3, 0.01)};
  std::uint64_t sequence = 0;
  const auto encode_more = [&] {
    datagrams.clear();
    for (std::size_t i = 0; i < std::max(kAhead, clients); ++i) {
      motion.session = sessions[i % clients];
      motion.sequence = sequence + i / clients + 1;
      motion.device_time = clock.time + 1ms * (i / clients);
      const auto bytes = codec.encode(motion);
      datagrams.emplace_back(bytes.begin(), bytes.end());
    }
    sequence = motion.sequence;
  };
  std::size_t next = 0;
  for (auto _ : timing) {
    if (next == datagrams.size()) {
      timing.PauseTiming();
      encode_more();
      next = 0;
      timing.ResumeTiming();
    }
    const net::Address address{.ip = {}, .port = static_cast<std::uint16_t>(next % clients + 1)};
    server.on_datagram(datagrams[next], address, clock.time);
    if (++next % clients == 0) clock.time += 1ms;
  }
  timing.counters["answered"] =
      static_cast<double>(server.counters().forces_sent) / static_cast<double>(timing.iterations());
}

BENCHMARK(server_motion)->ArgName("clients")->RangeMultiplier(4)->Range(1, 256);

}  // namespace
}  // namespace forcebound::server
