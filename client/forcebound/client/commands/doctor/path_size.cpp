#include "forcebound/client/commands/doctor/path_size.hpp"

#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>

namespace forcebound::client::commands {
namespace {

constexpr std::size_t kHeaderBytes_v4 = 28;
constexpr std::size_t kHeaderBytes_v6 = 48;

/// net::Address has them mapped into IPv6.
bool is_v4(const net::Address& address) noexcept {
  constexpr std::array<std::uint8_t, 12> kMapped{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff};
  return std::equal(kMapped.begin(), kMapped.end(), address.ip.begin());
}

// So that one value serves both.
static_assert(IP_PMTUDISC_PROBE == IPV6_PMTUDISC_PROBE && IP_PMTUDISC_WANT == IPV6_PMTUDISC_WANT);

}  // namespace

std::size_t header_bytes(const net::Address& peer) noexcept { return is_v4(peer) ? kHeaderBytes_v4 : kHeaderBytes_v6; }

void set_fragments(const net::UdpLink& link, const net::Address& peer, Fragments fragments) noexcept {
  const bool v4 = is_v4(peer);
  const int wanted = fragments == Fragments::never ? IP_PMTUDISC_PROBE : IP_PMTUDISC_WANT;
  setsockopt(link.descriptor(), v4 ? IPPROTO_IP : IPPROTO_IPV6, v4 ? IP_MTU_DISCOVER : IPV6_MTU_DISCOVER, &wanted,
             sizeof wanted);
}

std::optional<std::size_t> believed_mtu(const net::UdpLink& link, const net::Address& peer) noexcept {
  const bool v4 = is_v4(peer);
  int mtu = 0;
  socklen_t bytes = sizeof mtu;
  if (getsockopt(link.descriptor(), v4 ? IPPROTO_IP : IPPROTO_IPV6, v4 ? IP_MTU : IPV6_MTU, &mtu, &bytes) != 0 ||
      mtu <= 0) {
    return std::nullopt;
  }
  return static_cast<std::size_t>(mtu);
}

std::size_t largest_that_passes(const SizeRange& range, std::size_t resolution,
                                const std::function<bool(std::size_t)>& passes) {
  if (passes(range.most)) return range.most;
  if (range.least >= range.most || !passes(range.least)) return 0;
  std::size_t fits = range.least;
  std::size_t too_large = range.most;
  while (too_large - fits > std::max<std::size_t>(resolution, 1)) {
    const std::size_t tried = fits + (too_large - fits) / 2;
    (passes(tried) ? fits : too_large) = tried;
  }
  return fits;
}

}  // namespace forcebound::client::commands
