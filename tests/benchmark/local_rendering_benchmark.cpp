// Cost of a client's tick with remote rendering, with local, and with local and encryption, on each scene of
// `forcebound-lab rendering`: median, 99 and 99.9 % and the longest of the ticks since the hand came, how many of them
// were rendered at the client, and the heap operations in them. Simulated device and hand are within a tick; the
// server, which answers before the next one, and the building of scenes are not. Build it optimised:
//
//     cmake --preset release && cmake --build --preset release --target local_rendering_benchmark
//     build/release/bin/local_rendering_benchmark --benchmark_filter=mesh

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/client/security/handshaker.hpp"
#include "forcebound/client/security/secure_link.hpp"
#include "forcebound/client/session/session.hpp"
#include "forcebound/device/simulated/simulated_device.hpp"
#include "forcebound/security/random.hpp"
#include "forcebound/server/environment/scene_environment.hpp"
#include "forcebound/server/security/secure_link.hpp"
#include "forcebound/server/session/server.hpp"
#include "forcebound/time/heap_operations.hpp"
#include "forcebound/time/percentile.hpp"
#include "tests/tools/lab/rendering/rendering_tasks.hpp"
#include "tests/tools/sim/virtual_clock.hpp"

namespace forcebound::client {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kDatagramsInFlight = 256;
constexpr int kTicksBeforeContact = 2000;
constexpr int kTicksTimed = 20000;

/// Datagrams on their way to one end; what finds no room is lost, as in a socket. Allocates nothing after its start.
class Way {
 public:
  void put(std::span<const std::byte> datagram) noexcept {
    if (waiting_ == datagrams_.size() || datagram.size() > net::kDatagramBytesMax) return;
    Datagram& place = datagrams_[(first_ + waiting_++) % datagrams_.size()];
    place.size = datagram.size();
    std::ranges::copy(datagram, place.bytes.begin());
  }

  /// The oldest one's size; nothing if none waits.
  std::optional<std::size_t> take(std::span<std::byte> buffer) noexcept {
    if (waiting_ == 0) return std::nullopt;
    const Datagram& datagram = datagrams_[first_];
    std::copy_n(datagram.bytes.begin(), std::min(datagram.size, buffer.size()), buffer.begin());
    first_ = (first_ + 1) % datagrams_.size();
    --waiting_;
    return datagram.size;
  }

 private:
  struct Datagram {
    std::array<std::byte, net::kDatagramBytesMax> bytes{};
    std::size_t size = 0;
  };

  std::vector<Datagram> datagrams_ = std::vector<Datagram>(kDatagramsInFlight);
  std::size_t first_ = 0;
  std::size_t waiting_ = 0;
};

/// One end of a line between a client and a server.
class LineEnd final : public net::DatagramLink {
 public:
  LineEnd(Way& out, Way& in, const net::Address& peer) : out_(out), in_(in), peer_(peer) {}

  bool send(std::span<const std::byte> datagram, const net::Address&) noexcept override {
    out_.put(datagram);
    return true;
  }

  std::optional<net::Received> receive(std::span<std::byte> buffer) noexcept override {
    const auto size = in_.take(buffer);
    if (!size) return std::nullopt;
    return net::Received{*size, peer_};
  }

 private:
  Way& out_;
  Way& in_;
  net::Address peer_;
};

class RenderedTicks final : public record::TickSink {
 public:
  void on_tick(const record::TickRecord& tick) noexcept override {
    at_client += tick.rendering != record::ForceOrigin::held ? 1 : 0;
  }
  double at_client = 0;
};

security::SecretKey shared_key() {
  security::SecretKey key;
  key->fill(std::byte{7});
  return key;
}

/// Encryption at both ends of a line, with a key that both have.
struct Encryption {
  Encryption(net::DatagramLink& client_end, net::DatagramLink& server_end, const time::Clock& clock)
      : client(client_end, {}, handshaker, clock),
        server({.shared = shared_key()}, {}, server_end, clock, security::fill_with_random) {}

  Handshaker handshaker{{.pattern = security::Pattern::nn_psk0, .server = "server", .shared = shared_key()},
                        security::fill_with_random};
  SecureLink client;
  server::SecureLink server;
};

enum class How : std::uint8_t { remote, local, local_encrypted };

/// A client and its server in virtual time, the server's answer a tick later.
class Pair {
 public:
  Pair(const lab::RenderingTask& task, How how)
      : device_(task.device, task.make_hand()),
        encryption_(how == How::local_encrypted
                        ? std::make_unique<Encryption>(client_line_end_, server_line_end_, clock_)
                        : nullptr),
        server_({.scene = task.scene->facts().name}, library_of(task), server_end_, clock_,
                [random = std::mt19937_64(1)]() mutable { return random() | 1U; }),
        session_({.server = {}, .local = how == How::remote ? nullptr : &local_}, device_,
                 baselines::shipped_laws().make("fba-exact", device_.facts(), {}), client_end_, clock_,
                 {.ticks = sinks_}) {}

  /// One tick; the seconds it took.
  double tick() {
    clock_.advance(1ms);
    const std::uint64_t heap_before = time::heap_operations_of_this_thread();
    const auto begin = std::chrono::steady_clock::now();
    session_.tick(clock_.now());
    const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    heap_operations_ += static_cast<double>(time::heap_operations_of_this_thread() - heap_before);
    if (++ticks_ % 2 == 0) (void)local_.builder().work();
    if (encryption_) encryption_->handshaker.work(clock_.now());
    if (ticks_ % 250 == 0) {
      server_.on_timer(clock_.now());
      if (encryption_) encryption_->server.on_timer(clock_.now());
    }
    while (const auto received = server_end_.receive(buffer_)) {
      server_.on_datagram(std::span(buffer_).first(received->bytes), received->from, clock_.now());
    }
    return took_s;
  }

  /// Of all ticks so far.
  [[nodiscard]] double ticks_at_client() const noexcept { return rendered_.at_client; }
  [[nodiscard]] double heap_operations() const noexcept { return heap_operations_; }

 private:
  static server::EnvironmentLibrary library_of(const lab::RenderingTask& task) {
    server::EnvironmentLibrary library;
    library.add(server::scene_environment(task.scene));
    return library;
  }

  sim::VirtualClock clock_;
  Way up_;
  Way down_;
  LineEnd client_line_end_{up_, down_, {}};
  LineEnd server_line_end_{down_, up_, {}};
  std::array<std::byte, net::kDatagramBytesMax> buffer_{};
  RenderedTicks rendered_;
  std::array<record::TickSink*, 1> sinks_{&rendered_};
  LocalRendering local_{SceneBuilder::Options{}};
  device::SimulatedDevice device_;
  std::unique_ptr<Encryption> encryption_;
  net::DatagramLink& client_end_ =
      encryption_ ? static_cast<net::DatagramLink&>(encryption_->client) : client_line_end_;
  net::DatagramLink& server_end_ =
      encryption_ ? static_cast<net::DatagramLink&>(encryption_->server) : server_line_end_;
  server::Server server_;
  Session session_;
  int ticks_ = 0;
  double heap_operations_ = 0;
};

void ticks_of(benchmark::State& state, const lab::RenderingTask& task, How how) {
  Pair pair(task, how);
  for (int i = 0; i < kTicksBeforeContact; ++i) (void)pair.tick();
  std::vector<double> took_ns;
  took_ns.reserve(kTicksTimed);
  const double at_client_before = pair.ticks_at_client();
  const double heap_before = pair.heap_operations();
  for (auto _ : state) {
    const double took_s = pair.tick();
    state.SetIterationTime(took_s);
    took_ns.push_back(1e9 * took_s);
  }
  state.counters["p50_ns"] = time::percentile_of(took_ns, 0.5);
  state.counters["p99_ns"] = time::percentile_of(took_ns, 0.99);
  state.counters["p999_ns"] = time::percentile_of(took_ns, 0.999);
  state.counters["max_ns"] = time::percentile_of(took_ns, 1);
  state.counters["at_client_percent"] =
      100 * (pair.ticks_at_client() - at_client_before) / static_cast<double>(state.iterations());
  state.counters["heap_operations"] = pair.heap_operations() - heap_before;
}

void add_benchmarks() {
  for (const lab::RenderingTask& task : lab::rendering_tasks()) {
    for (const auto& rendering :
         {std::pair{How::remote, "/remote"}, {How::local, "/local"}, {How::local_encrypted, "/local/encrypted"}}) {
      const auto run = [task, how = rendering.first](benchmark::State& state) { ticks_of(state, task, how); };
      benchmark::RegisterBenchmark((task.name + rendering.second).c_str(), run)
          ->UseManualTime()
          ->Iterations(kTicksTimed);
    }
  }
}

}  // namespace

}  // namespace forcebound::client

int main(int argc, char** argv) {
  forcebound::client::add_benchmarks();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
