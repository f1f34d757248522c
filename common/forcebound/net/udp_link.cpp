#include "forcebound/net/udp_link.hpp"

#include <linux/sock_diag.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <asio/io_context.hpp>
#include <asio/ip/udp.hpp>
#include <asio/ip/v6_only.hpp>
#include <cerrno>
#include <stdexcept>
#include <string>
#include <vector>

#include "forcebound/net/endpoint.hpp"
#include "forcebound/net/internal/udp_address.hpp"
#include "forcebound/time/steady_clock.hpp"

namespace forcebound::net {
namespace {

using asio::ip::udp;

// A delay of one tick must never overflow the socket, even with many clients at 1 kHz.
constexpr int kSocketBufferBytes = 1 << 20;

// Limits the port unreachable (ICMP) reports handled in one call: each is reported instead of data.
constexpr int kRefusalsSkippedMax = 16;

std::string reason(const asio::error_code& error) {
  if (error == asio::error::address_in_use)
    return "the address is already in use, by another program or a copy of this one";
  if (error == asio::error::access_denied) return "not permitted; ports below 1024 are for the administrator";
  if (error.value() == EADDRNOTAVAIL) return "no interface of this machine has that address";
  if (error == asio::error::address_family_not_supported) return "this machine does not support that kind of address";
  return error.message();
}

/// The one that all sockets of the process share: it has three descriptors of its own, so that one for each socket
/// would take four in place of one. Nothing ever runs in it: links send and receive by themselves.
asio::io_context& shared_context() {
  static asio::io_context context;
  return context;
}

}  // namespace

struct UdpLink::Socket {
  udp::socket socket{shared_context()};
  UdpCounters counters{};
  bool stamped = false;  ///< each datagram, by the system
  udp::endpoint sender{};

  void open(const udp& protocol, Stamps stamps) {
    // Blocking, for those who wait for a datagram in the same call that receives it; all others say MSG_DONTWAIT.
    socket.open(protocol);
    set_up(protocol, stamps);
  }

  void set_up(const udp& protocol, Stamps stamps) {
    // Larger buffers help, but smaller ones work too.
    asio::error_code ignored;
    socket.set_option(asio::socket_base::receive_buffer_size(kSocketBufferBytes), ignored);
    socket.set_option(asio::socket_base::send_buffer_size(kSocketBufferBytes), ignored);
    stamped = stamps == Stamps::taken;
    const int on = 1;
    if (stamped) setsockopt(socket.native_handle(), SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on);
    if (protocol == udp::v6()) socket.set_option(asio::ip::v6_only(false), ignored);
  }
};

UdpLink::UdpLink(std::unique_ptr<Socket> socket) noexcept : socket_(std::move(socket)) {}
UdpLink::UdpLink(UdpLink&&) noexcept = default;
UdpLink& UdpLink::operator=(UdpLink&&) noexcept = default;
UdpLink::~UdpLink() = default;

UdpLink UdpLink::listen(const Address& local, Stamps stamps) try {
  const udp::endpoint endpoint = to_asio(local);
  auto socket = std::make_unique<Socket>();
  socket->open(endpoint.protocol(), stamps);
  socket->socket.bind(endpoint);
  return UdpLink(std::move(socket));
} catch (const asio::system_error& error) {
  throw std::runtime_error("cannot listen on " + to_string(local) + ": " + reason(error.code()));
}

UdpLink UdpLink::adopt(int descriptor, Stamps stamps) try {
  sockaddr_storage bound{};
  socklen_t bytes = sizeof bound;
  int type = 0;
  socklen_t type_bytes = sizeof type;
  if (getsockname(descriptor, reinterpret_cast<sockaddr*>(&bound), &bytes) != 0 ||
      getsockopt(descriptor, SOL_SOCKET, SO_TYPE, &type, &type_bytes) != 0 || type != SOCK_DGRAM ||
      (bound.ss_family != AF_INET && bound.ss_family != AF_INET6)) {
    throw std::runtime_error("descriptor " + std::to_string(descriptor) + " is no bound UDP socket");
  }
  const udp protocol = bound.ss_family == AF_INET6 ? udp::v6() : udp::v4();
  auto socket = std::make_unique<Socket>();
  socket->socket.assign(protocol, descriptor);
  if (socket->socket.local_endpoint().port() == 0) {
    socket->socket.release();
    throw std::runtime_error("descriptor " + std::to_string(descriptor) + " is no bound UDP socket");
  }
  // Blocking, as `open` leaves it.
  socket->socket.native_non_blocking(false);
  socket->set_up(protocol, stamps);
  return UdpLink(std::move(socket));
} catch (const asio::system_error& error) {
  throw std::runtime_error("cannot use descriptor " + std::to_string(descriptor) + ": " + reason(error.code()));
}

UdpLink UdpLink::beside(UdpLink& first, Stamps stamps) try {
  // After it was bound: had another program the address, that has failed.
  const asio::detail::socket_option::boolean<SOL_SOCKET, SO_REUSEPORT> shared(true);
  first.socket_->socket.set_option(shared);
  const udp::endpoint endpoint = to_asio(first.local_address());
  auto socket = std::make_unique<Socket>();
  socket->open(endpoint.protocol(), stamps);
  socket->socket.set_option(shared);
  socket->socket.bind(endpoint);
  return UdpLink(std::move(socket));
} catch (const asio::system_error& error) {
  throw std::runtime_error("cannot listen on " + to_string(first.local_address()) +
                           " with another socket: " + reason(error.code()));
}

UdpLink UdpLink::towards(const Address& peer) try {
  const udp::endpoint endpoint = to_asio(peer);
  auto socket = std::make_unique<Socket>();
  socket->open(endpoint.protocol(), Stamps::taken);
  socket->socket.connect(endpoint);
  return UdpLink(std::move(socket));
} catch (const asio::system_error& error) {
  throw std::runtime_error("cannot send to " + to_string(peer) + ": " + reason(error.code()));
}

UdpLink UdpLink::towards_nobody() try {
  auto socket = std::make_unique<Socket>();
  try {
    socket->open(udp::v6(), Stamps::taken);
  } catch (const asio::system_error&) {  // a machine without IPv6
    socket->open(udp::v4(), Stamps::taken);
  }
  return UdpLink(std::move(socket));
} catch (const asio::system_error& error) {
  throw std::runtime_error("cannot send by UDP: " + reason(error.code()));
}

bool UdpLink::direct_to(const Address& peer) noexcept {
  // Let go first: otherwise it would keep the address of ours from which the peer before was to be reached.
  const sockaddr nobody{.sa_family = AF_UNSPEC, .sa_data = {}};
  const udp::endpoint endpoint = to_asio(peer);
  return connect(descriptor(), &nobody, sizeof nobody) == 0 &&
         connect(descriptor(), endpoint.data(), static_cast<socklen_t>(endpoint.size())) == 0;
}

bool UdpLink::send(std::span<const std::byte> datagram, const Address& to) noexcept {
  const udp::endpoint endpoint = to_asio(to);
  for (int i = 0; i < kRefusalsSkippedMax; ++i) {
    if (sendto(descriptor(), datagram.data(), datagram.size(), MSG_DONTWAIT, endpoint.data(),
               static_cast<socklen_t>(endpoint.size())) >= 0) {
      return true;
    }
    // The error is of an earlier datagram; this one was not sent yet.
    if (errno != ECONNREFUSED) break;
    ++socket_->counters.refused;
  }
  ++socket_->counters.send_failed;
  return false;
}

std::optional<Received> UdpLink::receive(std::span<std::byte> buffer) noexcept {
  udp::endpoint& sender = socket_->sender;
  for (int i = 0; i < kRefusalsSkippedMax; ++i) {
    sender.resize(sender.capacity());
    iovec part{buffer.data(), buffer.size()};
    alignas(cmsghdr) std::array<std::byte, kControlBytes> control;
    msghdr message{};
    message.msg_name = sender.data();
    message.msg_namelen = static_cast<socklen_t>(sender.capacity());
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    // MSG_TRUNC: the result is the datagram's whole size, also if it was cut.
    const ssize_t bytes = recvmsg(descriptor(), &message, MSG_TRUNC | MSG_DONTWAIT);
    if (bytes >= 0) {
      sender.resize(message.msg_namelen);
      const time::Nanoseconds waited = stamped() ? waited_of(message, time::wall_clock_now()) : time::Nanoseconds{0};
      return Received{static_cast<std::size_t>(bytes), from_asio(sender), waited};
    }
    if (errno != ECONNREFUSED) break;
    ++socket_->counters.refused;
  }
  return std::nullopt;
}

void UdpLink::wait_at_most(time::Nanoseconds duration) noexcept {
  const auto us = std::max<std::int64_t>(1, duration.count() / 1000);  // zero would mean forever
  const timeval limit{us / 1'000'000, us % 1'000'000};
  setsockopt(descriptor(), SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
}

std::uint64_t UdpLink::refused() const noexcept { return socket_->counters.refused; }

Address UdpLink::local_address() const noexcept {
  asio::error_code error;
  return from_asio(socket_->socket.local_endpoint(error));
}

UdpCounters UdpLink::counters() const noexcept {
  UdpCounters counters = socket_->counters;
  // Asked for here rather than told with each datagram: that costs each one more.
  std::array<std::uint32_t, SK_MEMINFO_VARS> memory{};
  socklen_t bytes = sizeof memory;
  if (getsockopt(descriptor(), SOL_SOCKET, SO_MEMINFO, memory.data(), &bytes) == 0)
    counters.overflowed = memory[SK_MEMINFO_DROPS];
  return counters;
}

void UdpLink::count_refused() noexcept { ++socket_->counters.refused; }
bool UdpLink::stamped() const noexcept { return socket_->stamped; }
void UdpLink::count_send_failed() noexcept { ++socket_->counters.send_failed; }

int UdpLink::descriptor() const noexcept { return socket_->socket.native_handle(); }

bool wait_readable(std::span<const int> descriptors, time::Nanoseconds timeout) noexcept {
  std::array<pollfd, kWaitableMax> polled;
  const std::size_t count = std::min(descriptors.size(), polled.size());
  for (std::size_t i = 0; i < count; ++i) polled[i] = {descriptors[i], POLLIN, 0};
  const auto positive = std::max(timeout, time::Nanoseconds{0}).count();
  const timespec duration{positive / 1'000'000'000, positive % 1'000'000'000};
  return ppoll(polled.data(), count, &duration, nullptr) > 0;
}

std::vector<Address> look_up(const Endpoint& endpoint) {
  asio::io_context context;
  asio::error_code error;
  const auto found = udp::resolver(context).resolve(endpoint.host, std::to_string(endpoint.port),
                                                    udp::resolver::numeric_service, error);
  if (error || found.empty()) {
    throw std::runtime_error("cannot find the address of host '" + endpoint.host +
                             "': " + (error ? error.message() : "it has none"));
  }
  std::vector<Address> addresses;
  for (const auto& entry : found) addresses.push_back(from_asio(entry.endpoint()));
  return in_order_of_trial(addresses);
}

}  // namespace forcebound::net
