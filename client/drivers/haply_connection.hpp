#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace forcebound::haply {

/// A WebSocket to the Inverse service. Each call waits at most as long as it is told to; after one that failed `why`
/// says what happened, and all that helps is to close and open it. Used by one thread at a time.
class Connection {
 public:
  using Limit = std::chrono::milliseconds;

  /// How long a last message may take.
  static constexpr Limit kLast{1};

  /// Longer messages end the connection: the service's have about 2 KiB for each device.
  static constexpr std::size_t kMessageBytesMost = 65536;

  Connection();
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// @param address numeric
  bool open(const std::string& address, std::uint16_t port, Limit limit);
  bool send(std::string_view text, Limit limit);

  /// Valid until the next call; nothing: none came.
  [[nodiscard]] std::optional<std::string_view> receive(Limit limit);

  /// Sends a last message if one more can be sent at once.
  void close(std::string_view last = {}) noexcept;

  [[nodiscard]] const std::string& why() const noexcept { return why_; }

 private:
  struct Socket;
  bool wait(Limit limit);
  void drop() noexcept;

  std::unique_ptr<Socket> socket_;
  std::string why_;
};

}  // namespace forcebound::haply
