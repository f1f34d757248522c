#include "forcebound/client/app/allocation.hpp"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "forcebound/net/endpoint.hpp"
#include "forcebound/page/json_member.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::client {
namespace {

using Json = nlohmann::json;

constexpr int kGood = 200;
constexpr const char* kPath = "/gameserverallocation";
/// The counter of a GameServer that has the number of sessions.
constexpr const char* kCounter = "sessions";
constexpr const char* kPortName = "forcebound";
constexpr std::size_t kShownMost = 200;

http::Url url_of(const Allocation& allocation) {
  http::Url url = http::parse_url(allocation.url);
  if (url.target == "/") url.target = kPath;
  return url;
}

/// Null: there is none.
const Json& port_in(const Json& answer) {
  const Json& ports = page::json_member(answer, "ports");
  static const Json kNone;
  if (!ports.is_array() || ports.empty()) return kNone;
  const Json* chosen = &ports.front();
  for (const Json& port : ports) {
    if (page::json_member(port, "name") == kPortName) chosen = &port;
  }
  return page::json_member(*chosen, "port");
}

/// @throws std::invalid_argument for what is no URL of an allocator, or if none can be asked
void expect_allocator(const std::string& url) {
  (void)http::parse_url(url);
  if (!http::refusal().empty()) throw std::invalid_argument(std::string(http::refusal()));
}

/// What the allocator says in words, or all that it says.
std::string words_in(const std::string& body) {
  const Json answer = Json::parse(body, nullptr, false);
  const bool has_message = answer.is_object() && answer.contains("message") && answer["message"].is_string();
  return text::printable((has_message ? answer["message"].get<std::string>() : body).substr(0, kShownMost));
}

}  // namespace

void add_allocation_options(CLI::App& app, Allocation& allocation) {
  std::string about = "ask this allocator of Agones for a server; where it has none, --server is used, if it is given";
  if (!http::refusal().empty()) about = "ask an allocator of Agones; not here: " + std::string(http::refusal());
  app.add_option("--allocate", allocation.url, about)->check(program::accepted_by(expect_allocator))->type_name("URL");
  app.add_option("--allocate-fleet", allocation.fleet, "with --allocate: of this fleet")
      ->needs("--allocate")
      ->check(program::not_empty())
      ->type_name("NAME");
  app.add_option("--allocate-namespace", allocation.name_space, "with --allocate: the fleet's namespace")
      ->needs("--allocate")
      ->check(program::not_empty())
      ->type_name("NAME")
      ->capture_default_str();
  app.add_option("--allocate-wait", allocation.wait_s, "with --allocate: longest wait for the allocator's answer")
      ->needs("--allocate")
      ->check(program::number_within(0.1, 60))
      ->type_name("SECONDS")
      ->capture_default_str();
  app.add_option("--allocate-ca", allocation.certificates.authority,
                 "with --allocate https://...: who signed the allocator's certificate; default: the system's list")
      ->needs("--allocate")
      ->check(program::not_empty())
      ->type_name("FILE.pem");
  app.add_option("--allocate-certificate", allocation.certificates.certificate,
                 "with --allocate https://...: our certificate, as the allocator of Agones wants one")
      ->needs("--allocate")
      ->check(program::not_empty())
      ->type_name("FILE.pem");
  app.add_option("--allocate-key", allocation.certificates.key, "with --allocate-certificate: its key")
      ->needs("--allocate-certificate")
      ->check(program::not_empty())
      ->type_name("FILE.pem");
}

void expect_complete(const Allocation& allocation) {
  if (!allocation.certificates.certificate.empty() && allocation.certificates.key.empty()) {
    throw std::invalid_argument("--allocate-certificate needs --allocate-key");
  }
}

std::string request_text(const Allocation& allocation) {
  Json labels = Json::object();
  if (!allocation.fleet.empty()) labels["agones.dev/fleet"] = allocation.fleet;
  // A server in use that has places left, before one that waits: others can be taken away.
  const Json in_use{
      {"matchLabels", labels}, {"gameServerState", "ALLOCATED"}, {"counters", {{kCounter, {{"minAvailable", "1"}}}}}};
  const Json waiting{{"matchLabels", labels}, {"gameServerState", "READY"}};
  const Json request{{"namespace", allocation.name_space},
                     {"gameServerSelectors", Json::array({in_use, waiting})},
                     // A place is taken until the client is there and the server counts it.
                     {"counters", {{kCounter, {{"action", "Increment"}, {"amount", "1"}}}}}};
  return request.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string server_of(const http::Response& answer) {
  if (answer.status != kGood) {
    throw std::runtime_error("HTTP status " + std::to_string(answer.status) + ": " + words_in(answer.body));
  }
  const Json reply = Json::parse(answer.body, nullptr, false);
  const Json& address = page::json_member(reply, "address");
  const Json& port = port_in(reply);
  if (!address.is_string() || address.get<std::string>().empty() || !port.is_number_unsigned()) {
    throw std::runtime_error("its answer has no address and port: " + words_in(answer.body));
  }
  const auto host = address.get<std::string>();
  const bool bare_v6 = host.find(':') != std::string::npos && !host.starts_with('[');
  std::string server = (bare_v6 ? "[" + host + "]" : host) + ":" + std::to_string(port.get<std::uint64_t>());
  try {
    (void)net::parse_peer(server);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(std::string("its answer names no server: ") + error.what());
  }
  return server;
}

std::string allocate(const Allocation& allocation) {
  const std::chrono::duration<double> wait(allocation.wait_s);
  const http::Response answer =
      http::ask(url_of(allocation), {"POST", request_text(allocation)},
                std::chrono::duration_cast<std::chrono::nanoseconds>(wait), allocation.certificates);
  return server_of(answer);
}

}  // namespace forcebound::client
