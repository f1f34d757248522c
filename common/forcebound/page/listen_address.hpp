#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "forcebound/page/page_server.hpp"

namespace forcebound::page {

/// The ports of the pages of a client, a server and a recording unless others are given: on one machine all may be
/// open.
inline constexpr std::uint16_t kClientPort = 47880;
inline constexpr std::uint16_t kServerPort = 47881;
inline constexpr std::uint16_t kRecordingPort = 47882;

/// Where a page is served.
struct ListenAddress {
  std::string host{"127.0.0.1"};
  std::uint16_t port = 0;
};

/// Reads PORT, of this machine alone, or HOST:PORT; empty: port `standard` of this machine.
/// @throws std::invalid_argument naming the text and what would be accepted
[[nodiscard]] ListenAddress parse_listen_address(std::string_view text, std::uint16_t standard);

/// Why there is no page beside this program, and how to get it, in one line; empty: its files are there.
[[nodiscard]] std::string missing_page(const std::string& program_path);

/// A page at this address with the token of FORCEBOUND_PAGE_TOKEN in the environment, else a new random one. Where its
/// files are missing the page is what `missing_page` says.
/// @throws std::runtime_error if its files cannot be read, that token is none, or the system gives no random bytes
[[nodiscard]] PageServer::Settings page_settings(const ListenAddress& at, const std::string& program_path);

/// A page's address as a program prints it: without the token where it came by the environment, since logs are read by
/// more people than the environment.
[[nodiscard]] std::string printed_address(const std::string& address);

}  // namespace forcebound::page
