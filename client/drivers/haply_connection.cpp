#include "haply_connection.hpp"

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket.hpp>
#include <exception>

namespace forcebound::haply {

namespace asio = boost::asio;
namespace beast = boost::beast;
using Tcp = asio::ip::tcp;

struct Connection::Socket {
  asio::io_context io{1};
  beast::websocket::stream<Tcp::socket> stream{io};
  beast::flat_buffer received{kMessageBytesMost};
  beast::error_code error{};
  bool pending = false;
};

Connection::Connection() = default;
Connection::~Connection() { drop(); }

/// Runs what was begun. False, and the connection is closed, if it fails or is not done in time.
bool Connection::wait(Limit limit) {
  socket_->io.restart();
  socket_->io.run_for(limit);
  if (!socket_->pending && !socket_->error) return true;
  why_ = socket_->pending ? "no answer within " + std::to_string(limit.count()) + " ms" : socket_->error.message();
  return false;
}

bool Connection::open(const std::string& address, std::uint16_t port, Limit limit) {
  try {
    drop();
    socket_ = std::make_unique<Socket>();
    Socket& here = *socket_;
    const Tcp::endpoint service(asio::ip::make_address(address), port);
    here.pending = true;
    here.stream.next_layer().async_connect(service, [&here](beast::error_code error) {
      here.error = error;
      here.pending = false;
    });
    if (!wait(limit)) {
      drop();
      return false;
    }
    here.stream.next_layer().set_option(Tcp::no_delay(true));
    here.stream.read_message_max(kMessageBytesMost);
    here.stream.text(true);
    here.pending = true;
    here.stream.async_handshake(address + ":" + std::to_string(port), "/", [&here](beast::error_code error) {
      here.error = error;
      here.pending = false;
    });
    if (wait(limit)) return true;
  } catch (const std::exception& error) {
    why_ = error.what();
  }
  drop();
  return false;
}

bool Connection::send(std::string_view text, Limit limit) {
  if (!socket_) return false;
  Socket& here = *socket_;
  here.pending = true;
  here.stream.async_write(asio::buffer(text.data(), text.size()), [&here](beast::error_code error, std::size_t) {
    here.error = error;
    here.pending = false;
  });
  if (wait(limit)) return true;
  drop();
  return false;
}

std::optional<std::string_view> Connection::receive(Limit limit) {
  if (!socket_) return std::nullopt;
  Socket& here = *socket_;
  here.received.consume(here.received.size());
  here.pending = true;
  here.stream.async_read(here.received, [&here](beast::error_code error, std::size_t) {
    here.error = error;
    here.pending = false;
  });
  if (!wait(limit)) return std::nullopt;
  return std::string_view(static_cast<const char*>(here.received.data().data()), here.received.size());
}

void Connection::close(std::string_view last) noexcept {
  try {
    if (socket_ && !last.empty()) {
      Socket& here = *socket_;
      // Beside a read that may be under way still.
      here.stream.async_write(asio::buffer(last.data(), last.size()), [](beast::error_code, std::size_t) {});
      here.io.restart();
      here.io.run_for(kLast);
    }
  } catch (const std::exception& error) {
    why_ = error.what();
  }
  drop();
}

/// What is under way ends before its buffers do.
void Connection::drop() noexcept {
  if (!socket_) return;
  beast::error_code ignored;
  socket_->stream.next_layer().close(ignored);
  try {
    socket_->io.restart();
    socket_->io.poll();
  } catch (const std::exception& error) {
    why_ = error.what();
  }
  socket_.reset();
}

}  // namespace forcebound::haply
