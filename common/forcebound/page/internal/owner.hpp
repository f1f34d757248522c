#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "forcebound/page/page_settings.hpp"
#include "forcebound/page/request_check.hpp"

/// Private to page_server.cpp, which alone includes Boost.Beast: it takes long to compile.
namespace forcebound::page::internal {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;

using Request = http::request<http::empty_body>;

class Connection;
class Viewer;

/// Whose subject a viewer is shown: the page's, or that of the subprotocol which it speaks.
enum class Audience : std::uint8_t { page, subprotocol };

/// A message's kind of frame.
enum class Form : std::uint8_t { text, binary };

/// How a viewer gets messages.
enum class Way : std::uint8_t { socket, lines };

/// What connections need of the server. All on its thread.
class Owner {
 public:
  virtual ~Owner() = default;
  [[nodiscard]] virtual const PageSettings& settings() const noexcept = 0;
  [[nodiscard]] virtual const HostCheck& hosts() const noexcept = 0;
  [[nodiscard]] virtual std::string metrics() = 0;
  virtual void answered(bool refused) noexcept = 0;

  /// It has shown the token: from now on it is not ended to make room for another.
  virtual void let_in(Connection& connection) noexcept = 0;
  virtual void connection_ended(Connection& connection) noexcept = 0;

  /// The subprotocol that has a subject of its own; empty: there is none.
  [[nodiscard]] virtual const std::string& subprotocol() const noexcept = 0;

  /// A viewer takes over the connection.
  virtual void admit(beast::tcp_stream stream, const Request& request, Way way, Audience audience) = 0;
  [[nodiscard]] virtual bool has_room_for_viewer() const noexcept = 0;
  virtual void joined(Viewer& viewer) = 0;
  virtual void left(Viewer& viewer) noexcept = 0;
  virtual void received(Viewer& viewer, std::string_view content, Form form) = 0;
  virtual void count_skipped() noexcept = 0;
  virtual void count_dropped() noexcept = 0;
};

}  // namespace forcebound::page::internal
