#include "forcebound/net/udp_batch.hpp"

#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>

#include "forcebound/net/internal/udp_address.hpp"
#include "forcebound/time/steady_clock.hpp"

namespace forcebound::net {

using UdpEndpoint = asio::ip::udp::endpoint;

struct UdpBatch::Storage {
  /// Messages in one direction, each with room for a datagram.
  struct Way {
    std::array<std::array<std::byte, kDatagramBytesMax>, kDatagramsMax> bytes;
    std::array<UdpEndpoint, kDatagramsMax> peers;
    std::array<iovec, kDatagramsMax> parts;
    std::array<mmsghdr, kDatagramsMax> messages{};

    Way() noexcept {
      for (std::size_t i = 0; i < kDatagramsMax; ++i) {
        parts[i] = {bytes[i].data(), bytes[i].size()};
        messages[i].msg_hdr.msg_name = peers[i].data();
        messages[i].msg_hdr.msg_iov = &parts[i];
        messages[i].msg_hdr.msg_iovlen = 1;
      }
    }
  };

  Way in;
  struct alignas(cmsghdr) Control {
    std::array<std::byte, kControlBytes> bytes;
  };
  std::array<Control, kDatagramsMax> control;
  std::array<Arrived, kDatagramsMax> arrived{};
  std::size_t written = kDatagramsMax;  ///< of `in`: messages whose sizes the system may have overwritten
  Way out;
  std::size_t waiting = 0;  ///< in `out`
};

UdpBatch::UdpBatch(UdpLink& link) : link_(link), storage_(std::make_unique<Storage>()) {}
UdpBatch::~UdpBatch() = default;

std::span<const UdpBatch::Arrived> UdpBatch::receive_all() noexcept { return receive(MSG_DONTWAIT); }

// Sleeps for the first alone.
std::span<const UdpBatch::Arrived> UdpBatch::wait_for_some() noexcept { return receive(MSG_WAITFORONE); }

std::span<const UdpBatch::Arrived> UdpBatch::receive(int flags) noexcept {
  Storage& all = *storage_;
  const bool stamped = link_.stamped();
  // Only these: after a millisecond the others are no longer in the caches, and each would cost an access to memory.
  for (std::size_t i = 0; i < all.written; ++i) {
    msghdr& message = all.in.messages[i].msg_hdr;
    message.msg_namelen = static_cast<socklen_t>(all.in.peers[i].capacity());
    if (!stamped) continue;
    message.msg_control = all.control[i].bytes.data();
    message.msg_controllen = kControlBytes;
  }
  // A port unreachable (ICMP) is reported instead of data, once.
  int count = -1;
  for (int attempt = 0; attempt < 2 && count < 0; ++attempt) {
    // MSG_TRUNC: each result is the datagram's whole size, also if it was cut.
    count = recvmmsg(link_.descriptor(), all.in.messages.data(), kDatagramsMax, flags | MSG_TRUNC, nullptr);
    if (count < 0 && errno != ECONNREFUSED) return {};
    if (count < 0) link_.count_refused();
  }
  all.written = std::min(static_cast<std::size_t>(std::max(count, 0)) + 1, kDatagramsMax);
  if (count <= 0) return {};
  const time::Nanoseconds now = stamped ? time::wall_clock_now() : time::Nanoseconds{0};
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    mmsghdr& message = all.in.messages[i];
    all.in.peers[i].resize(message.msg_hdr.msg_namelen);
    const time::Nanoseconds waited = stamped ? waited_of(message.msg_hdr, now) : time::Nanoseconds{0};
    const std::size_t bytes = message.msg_len;
    all.arrived[i] = {std::span(all.in.bytes[i]).first(std::min(bytes, kDatagramBytesMax)),
                      {bytes, from_asio(all.in.peers[i]), waited}};
  }
  return std::span(all.arrived).first(static_cast<std::size_t>(count));
}

bool UdpBatch::send(std::span<const std::byte> datagram, const Address& to) noexcept {
  if (datagram.size() > kDatagramBytesMax) return false;
  Storage& all = *storage_;
  if (all.waiting == kDatagramsMax) flush();
  const std::size_t i = all.waiting++;
  std::copy(datagram.begin(), datagram.end(), all.out.bytes[i].begin());
  all.out.parts[i].iov_len = datagram.size();
  all.out.peers[i] = to_asio(to);
  all.out.messages[i].msg_hdr.msg_namelen = static_cast<socklen_t>(all.out.peers[i].size());
  return true;
}

void UdpBatch::flush() noexcept {
  Storage& all = *storage_;
  for (std::size_t done = 0; done < all.waiting;) {
    const int sent = sendmmsg(link_.descriptor(), all.out.messages.data() + done,
                              static_cast<unsigned>(all.waiting - done), MSG_DONTWAIT);
    // sendmmsg stops at the first that fails; the others may have another destination.
    if (sent <= 0) link_.count_send_failed();
    done += sent <= 0 ? 1 : static_cast<std::size_t>(sent);
  }
  all.waiting = 0;
}

}  // namespace forcebound::net
