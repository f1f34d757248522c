// What encryption costs: beside it the memory copy and the checksum that a datagram in the clear takes.
#include <benchmark/benchmark.h>
#include <zlib.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <cstring>
#include <span>
#include <vector>

#include "forcebound/security/channel.hpp"
#include "forcebound/security/cookies.hpp"
#include "tests/unit/security/handshakes.hpp"

namespace forcebound::security {
namespace {

// A motion of three degrees of freedom, an answer with local models, a Hello.
constexpr std::array<std::int64_t, 3> kBytes{64, 400, 1200};

void datagram_sizes(benchmark::internal::Benchmark* benchmark) {
  for (const std::int64_t bytes : kBytes) benchmark->Arg(bytes);
}

struct Pair {
  Pair() {
    Ends ends;
    const auto keys = ends.keys(1);
    (void)server.install(1, keys[1], Role::responder, now);
    (void)client.install(1, keys[0], Role::initiator, now);
  }
  time::Nanoseconds now{std::chrono::seconds(1)};
  Channel client{SessionNumbers{.own = 11, .peer = 22}};
  Channel server{SessionNumbers{.own = 22, .peer = 11}};
};

void seal(benchmark::State& state) {
  Pair pair;
  const std::vector<std::byte> plain(static_cast<std::size_t>(state.range(0)));
  std::vector<std::byte> record(plain.size() + kRecordOverhead);
  for (auto _ : state) benchmark::DoNotOptimize(pair.client.seal(plain, record, pair.now));
}
BENCHMARK(seal)->Apply(datagram_sizes);

void seal_and_open(benchmark::State& state) {
  Pair pair;
  const std::vector<std::byte> plain(static_cast<std::size_t>(state.range(0)));
  std::vector<std::byte> record(plain.size() + kRecordOverhead);
  std::vector<std::byte> opened(plain.size());
  for (auto _ : state) {
    benchmark::DoNotOptimize(pair.client.seal(plain, record, pair.now));
    benchmark::DoNotOptimize(pair.server.open(record, opened, pair.now));
  }
}
BENCHMARK(seal_and_open)->Apply(datagram_sizes);

void open_what_is_forged(benchmark::State& state) {
  Pair pair;
  const std::vector<std::byte> plain(static_cast<std::size_t>(state.range(0)));
  std::vector<std::byte> record(plain.size() + kRecordOverhead);
  std::vector<std::byte> opened(plain.size());
  (void)pair.client.seal(plain, record, pair.now);
  record.back() ^= std::byte{1};
  for (auto _ : state) benchmark::DoNotOptimize(pair.server.open(record, opened, pair.now));
}
BENCHMARK(open_what_is_forged)->Apply(datagram_sizes);

void copy_and_checksum(benchmark::State& state) {
  const std::vector<std::byte> plain(static_cast<std::size_t>(state.range(0)));
  std::vector<std::byte> copy(plain.size());
  for (auto _ : state) {
    std::memcpy(copy.data(), plain.data(), plain.size());
    benchmark::DoNotOptimize(crc32_z(0, reinterpret_cast<const Bytef*>(copy.data()), copy.size()));
  }
}
BENCHMARK(copy_and_checksum)->Apply(datagram_sizes);

void whole_handshake(benchmark::State& state) {
  Ends ends;
  for (auto _ : state) benchmark::DoNotOptimize(ends.keys(1));
}
BENCHMARK(whole_handshake)->Unit(benchmark::kMicrosecond);

void make_a_cookie(benchmark::State& state) {
  const Cookies cookies(secret_key(7));
  const std::array<std::byte, 18> address{};
  for (auto _ : state) benchmark::DoNotOptimize(cookies.made_for(address, std::chrono::seconds(1)));
}
BENCHMARK(make_a_cookie);

}  // namespace
}  // namespace forcebound::security
