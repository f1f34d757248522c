#include "tests/tools/lab/load/burst.hpp"

#include <netinet/in.h>
#include <netinet/udp.h>
#include <sys/socket.h>

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace forcebound::lab {

bool Burst::add(std::span<const std::byte> datagram) noexcept {
  if (count_ == kDatagramsMax || datagram.size() > net::kDatagramBytesMax) return false;
  if (count_ > 0 && datagram.size() != each_bytes_) return false;
  each_bytes_ = datagram.size();
  std::copy(datagram.begin(), datagram.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(count_ * each_bytes_));
  ++count_;
  return true;
}

bool Burst::send(net::UdpLink& link, const net::Address& to) noexcept {
  const std::span<const std::byte> all = std::span(bytes_).first(count_ * each_bytes_);
  const bool alone = count_ == 1;
  count_ = 0;
  if (alone) return link.send(all, to);

  iovec part{const_cast<std::byte*>(all.data()), all.size()};  // the system only reads it
  const auto segment = static_cast<std::uint16_t>(each_bytes_);
  alignas(cmsghdr) std::array<std::byte, CMSG_SPACE(sizeof segment)> control{};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  cmsghdr* told = CMSG_FIRSTHDR(&message);
  told->cmsg_level = SOL_UDP;
  told->cmsg_type = UDP_SEGMENT;
  told->cmsg_len = CMSG_LEN(sizeof segment);
  std::memcpy(CMSG_DATA(told), &segment, sizeof segment);
  return sendmsg(link.descriptor(), &message, MSG_DONTWAIT) >= 0;
}

}  // namespace forcebound::lab
