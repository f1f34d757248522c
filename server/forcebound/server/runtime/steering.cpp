#include "forcebound/server/runtime/steering.hpp"

#include <linux/filter.h>
#include <sys/socket.h>

#include <algorithm>
#include <cstdint>

#include "forcebound/server/session/shared_limits.hpp"

namespace forcebound::server {
namespace {

// As codec.hpp, channel.hpp and the schema have them.
constexpr std::byte kMark{'F'};
constexpr std::byte kClear{'B'};
constexpr std::byte kSealed{'S'};
constexpr std::byte kWakeUp{'W'};
constexpr std::size_t kKindAt = 3;
constexpr std::size_t kSealedNumberAt = 4;
constexpr std::size_t kTagAt = 8;
constexpr std::size_t kNumberAt = 9;
constexpr std::byte kNumberInField1{0x09};  // tag of a fixed64
constexpr std::size_t kWakeUpWorkerAt = 2;

constexpr std::byte kMotion{4};
constexpr std::byte kBye{6};

/// No socket has it: the system falls back on the hash.
constexpr std::uint32_t kByHash = 0xffffffff;

constexpr sock_filter load_byte(std::size_t at) noexcept {
  return {BPF_LD | BPF_B | BPF_ABS, 0, 0, static_cast<std::uint32_t>(at)};
}

/// Where instruction number `here` goes on.
struct Branch {
  std::size_t here;
  std::size_t if_so;
  std::size_t if_not;
};
constexpr sock_filter compare(std::byte value, const Branch& to) noexcept {
  return {BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint8_t>(to.if_so - to.here - 1),
          static_cast<std::uint8_t>(to.if_not - to.here - 1), std::to_integer<std::uint32_t>(value)};
}
constexpr sock_filter jump(std::size_t here, std::size_t to) noexcept {
  return {BPF_JMP | BPF_JA, 0, 0, static_cast<std::uint32_t>(to - here - 1)};
}

/// A load from beyond the end makes the system choose the first socket, whose worker hands over what is not its own.
constexpr auto program_for(std::size_t workers) noexcept {
  constexpr std::size_t kInClear = 6;
  constexpr std::size_t kOfSession = 9;
  constexpr std::size_t kInSealed = 13;
  constexpr std::size_t kInWakeUp = 15;
  constexpr std::size_t kModulo = 16;
  constexpr std::size_t kHash = 18;
  return std::array{load_byte(0),
                    compare(kMark, {1, 2, kHash}),
                    load_byte(1),
                    compare(kClear, {3, kInClear, 4}),
                    compare(kSealed, {4, kInSealed, 5}),
                    compare(kWakeUp, {5, kInWakeUp, kHash}),
                    load_byte(kKindAt),
                    compare(kMotion, {7, kOfSession, 8}),
                    compare(kBye, {8, kOfSession, kHash}),
                    load_byte(kTagAt),
                    compare(kNumberInField1, {10, 11, kHash}),
                    load_byte(kNumberAt),
                    jump(12, kModulo),
                    load_byte(kSealedNumberAt),
                    jump(14, kModulo),
                    load_byte(kWakeUpWorkerAt),
                    sock_filter{BPF_ALU | BPF_MOD | BPF_K, 0, 0, static_cast<std::uint32_t>(workers)},
                    sock_filter{BPF_RET | BPF_A, 0, 0, 0},
                    sock_filter{BPF_RET | BPF_K, 0, 0, kByHash}};
}

std::byte byte_at(std::span<const std::byte> datagram, std::size_t at) noexcept {
  return at < datagram.size() ? datagram[at] : std::byte{0};
}

}  // namespace

std::optional<std::size_t> worker_for(std::span<const std::byte> datagram, std::size_t workers) noexcept {
  if (byte_at(datagram, 0) != kMark) return std::nullopt;
  const std::byte form = byte_at(datagram, 1);
  const std::byte kind = byte_at(datagram, kKindAt);
  const bool of_session =
      form == kClear && (kind == kMotion || kind == kBye) && byte_at(datagram, kTagAt) == kNumberInField1;
  if (!of_session && form != kSealed && form != kWakeUp) return std::nullopt;
  const std::size_t at = of_session ? kNumberAt : form == kSealed ? kSealedNumberAt : kWakeUpWorkerAt;
  return WorkerPlace::owner_of(std::to_integer<std::uint64_t>(byte_at(datagram, at)), workers);
}

bool steer(const net::UdpLink& one_of_group, std::size_t workers) noexcept {
  auto program = program_for(workers);
  const sock_fprog filter{.len = program.size(), .filter = program.data()};
  return setsockopt(one_of_group.descriptor(), SOL_SOCKET, SO_ATTACH_REUSEPORT_CBPF, &filter, sizeof filter) == 0;
}

WakeUpCall wake_up_call(std::size_t worker) noexcept { return {kMark, kWakeUp, static_cast<std::byte>(worker)}; }

bool is_wake_up_call(std::span<const std::byte> datagram) noexcept {
  return datagram.size() == WakeUpCall{}.size() && datagram[0] == kMark && datagram[1] == kWakeUp;
}

}  // namespace forcebound::server
