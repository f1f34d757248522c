#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

/// What a page asks of a program: README.md.
namespace forcebound::page {

/// The hand is pointed to a place [m] of the scene's frame; axes that are not given are zero.
struct HandAt {
  std::array<double, 3> point_m{};
};
struct HandFree {};
struct Button {
  int index = 0;
  bool down = false;
};

/// A network that is emulated, each way.
struct Network {
  double delay_ms = 0;
  double jitter_ms = 0;
  double loss_percent = 0;
  friend bool operator==(const Network&, const Network&) = default;
};

/// Another value of a setting: a name, a number, a network or nothing.
struct Choose {
  std::string setting;
  std::variant<std::monostate, std::string, double, Network> value{};
};
struct Record {
  bool on = false;
};
struct Kick {
  std::uint64_t session = 0;
};
struct Seek {
  double time_s = 0;
};
struct Play {
  bool on = true;
  double speed = 1;
};

using Request = std::variant<HandAt, HandFree, Button, Choose, Record, Kick, Seek, Play>;

/// Reads a viewer's message. Nothing: a kind that is not known here, which is passed over.
/// @throws std::invalid_argument with what is wrong and what would be accepted
[[nodiscard]] std::optional<Request> read_request(std::string_view text);

}  // namespace forcebound::page
