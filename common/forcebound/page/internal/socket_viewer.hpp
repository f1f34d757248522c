#pragma once

#include <algorithm>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket.hpp>
#include <memory>
#include <string_view>

#include "forcebound/page/internal/viewer.hpp"

namespace forcebound::page::internal {

namespace websocket = beast::websocket;

/// A viewer by WebSocket, which may answer.
class SocketViewer final : public Viewer {
 public:
  SocketViewer(ViewerId id, beast::tcp_stream stream, Owner& owner, Audience audience)
      : Viewer(id, std::move(stream), owner, audience),
        stream_(tcp()),
        received_(limits().message_bytes + kFrameBytes),
        allowance_(limits().messages_at_once) {}

  void start(const Request& request) override {
    // A viewer that answers no ping for as long as it may stall is gone.
    stream_.set_option(websocket::stream_base::timeout{limits().request, 2 * limits().stalled, true});
    stream_.read_message_max(limits().message_bytes);
    stream_.auto_fragment(false);
    if (audience() == Audience::subprotocol) {
      const std::string name = owner().subprotocol();
      stream_.set_option(websocket::stream_base::decorator(
          [name](websocket::response_type& response) { response.set(http::field::sec_websocket_protocol, name); }));
    }
    stream_.async_accept(request, [self = shared()](beast::error_code error) {
      if (error) return self->leave(error);
      self->join();
      self->read();
    });
  }

  void beat() override {
    allowance_ = std::min(allowance_ + limits().messages_per_beat, limits().messages_at_once);
    if (paused_) {
      paused_ = false;
      read();
    }
    Viewer::beat();
  }

 private:
  static constexpr std::size_t kFrameBytes = 256;

  std::shared_ptr<SocketViewer> shared() { return std::static_pointer_cast<SocketViewer>(shared_from_this()); }

  void read() {
    if (!open()) return;
    if (allowance_ == 0) {
      // Not read, it waits in the sender's buffers, and then the sender itself.
      paused_ = true;
      return;
    }
    --allowance_;
    stream_.async_read(received_, [self = shared()](beast::error_code error, std::size_t) {
      if (error) return self->leave(error);
      const std::string_view content(static_cast<const char*>(self->received_.data().data()), self->received_.size());
      self->owner().received(*self, content, self->stream_.got_text() ? Form::text : Form::binary);
      self->received_.consume(self->received_.size());
      self->read();
    });
  }

  void write(const Waiting& first) override {
    stream_.binary(first.form == Form::binary);
    stream_.async_write(asio::buffer(*first.text),
                        [self = shared()](beast::error_code error, std::size_t) { self->written(error); });
  }

  // False: without compression, which we do not offer, and which takes seconds to compile.
  websocket::stream<beast::tcp_stream&, false> stream_;
  beast::flat_buffer received_;
  std::size_t allowance_;
  bool paused_ = false;
};

}  // namespace forcebound::page::internal
