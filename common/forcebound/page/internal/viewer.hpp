#pragma once

#include <deque>
#include <memory>
#include <utility>

#include "forcebound/page/internal/owner.hpp"
#include "forcebound/page/subject.hpp"

namespace forcebound::page::internal {

/// Who is sent what a subject shows, and what waits for it. It lives as long as an operation of it is under way.
class Viewer : public std::enable_shared_from_this<Viewer> {
 public:
  Viewer(ViewerId id, beast::tcp_stream stream, Owner& owner, Audience audience)
      : id_(id), owner_(owner), limits_(owner.settings().limits), audience_(audience), tcp_(std::move(stream)) {
    tcp_.expires_never();
  }
  virtual ~Viewer() = default;
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;

  [[nodiscard]] ViewerId id() const noexcept { return id_; }
  [[nodiscard]] Audience audience() const noexcept { return audience_; }

  virtual void start(const Request& request) = 0;

  void send(const Text& text, Worth worth, Form form) {
    if (!open_) return;
    if (worth == Worth::stream && waiting_bytes_ > limits_.stream_bytes) return owner_.count_skipped();
    if (waiting_bytes_ > limits_.needed_bytes) return drop();
    waiting_bytes_ += text->size();
    waiting_.push_back({text, form});
    if (waiting_.size() == 1) write(waiting_.front());
  }

  /// 60 times a second.
  virtual void beat() {
    beats_stalled_ = waiting_.empty() ? 0 : beats_stalled_ + 1;
    if (beats_stalled_ > limits_.stalled.count() * kBeatsPerSecond) drop();
  }

 protected:
  struct Waiting {
    Text text;
    Form form = Form::text;
  };

  /// Begins to send it; then `written` is to be called.
  virtual void write(const Waiting& first) = 0;

  void written(beast::error_code error) {
    if (error) return leave(error);
    beats_stalled_ = 0;
    waiting_bytes_ -= waiting_.front().text->size();
    waiting_.pop_front();
    if (!waiting_.empty()) write(waiting_.front());
  }

  void join() {
    open_ = true;
    owner_.joined(*this);
  }

  void leave(beast::error_code why) noexcept {
    const bool was_open = std::exchange(open_, false);
    // That of Beast too: no answer to a ping.
    if (was_open && why == beast::error::timeout) owner_.count_dropped();
    tcp_.close();
    if (was_open || !reported_) owner_.left(*this);
    reported_ = true;
  }

  [[nodiscard]] bool open() const noexcept { return open_; }
  [[nodiscard]] Owner& owner() const noexcept { return owner_; }
  [[nodiscard]] const Limits& limits() const noexcept { return limits_; }
  [[nodiscard]] beast::tcp_stream& tcp() noexcept { return tcp_; }

 private:
  void drop() {
    if (!open_) return;
    leave(beast::error::timeout);
  }

  ViewerId id_;
  Owner& owner_;
  const Limits& limits_;
  Audience audience_;
  beast::tcp_stream tcp_;
  bool open_ = false;
  bool reported_ = false;
  std::deque<Waiting> waiting_;  // the first is being sent
  std::size_t waiting_bytes_ = 0;
  long beats_stalled_ = 0;
};

}  // namespace forcebound::page::internal
