#pragma once

#include <array>
#include <boost/asio/write.hpp>
#include <boost/beast/http/chunk_encode.hpp>
#include <memory>
#include <string>
#include <string_view>

#include "forcebound/page/internal/viewer.hpp"

namespace forcebound::page::internal {

/// A viewer by HTTP that reads a line for each message, and says nothing.
class LineViewer final : public Viewer {
 public:
  using Viewer::Viewer;

  void start(const Request&) override {
    static constexpr std::string_view kHead =
        "HTTP/1.1 200 OK\r\nContent-Type: application/x-ndjson\r\nCache-Control: no-store\r\n"
        "X-Content-Type-Options: nosniff\r\nConnection: close\r\nTransfer-Encoding: chunked\r\n\r\n";
    asio::async_write(tcp(), asio::buffer(kHead), [self = shared()](beast::error_code error, std::size_t) {
      if (error) return self->leave(error);
      self->join();
      self->wait_for_end();
    });
  }

 private:
  std::shared_ptr<LineViewer> shared() { return std::static_pointer_cast<LineViewer>(shared_from_this()); }

  /// Whoever says something more is not one of these.
  void wait_for_end() {
    tcp().async_read_some(asio::buffer(said_), [self = shared()](beast::error_code error, std::size_t) {
      self->leave(error ? error : http::error::unexpected_body);
    });
  }

  void write(const Waiting& first) override {
    static constexpr std::string_view kEnd = "\n";
    const std::array<asio::const_buffer, 2> line{asio::buffer(*first.text), asio::buffer(kEnd)};
    asio::async_write(tcp(), http::make_chunk(line),
                      [self = shared()](beast::error_code error, std::size_t) { self->written(error); });
  }

  std::array<char, 1> said_{};
};

}  // namespace forcebound::page::internal
