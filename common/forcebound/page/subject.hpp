#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace forcebound::page {

/// A browser that looks at a page: 1, 2, 3, ... in the order of their coming.
using ViewerId = std::uint64_t;

/// A message for viewers, shared by all that wait to be sent.
using Text = std::shared_ptr<const std::string>;

/// What becomes of a message for a viewer that does not read fast enough.
enum class Worth : std::uint8_t {
  stream,  ///< left out, and counted: a newer one follows soon
  needed,  ///< kept; a viewer for which too much waits is disconnected
};

/// Whom a page can be sent to: those who look at one subject. For the functions of `Subject` alone.
class Viewers {
 public:
  virtual ~Viewers() = default;
  virtual void send(ViewerId viewer, Text text, Worth worth) = 0;
  virtual void send_binary(ViewerId viewer, Text content, Worth worth) = 0;
  virtual void send_to_all(Text text, Worth worth) = 0;
  [[nodiscard]] virtual std::size_t count() const noexcept = 0;
};

/// What a page shows and what it may ask for. All is called on the page's own thread, one after the other. An exception
/// is counted and otherwise passed over.
class Subject {
 public:
  virtual ~Subject() = default;

  /// A viewer came.
  virtual void greet(ViewerId viewer, Viewers& viewers) = 0;

  /// What a viewer sent: any text at all, up to the limit on a message.
  virtual void receive(ViewerId viewer, std::string_view text, Viewers& viewers) = 0;

  /// The same as a binary message.
  virtual void receive_binary(ViewerId viewer, std::string_view content, Viewers& viewers) {
    (void)viewer, (void)content, (void)viewers;
  }

  /// A viewer left, also while something was sent to it: to be taken note of, with nothing sent to anybody.
  virtual void leave(ViewerId viewer) noexcept { (void)viewer; }

  /// 60 times a second, viewers or not.
  virtual void beat(Viewers& viewers) = 0;

  /// The figures of this moment in the text format of Prometheus.
  [[nodiscard]] virtual std::string metrics() = 0;
};

/// What those are shown who speak a subprotocol of WebSocket. Its metrics are not asked for.
struct Subprotocol {
  std::string name{};
  Subject* subject = nullptr;  ///< null: there is none
};

}  // namespace forcebound::page
