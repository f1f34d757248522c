#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "forcebound/record/topics.hpp"

/// The messages of Foxglove's WebSocket protocol, as far as it is spoken here: github.com/foxglove/ws-protocol,
/// docs/spec.md.
namespace forcebound::live {

inline constexpr const char* kFoxgloveSubprotocol = "foxglove.websocket.v1";

/// The encoding of calls.
inline constexpr const char* kJson = "json";

/// What a viewer may ask for: {"value": ...}. Its id is its place in a list, from 1.
struct Service {
  std::string name;    ///< "/choose/law"
  std::string schema;  ///< of the value, in JSON Schema
};

enum class StatusLevel : std::uint8_t { info, warning, error };

// What is sent.

[[nodiscard]] std::string server_info(const std::string& name, bool has_services);
/// Their ids are their places in the list, from 1.
[[nodiscard]] std::string advertise(const std::vector<record::Topic>& topics);
[[nodiscard]] std::string advertise_services(const std::vector<Service>& services);
[[nodiscard]] std::string status(StatusLevel level, const std::string& text);
[[nodiscard]] std::string message_data(std::uint32_t subscription, const record::TopicMessage& message);

/// A call of a service, as it is answered.
struct CallNumber {
  std::uint32_t service = 0;
  std::uint32_t call = 0;
};
[[nodiscard]] std::string call_response(CallNumber number);  ///< binary: {}
[[nodiscard]] std::string call_failure(CallNumber number, const std::string& why);

// What is received.

struct Subscription {
  std::uint32_t id = 0;
  std::uint32_t channel = 0;
};
struct Subscribe {
  std::vector<Subscription> subscriptions{};
};
struct Unsubscribe {
  std::vector<std::uint32_t> subscriptions{};
};

/// @throws std::invalid_argument with what is wrong and what would be accepted
[[nodiscard]] std::variant<Subscribe, Unsubscribe> read_text(std::string_view text);

struct Call {
  CallNumber number{};
  std::string encoding{};
  std::string request{};
};

/// @throws std::invalid_argument likewise
[[nodiscard]] Call read_binary(std::string_view content);

}  // namespace forcebound::live
