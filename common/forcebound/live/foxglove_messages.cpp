#include "forcebound/live/foxglove_messages.hpp"

#include <nlohmann/json.hpp>
#include <span>
#include <stdexcept>

#include "forcebound/page/json_member.hpp"
#include "forcebound/record/mcap_format.hpp"
#include "forcebound/security/base64.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::live {
namespace {

using Json = nlohmann::json;

// Of binary messages.
constexpr char kMessageData = 0x01;
constexpr char kCallRequest = 0x02;
constexpr char kCallResponse = 0x03;

std::string dumped(const Json& message) { return message.dump(-1, ' ', false, Json::error_handler_t::replace); }

std::string shown(const Json& value) {
  constexpr std::size_t kMost = 40;
  return text::printable(value.dump(-1, ' ', true, Json::error_handler_t::replace).substr(0, kMost));
}

std::uint32_t id_in(const Json& value, const char* name) {
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() > UINT32_MAX) {
    throw std::invalid_argument(std::string(name) + " is " + shown(value) + "; accepted is a whole number of 32 bits");
  }
  return value.get<std::uint32_t>();
}

const Json& list_in(const Json& message, const char* name) {
  const Json& list = page::json_member(message, name);
  if (!list.is_array()) throw std::invalid_argument(std::string(name) + " is " + shown(list) + "; accepted is a list");
  return list;
}

/// Takes a little-endian number from the front.
std::uint32_t take_number(std::string_view& bytes) {
  constexpr std::size_t kBits = 8;
  if (bytes.size() < sizeof(std::uint32_t)) throw std::invalid_argument("a binary message ends too early");
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < sizeof number; ++i) {
    number |= std::uint32_t{static_cast<unsigned char>(bytes[i])} << (kBits * i);
  }
  bytes.remove_prefix(sizeof number);
  return number;
}

}  // namespace

std::string server_info(const std::string& name, bool has_services) {
  Json capabilities = Json::array();
  if (has_services) capabilities.push_back("services");
  return dumped({{"op", "serverInfo"},
                 {"name", name},
                 {"capabilities", capabilities},
                 {"supportedEncodings", Json::array({kJson})}});
}

std::string advertise(const std::vector<record::Topic>& topics) {
  Json channels = Json::array();
  for (const record::Topic topic : topics) {
    const record::TopicInfo& info = record::info_of(topic);
    const std::string schema = record::schema_of(info.schema);
    channels.push_back({{"id", channels.size() + 1},
                        {"topic", info.name},
                        {"encoding", record::kProtobufEncoding},
                        {"schemaName", info.schema},
                        {"schemaEncoding", record::kProtobufEncoding},
                        {"schema", security::base64_of(std::as_bytes(std::span(schema)))}});
  }
  return dumped({{"op", "advertise"}, {"channels", channels}});
}

std::string advertise_services(const std::vector<Service>& services) {
  const auto side = [](const std::string& name, const Json& schema) {
    return Json{{"encoding", kJson}, {"schemaName", name}, {"schemaEncoding", "jsonschema"}, {"schema", schema.dump()}};
  };
  Json list = Json::array();
  for (const Service& service : services) {
    const Json request{{"type", "object"},
                       {"properties", {{"value", Json::parse(service.schema)}}},
                       {"required", Json::array({"value"})}};
    list.push_back({{"id", list.size() + 1},
                    {"name", service.name},
                    {"type", service.name},
                    {"request", side(service.name + "_request", request)},
                    {"response", side(service.name + "_response", {{"type", "object"}})}});
  }
  return dumped({{"op", "advertiseServices"}, {"services", list}});
}

std::string status(StatusLevel level, const std::string& text) {
  return dumped({{"op", "status"}, {"level", static_cast<int>(level)}, {"message", text}});
}

std::string message_data(std::uint32_t subscription, const record::TopicMessage& message) {
  constexpr std::size_t kHead = 1 + sizeof subscription + sizeof(std::uint64_t);
  std::string bytes;
  bytes.reserve(kHead + message.content.size());
  bytes += kMessageData;
  record::mcap::put(bytes, subscription);
  record::mcap::put(bytes, static_cast<std::uint64_t>(message.at.count()));
  bytes += message.content;
  return bytes;
}

std::string call_response(CallNumber number) {
  std::string bytes{kCallResponse};
  record::mcap::put(bytes, number.service);
  record::mcap::put(bytes, number.call);
  record::mcap::put(bytes, std::string_view(kJson));
  return bytes + "{}";
}

std::string call_failure(CallNumber number, const std::string& why) {
  return dumped(
      {{"op", "serviceCallFailure"}, {"serviceId", number.service}, {"callId", number.call}, {"message", why}});
}

std::variant<Subscribe, Unsubscribe> read_text(std::string_view text) {
  const Json message = Json::parse(text, nullptr, false);
  if (!message.is_object()) throw std::invalid_argument("a message must be a JSON object");
  const Json& op = page::json_member(message, "op");
  if (op == "subscribe") {
    Subscribe wish;
    for (const Json& one : list_in(message, "subscriptions")) {
      if (!one.is_object()) throw std::invalid_argument("a subscription must have id and channelId");
      wish.subscriptions.push_back({.id = id_in(page::json_member(one, "id"), "id"),
                                    .channel = id_in(page::json_member(one, "channelId"), "channelId")});
    }
    return wish;
  }
  if (op == "unsubscribe") {
    Unsubscribe wish;
    for (const Json& one : list_in(message, "subscriptionIds")) {
      wish.subscriptions.push_back(id_in(one, "subscriptionIds"));
    }
    return wish;
  }
  throw std::invalid_argument("op is " + shown(op) + "; accepted are \"subscribe\" and \"unsubscribe\"");
}

Call read_binary(std::string_view content) {
  if (content.empty() || content.front() != kCallRequest) {
    throw std::invalid_argument("of binary messages calls of services, opcode 2, are accepted alone");
  }
  content.remove_prefix(1);
  Call call;
  call.number.service = take_number(content);
  call.number.call = take_number(content);
  const std::uint32_t encoding_bytes = take_number(content);
  if (encoding_bytes > content.size()) throw std::invalid_argument("a binary message ends too early");
  call.encoding = content.substr(0, encoding_bytes);
  call.request = content.substr(encoding_bytes);
  return call;
}

}  // namespace forcebound::live
