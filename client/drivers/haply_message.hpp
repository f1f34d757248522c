#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace forcebound::haply {

/// x, y, z in the Inverse service's frame: x to the user's right, y away from the user, z up [m], [N]. These are the
/// directions of the scene's axes; the origin is at the device's base.
using Axes = std::array<double, 3>;

/// How a force is spelled: `set_cursor_force` has a `vector` for 3.5 and `values` for 3.1.
enum class Spelling { automatic, vector, values };

/// The first message of a service.
struct Inventory {
  std::vector<std::string> device_ids{};  ///< of the Inverse3 devices, in the service's order
  bool has_sessions = false;              ///< it numbers its sessions, as 3.5 does
};

struct State {
  Axes position_m{};
  bool has_orientation = false;
  bool has_buttons = false;
  std::uint32_t buttons = 0;                      ///< bit 0: a, or the only one; then b, c and the fourth
  std::array<double, 4> orientation{1, 0, 0, 0};  ///< unit quaternion w, x, y, z
};

enum class Answer {
  state,          ///< of the device
  gone,           ///< the device is not among those listed
  not_understood  ///< no JSON, or without a position of finite numbers
};

/// Nothing: it is not what a service of version 3.1 or later begins with.
[[nodiscard]] std::optional<Inventory> parse_inventory(std::string_view text);

/// Any text is accepted. `state` is written only if the answer is one.
[[nodiscard]] Answer parse_state(std::string_view text, const std::string& device_id, State& state);

/// Ids in commands are made of letters, digits, '-' and '_' alone, so that they need no escapes.
[[nodiscard]] bool is_device_id(std::string_view text);

struct Command {
  std::string_view device_id;
  Axes force_N{};
  Spelling spelling = Spelling::vector;  ///< automatic: as vector
  bool introduces = false;  ///< the first of a session: who sends it, and that the axes are the service's own
};

/// Written over `text`, whose memory is used again.
void write_command(const Command& command, std::string& text);

}  // namespace forcebound::haply
