#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "forcebound/page/assets.hpp"
#include "forcebound/page/subject.hpp"

namespace forcebound::page {

/// Beats of `Subject` per second.
inline constexpr int kBeatsPerSecond = 60;

/// What viewers, and others who connect, may take.
struct Limits {
  std::size_t viewers = 4;
  std::size_t connections =
      128;  ///< at once, of requests that are not answered yet; then the oldest without token ends
  std::size_t connections_per_beat = 32;  ///< more wait
  std::size_t header_bytes = 8192;
  std::chrono::seconds request{5};     ///< until a request is there, and again until its answer is sent
  std::size_t message_bytes = 4096;    ///< of a viewer
  std::size_t messages_per_beat = 4;   ///< of each viewer; more wait unread, so that the sender waits too
  std::size_t messages_at_once = 240;  ///< after a pause
  std::size_t stream_bytes = std::size_t{256} << 10U;  ///< waiting for a viewer: beyond, Worth::stream is left out
  std::size_t needed_bytes = std::size_t{16} << 20U;   ///< likewise: beyond, it is disconnected
  std::chrono::seconds stalled{10};                    ///< so long a viewer may take nothing of what waits for it
};

/// Counts since the start.
struct Counts {
  std::uint64_t requests = 0;         ///< answered, refusals included
  std::uint64_t refused = 0;          ///< with a status of 400 or more
  std::uint64_t turned_away = 0;      ///< connections that were ended for want of room
  std::uint64_t viewers = 0;          ///< that came
  std::uint64_t viewers_dropped = 0;  ///< because they did not read
  std::uint64_t messages = 0;         ///< of viewers
  std::uint64_t skipped = 0;          ///< messages left out for viewers that read too slowly
  std::uint64_t faults = 0;           ///< exceptions of the subject
};

/// Serves a page and its messages by HTTP and WebSocket, on one port and one thread of its own.
///
///     GET /?token=T          the page, index.html of the assets
///     GET /NAME              an asset; no token
///     GET /metrics?token=T   the subject's figures; or the token by `Authorization: Bearer T`
///     GET /live?token=T      upgrade to a WebSocket: text messages between a viewer and the subject
///
/// Refused, each with one line of text: 400 what is no HTTP or is too long, 401 without the token, 403 by a host or
/// origin that is not ours, 404, 405 all but GET, 413 a request with a body, 429 more viewers than may be, 431 headers
/// too long, 503 the oldest of more connections than may be, those that have shown the token left out. No request names
/// a path of the file system.
class PageServer {
 public:
  struct Settings {
    std::string host{"127.0.0.1"};
    std::uint16_t port = 0;  ///< 0: a free one
    std::string token;       ///< of 32 hexadecimal digits, see token_of
    Assets assets{};
    Limits limits{};
  };

  /// Listens and starts the thread. `subject` must outlive it.
  /// @throws std::runtime_error naming the address and why it cannot be listened at
  PageServer(const Settings& settings, Subject& subject);
  ~PageServer();
  PageServer(const PageServer&) = delete;
  PageServer& operator=(const PageServer&) = delete;

  /// What a person opens: "http://127.0.0.1:47880/?token=...".
  [[nodiscard]] std::string address() const;
  [[nodiscard]] std::uint16_t port() const noexcept;

  /// Any thread.
  [[nodiscard]] Counts counts() const noexcept;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace forcebound::page
