// Cost of a client's tick, without and with a recording, including a simulated answer to every motion. Build it
// optimised:
//
//     cmake --preset release && cmake --build --preset release --target session_benchmark
//     build/release/bin/session_benchmark

#include <benchmark/benchmark.h>

#include <array>
#include <vector>

#include "forcebound/client/session/session.hpp"
#include "forcebound/control/law_registry.hpp"
#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/make_operator.hpp"
#include "forcebound/device/simulated/simulated_device.hpp"
#include "forcebound/record/recorder.hpp"
#include "forcebound/record/summary.hpp"
#include "tests/support/fake_clock.hpp"

namespace forcebound::client {
namespace {

using namespace std::chrono_literals;

/// A server that answers each motion at once with the same force.
class Answering final : public net::DatagramLink {
 public:
  bool send(std::span<const std::byte> datagram, const net::Address& to) noexcept override {
    const auto decoded = codec_.decode(datagram);
    const auto* message = std::get_if<wire::Message>(&decoded);
    if (message == nullptr) return true;
    if (const auto* hello = std::get_if<wire::Hello>(message)) {
      keep(wire::Welcome{.client_nonce = hello->client_nonce, .session = 1, .scene = "bench"}, to);
    } else if (const auto* motion = std::get_if<wire::MotionSample>(message)) {
      keep(wire::EnvironmentForce{.session = 1,
                                  .sequence = ++forces_,
                                  .motion_sequence = motion->sequence,
                                  .motion_device_time = motion->device_time,
                                  .position = motion->position,
                                  .motions_received = forces_,
                                  .answer = {.force = control::Vector::Constant(3, 0.1)}},
           to);
    }
    return true;
  }

  std::optional<net::Received> receive(std::span<std::byte> buffer) noexcept override {
    if (bytes_ == 0) return std::nullopt;
    std::copy_n(answer_.begin(), bytes_, buffer.begin());
    return net::Received{std::exchange(bytes_, 0), peer_};
  }

 private:
  void keep(const wire::Message& answer, const net::Address& peer) noexcept {
    const auto encoded = codec_.encode(answer);
    std::copy(encoded.begin(), encoded.end(), answer_.begin());
    bytes_ = encoded.size();
    peer_ = peer;
  }

  wire::Codec codec_;
  std::uint64_t forces_ = 0;
  std::array<std::byte, net::kDatagramBytesMax> answer_{};
  std::size_t bytes_ = 0;
  net::Address peer_;
};

void tick(benchmark::State& timing, bool recorded) {
  device::SimulatedDevice device(device::load_device("omni"), device::make_operator("trace-sphere", 3));
  Answering link;
  test::FakeClock clock;
  record::RunInfo info;
  info.period = 1ms;
  record::Summary summary(info);
  record::Recorder recorder;
  record::RecordingWriter writer("/dev/null", info);
  std::vector<record::TickSink*> sinks{&summary};
  if (recorded) sinks.push_back(&recorder);
  Session session({.server = {}}, device, control::force_bounding_laws().make("fba-exact", device.facts(), {}), link,
                  clock, {.ticks = sinks});
  std::uint64_t ticks = 0;
  for (auto _ : timing) {
    session.tick(clock.time += 1ms);
    // Another thread's work.
    if (++ticks % 1000 != 0) continue;
    timing.PauseTiming();
    recorder.drain(writer);
    timing.ResumeTiming();
  }
  timing.counters["answered"] = static_cast<double>(session.totals().received) / static_cast<double>(ticks);
}

BENCHMARK_CAPTURE(tick, plain, false);
BENCHMARK_CAPTURE(tick, recorded, true);

}  // namespace
}  // namespace forcebound::client
