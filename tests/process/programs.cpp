#include "tests/process/programs.hpp"

#include <algorithm>
#include <asio/io_context.hpp>
#include <asio/ip/tcp.hpp>
#include <asio/ip/udp.hpp>
#include <cstdint>
#include <random>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace forcebound::test {

const char* const kForcebound = FORCEBOUND;
const char* const kServer = FORCEBOUND_SERVER;
const char* const kClient = FORCEBOUND_CLIENT;
const char* const kRelay = FORCEBOUND_RELAY;
const char* const kLab = FORCEBOUND_LAB;
#ifdef FORCEBOUND_ROS2
const char* const kRos2 = FORCEBOUND_ROS2;
#else
const char* const kRos2 = nullptr;
#endif

namespace {

Words with(Words first, const Words& more) {
  first.insert(first.end(), more.begin(), more.end());
  return first;
}

/// The forces are the server's and no scene is kept in the user's cache, unless a test says otherwise.
Words with_rendering(Words words) {
  if (std::ranges::find(words, "--rendering") == words.end()) words = with(std::move(words), {"--rendering", "remote"});
  if (std::ranges::find(words, "--scene-cache") == words.end())
    words = with(std::move(words), {"--scene-cache", "none"});
  return words;
}

}  // namespace

Listener::Listener(const char* program, const Words& arguments, const std::string& at)
    : Process(program, with({"--listen", at}, arguments)) {
  wait_for("listening on ");
  static const std::regex kAddress(R"(listening on (\d+\.\d+\.\d+\.\d+:\d+)\b)");
  const std::string output = out() + err();
  std::smatch match;
  if (!std::regex_search(output, match, kAddress)) {
    throw std::runtime_error(std::string(program) + " does not listen; it said: " + output);
  }
  address_ = match[1];
}

Relay::Relay(const std::string& upstream, const Words& arguments)
    : Listener(kRelay, with({"--upstream", upstream}, arguments)) {}

void Relay::let_everything_arrive() { std::this_thread::sleep_for(std::chrono::seconds{2}); }

Client::Client(const std::string& server, const Words& arguments)
    : Process(kClient, with_rendering(
                           with({"--server", server, "--summary", summary_folder_.file("summary.json")}, arguments))) {}

int Client::expected_end() const {
  constexpr int kNotPassive = 3;
  constexpr int kNeverConnected = 5;
  const nlohmann::json ended = summary();
  const std::string verdict = ended.is_object() ? ended.value("verdict", "") : "";
  if (verdict == "not passive") return kNotPassive;
  return verdict == "never connected" ? kNeverConnected : 0;
}

Ran run(const char* program, const Words& arguments, std::chrono::nanoseconds limit) {
  Process process(program, arguments);
  const auto exit_code = process.wait(limit);
  return {exit_code.value_or(-1), process.out(), process.err()};
}

std::string free_address() {
  // Below those that the system gives to connections, which would otherwise take it meanwhile (net.ipv4.
  // ip_local_port_range begins at 32768). Each process begins elsewhere.
  constexpr unsigned kFirst = 20'000;
  constexpr unsigned kPorts = 12'000;
  static unsigned next = std::random_device()() % kPorts;
  asio::io_context context;
  for (unsigned i = 0; i < kPorts; ++i) {
    const auto port = static_cast<std::uint16_t>(kFirst + next++ % kPorts);
    const asio::ip::address host = asio::ip::address_v4::loopback();
    asio::error_code in_use;
    asio::ip::udp::socket datagrams(context, asio::ip::udp::v4());
    (void)datagrams.bind({host, port}, in_use);
    if (in_use) continue;
    asio::ip::tcp::acceptor connections(context, asio::ip::tcp::v4());
    (void)connections.bind({host, port}, in_use);
    if (!in_use) return "127.0.0.1:" + std::to_string(port);
  }
  throw std::runtime_error("no port is free");
}

std::uint64_t counted(const std::string& text, std::string_view subject, std::string_view what) {
  // Lines of more than 80 columns go on in a further one, indented.
  const std::string whole = std::regex_replace(text, std::regex("\n  +"), " ");
  const std::regex line("(^|\n)" + std::string(subject) + ":([^\n]*)");
  std::smatch found;
  if (!std::regex_search(whole, found, line)) return 0;
  const std::string counts = found[2];
  const std::regex count("(\\d+) " + std::string(what) + "(,|$)");
  if (!std::regex_search(counts, found, count)) return 0;
  return std::stoull(found[1]);
}

std::string unwrapped(std::string_view text) {
  std::istringstream words{std::string(text)};
  std::string all;
  for (std::string word; words >> word;) all += (all.empty() ? "" : " ") + word;
  return all;
}

std::size_t occurrences(std::string_view text, std::string_view part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string_view::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

std::size_t lines(std::string_view text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace forcebound::test
