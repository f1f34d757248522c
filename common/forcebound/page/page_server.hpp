#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "forcebound/page/page_settings.hpp"
#include "forcebound/page/subject.hpp"

namespace forcebound::page {

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
///     GET /live?token=T      upgrade to a WebSocket: text messages between a viewer and the subject. Without upgrade:
///                            the subject's messages, one a line, in chunks
///     GET /?token=T          upgrade to a WebSocket: the same; also of the subprotocol, which has its own subject
///
/// Refused, each with one line of text: 400 what is no HTTP or is too long, 401 without the token, 403 by a host or
/// origin that is not ours, but for the subprotocol, 404, 405 all but GET, 413 a request with a body, 429 more viewers
/// than may be, 431 headers too long, 505 lines by HTTP/1.0, 503 the oldest of more connections than may be, those that
/// have shown the token left out. No request names a path of the file system.
class PageServer {
 public:
  using Settings = PageSettings;

  /// Listens and starts the thread. The subjects must outlive it.
  /// @throws std::runtime_error naming the address and why it cannot be listened at
  PageServer(const Settings& settings, Subject& subject, const Subprotocol& subprotocol = {});
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
