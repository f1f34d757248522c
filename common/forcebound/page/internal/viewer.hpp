#pragma once

#include <algorithm>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket.hpp>
#include <deque>
#include <memory>
#include <utility>

#include "forcebound/page/internal/owner.hpp"
#include "forcebound/page/subject.hpp"

namespace forcebound::page::internal {

namespace websocket = beast::websocket;

/// One viewer's WebSocket. It lives as long as an operation of it is under way.
class Viewer : public std::enable_shared_from_this<Viewer> {
 public:
  Viewer(ViewerId id, beast::tcp_stream stream, Owner& owner)
      : id_(id),
        owner_(owner),
        limits_(owner.settings().limits),
        stream_(std::move(stream)),
        received_(limits_.message_bytes + kFrameBytes),
        allowance_(limits_.messages_at_once) {}

  [[nodiscard]] ViewerId id() const noexcept { return id_; }
  [[nodiscard]] bool open() const noexcept { return open_; }

  void start(const Request& request) {
    beast::get_lowest_layer(stream_).expires_never();
    // A viewer that answers no ping for as long as it may stall is gone.
    stream_.set_option(websocket::stream_base::timeout{limits_.request, 2 * limits_.stalled, true});
    stream_.read_message_max(limits_.message_bytes);
    stream_.text(true);
    stream_.auto_fragment(false);
    stream_.async_accept(request, [self = shared_from_this()](beast::error_code error) {
      if (error) return self->leave(error);
      self->open_ = true;
      self->owner_.joined(*self);
      self->read();
    });
  }

  void send(const Text& text, Worth worth) {
    if (!open_) return;
    if (worth == Worth::stream && waiting_bytes_ > limits_.stream_bytes) return owner_.count_skipped();
    if (waiting_bytes_ > limits_.needed_bytes) return drop();
    waiting_bytes_ += text->size();
    waiting_.push_back(text);
    if (waiting_.size() == 1) write();
  }

  /// 60 times a second.
  void beat() {
    allowance_ = std::min(allowance_ + limits_.messages_per_beat, limits_.messages_at_once);
    if (paused_) {
      paused_ = false;
      read();
    }
    beats_stalled_ = waiting_.empty() ? 0 : beats_stalled_ + 1;
    if (beats_stalled_ > limits_.stalled.count() * kBeatsPerSecond) drop();
  }

  void close() noexcept { beast::get_lowest_layer(stream_).close(); }

 private:
  static constexpr std::size_t kFrameBytes = 256;

  void read() {
    if (!open_) return;
    if (allowance_ == 0) {
      // Not read, it waits in the sender's buffers, and then the sender itself.
      paused_ = true;
      return;
    }
    --allowance_;
    stream_.async_read(received_, [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (error) return self->leave(error);
      const std::string_view text(static_cast<const char*>(self->received_.data().data()), self->received_.size());
      if (self->stream_.got_text()) self->owner_.received(*self, text);
      self->received_.consume(self->received_.size());
      self->read();
    });
  }

  void write() {
    const Text& text = waiting_.front();
    stream_.async_write(asio::buffer(*text), [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (error) return self->leave(error);
      self->beats_stalled_ = 0;
      self->waiting_bytes_ -= self->waiting_.front()->size();
      self->waiting_.pop_front();
      if (!self->waiting_.empty()) self->write();
    });
  }

  void drop() {
    if (!open_) return;
    leave(beast::error::timeout);
  }

  void leave(beast::error_code why) noexcept {
    const bool was_open = std::exchange(open_, false);
    // That of Beast too: no answer to a ping.
    if (was_open && why == beast::error::timeout) owner_.count_dropped();
    close();
    if (was_open || !reported_) owner_.left(*this);
    reported_ = true;
  }

  ViewerId id_;
  Owner& owner_;
  const Limits& limits_;
  // False: without compression, which we do not offer, and which takes seconds to compile.
  websocket::stream<beast::tcp_stream, false> stream_;
  beast::flat_buffer received_;
  std::size_t allowance_;
  bool open_ = false;
  bool reported_ = false;
  bool paused_ = false;
  std::deque<Text> waiting_;  // the first is being sent
  std::size_t waiting_bytes_ = 0;
  long beats_stalled_ = 0;
};

}  // namespace forcebound::page::internal
