#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "tests/process/page_address.hpp"
#include "tests/process/programs.hpp"
#include "tests/support/becomes_true.hpp"

// What others than the page see of a run: Foxglove's protocol, and lines of JSON.
namespace forcebound::test {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr int kNodeModulesMissing = 77;  // mcap_core/live.mjs says so

const Words kTraced{"--scene", "sphere", "--page", "0", "--device", "omni", "--operator", "trace-sphere"};

/// The official client at a program's page.
Ran look_at(Process& program, const Words& options) {
  setenv("FORCEBOUND_NODE_MODULES", FORCEBOUND_MCAP_PACKAGES, 0);
  Words words{FORCEBOUND_LIVE_CHECK, PageAddress(program).whole()};
  words.insert(words.end(), options.begin(), options.end());
  return run(FORCEBOUND_NODE, words, 5min);
}

TEST(AViewerOfFoxglove, DecodesEveryTickOfAClientAndChoosesItsLawAndNetwork) {
  if (std::string(FORCEBOUND_NODE).empty())
    GTEST_SKIP() << "node is not installed (Debian: apt-get install nodejs npm)";
  Server server;
  Relay relay(server.address(), {"--control", "127.0.0.1:0"});
  Words words = kTraced;
  words.insert(words.end(), {"--relay-control", control_of(relay)});
  Client client(relay.address(), words);
  const Ran seen = look_at(client, {"--calls"});
  if (seen.exit_code == kNodeModulesMissing) GTEST_SKIP() << seen.out;
  EXPECT_EQ(seen.exit_code, 0) << seen.out << seen.err;
  EXPECT_THAT(seen.out, HasSubstr("two viewers decode all: "));
  // Late ticks can cost fba-more its passivity.
  EXPECT_THAT(client.stop(SIGINT), testing::AnyOf(testing::Optional(0), testing::Optional(3)));
}

TEST(AViewerOfFoxglove, SeesTheSessionsOfAServer) {
  if (std::string(FORCEBOUND_NODE).empty())
    GTEST_SKIP() << "node is not installed (Debian: apt-get install nodejs npm)";
  Server server({"--scene", "sphere", "--page", "0"});
  const Client one(server.address(), {"--device", "omni", "--operator", "trace-sphere"});
  const Client two(server.address(), {"--device", "omni", "--operator", "trace-sphere"});
  const Ran seen = look_at(server, {"--server"});
  if (seen.exit_code == kNodeModulesMissing) GTEST_SKIP() << seen.out;
  EXPECT_EQ(seen.exit_code, 0) << seen.out << seen.err;
  EXPECT_THAT(seen.out, HasSubstr("two viewers decode all: "));
}

/// A figure of the page, by HTTP.
std::uint64_t figure(const PageAddress& page, const std::string& name) {
  asio::io_context io;
  asio::ip::tcp::socket socket(io);
  socket.connect({asio::ip::make_address(page.host), page.port});
  http::request<http::empty_body> request(http::verb::get, "/metrics" + page.query, 11);
  request.set(http::field::host, page.authority());
  http::write(socket, request);
  beast::flat_buffer buffer;
  http::response<http::string_body> answer;
  http::read(socket, buffer, answer);
  const std::size_t at = answer.body().find("\n" + name + " ");
  EXPECT_NE(at, std::string::npos) << answer.body();
  return at == std::string::npos ? 0 : std::stoull(answer.body().substr(at + 1 + name.size()));
}

TEST(AViewerOfFoxglove, ThatNeverReadsCostsItselfAloneItsMessages) {
  Server server;
  Client client(server.address(), kTraced);
  const PageAddress page(client);
  asio::io_context io;
  beast::websocket::stream<asio::ip::tcp::socket> sleeper(io);
  sleeper.next_layer().open(asio::ip::tcp::v4());
  sleeper.next_layer().set_option(asio::socket_base::receive_buffer_size(16384));
  sleeper.next_layer().connect({asio::ip::make_address(page.host), page.port});
  sleeper.set_option(beast::websocket::stream_base::decorator([](beast::websocket::request_type& request) {
    request.set(http::field::sec_websocket_protocol, "foxglove.websocket.v1");
  }));
  sleeper.handshake(page.authority(), "/" + page.query);
  sleeper.write(asio::buffer(std::string(
      R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":1},{"id":2,"channelId":2},{"id":3,"channelId":5}]})")));
  EXPECT_TRUE(becomes_true([&] { return figure(page, "forcebound_page_skipped_total") > 0; }, 60s));
  EXPECT_TRUE(becomes_true([&] { return figure(page, "forcebound_page_viewers_dropped_total") == 1; }, 60s));
  EXPECT_EQ(figure(page, "forcebound_client_records_dropped_total"), 0);
  EXPECT_EQ(client.stop(SIGINT), client.expected_end());
}

}  // namespace
}  // namespace forcebound::test
