#include "forcebound/page/page_server.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/becomes_true.hpp"

namespace forcebound::page {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using Tcp = asio::ip::tcp;
using testing::HasSubstr;

constexpr const char* kToken = "0123456789abcdef0123456789abcdef";
constexpr const char* kLive = "/live?token=0123456789abcdef0123456789abcdef";
constexpr const char* kPage = "/?token=0123456789abcdef0123456789abcdef";
constexpr const char* kMetrics = "/metrics?token=0123456789abcdef0123456789abcdef";

constexpr std::size_t kBigBytes = std::size_t{4} << 20U;

/// Greets, answers what it is told, and sends what it is asked to at each beat.
class Echo final : public Subject {
 public:
  void greet(ViewerId viewer, Viewers& viewers) override { send(viewer, "hello", viewers); }
  void receive(ViewerId viewer, std::string_view text, Viewers& viewers) override {
    if (text == "fault") throw std::runtime_error("a fault of the subject");
    send(viewer, "you said " + std::string(text), viewers);
  }
  void beat(Viewers& viewers) override {
    ++beats;
    const std::size_t bytes = stream_bytes;
    if (bytes > 0) viewers.send_to_all(std::make_shared<const std::string>(bytes, 'x'), worth);
  }
  std::string metrics() override { return "beats " + std::to_string(beats) + "\n"; }

  std::atomic<std::uint64_t> beats{0};
  std::atomic<std::size_t> stream_bytes{0};
  std::atomic<Worth> worth{Worth::stream};

 private:
  static void send(ViewerId viewer, const std::string& text, Viewers& viewers) {
    viewers.send(viewer, std::make_shared<const std::string>(text), Worth::needed);
  }
};

struct Answer {
  unsigned status = 0;
  std::string body;
  http::response<http::string_body> whole;
};

/// What speakers of the subprotocol see: answers in binary what it is told so.
class Elsewhere final : public Subject {
 public:
  void greet(ViewerId viewer, Viewers& viewers) override {
    viewers.send(viewer, std::make_shared<const std::string>("elsewhere"), Worth::needed);
  }
  void receive(ViewerId, std::string_view, Viewers&) override {}
  void receive_binary(ViewerId viewer, std::string_view content, Viewers& viewers) override {
    viewers.send_binary(viewer, std::make_shared<const std::string>(content), Worth::needed);
  }
  void leave(ViewerId) noexcept override { ++left; }
  void beat(Viewers& viewers) override { looking = viewers.count(); }
  std::string metrics() override { return {}; }

  std::atomic<std::size_t> looking{0};
  std::atomic<int> left{0};
};

class PageServerTest : public testing::Test {
 protected:
  void start(const Limits& limits = {}) {
    server.emplace(PageServer::Settings{.token = kToken,
                                        .assets = {{"index.html", {"text/html; charset=utf-8", "<p>the page"}},
                                                   {"licences/a.txt", {"text/plain; charset=utf-8", "free"}},
                                                   {"big", {"text/plain", std::string(kBigBytes, 'x')}}},
                                        .limits = limits},
                   echo, Subprotocol{.name = "other.v1", .subject = &elsewhere});
  }

  [[nodiscard]] std::string host() const { return "127.0.0.1:" + std::to_string(server->port()); }

  /// It takes little of an answer that is not read.
  Tcp::socket connected() {
    Tcp::socket socket(io);
    socket.open(Tcp::v4());
    socket.set_option(asio::socket_base::receive_buffer_size(16384));
    socket.connect({asio::ip::make_address("127.0.0.1"), server->port()});
    return socket;
  }

  /// What a request is answered, sent as it is.
  Answer ask(const std::string& request) {
    Tcp::socket socket = connected();
    beast::error_code ignored;
    asio::write(socket, asio::buffer(request), ignored);
    beast::flat_buffer buffer;
    Answer answer;
    beast::error_code error;
    http::read(socket, buffer, answer.whole, error);
    answer.status = error ? 0 : answer.whole.result_int();
    answer.body = answer.whole.body();
    return answer;
  }

  Answer get(const std::string& target, const std::string& headers = "", std::string host_name = "") {
    if (host_name.empty()) host_name = host();
    return ask("GET " + target + " HTTP/1.1\r\nHost: " + host_name + "\r\n" + headers + "\r\n");
  }

  using Stream = websocket::stream<Tcp::socket>;

  /// Null: it is refused.
  std::unique_ptr<Stream> join() { return join(kLive, "http://" + host(), ""); }

  /// @param subprotocols offered; empty: none
  std::unique_ptr<Stream> join(const char* target, const std::string& origin, const std::string& subprotocols) {
    auto stream = std::make_unique<Stream>(connected());
    stream->set_option(websocket::stream_base::decorator([=](websocket::request_type& request) {
      request.set(http::field::origin, origin);
      if (!subprotocols.empty()) request.set(http::field::sec_websocket_protocol, subprotocols);
    }));
    beast::error_code error;
    stream->handshake(chosen_, host(), target, error);
    return error ? nullptr : std::move(stream);
  }

  /// The subprotocol that the server chose for the last viewer.
  [[nodiscard]] std::string chosen() const { return std::string(chosen_[http::field::sec_websocket_protocol]); }

  /// The status with which somebody is refused who wants to be a viewer.
  unsigned refusal(const std::string& target, const std::string& headers = "") {
    return get(target,
               "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
               "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n" +
                   headers)
        .status;
  }

  static std::string next(Stream& stream) {
    beast::flat_buffer buffer;
    stream.read(buffer);
    return beast::buffers_to_string(buffer.data());
  }

  template <class Condition>
  static void wait_until(Condition condition) {
    EXPECT_TRUE(test::becomes_true(condition));
  }

  Echo echo;
  Elsewhere elsewhere;
  websocket::response_type chosen_;
  asio::io_context io;
  std::optional<PageServer> server;
};

TEST_F(PageServerTest, ServesThePageToWhoHasTheToken) {
  start();
  EXPECT_EQ(server->address(), "http://" + host() + "/?token=" + kToken);
  const Answer page = get(kPage);
  EXPECT_EQ(page.status, 200);
  EXPECT_EQ(page.body, "<p>the page");
  EXPECT_EQ(page.whole[http::field::content_type], "text/html; charset=utf-8");
  EXPECT_EQ(page.whole["X-Content-Type-Options"], "nosniff");
  EXPECT_EQ(page.whole["Referrer-Policy"], "no-referrer");
  EXPECT_THAT(std::string(page.whole["Content-Security-Policy"]), HasSubstr("default-src 'none'"));
  const Answer licence = get("/licences/a.txt");
  EXPECT_EQ(licence.status, 200);
  EXPECT_EQ(licence.body, "free");
}

TEST_F(PageServerTest, ShowsItsFiguresToWhoHasTheToken) {
  start();
  EXPECT_THAT(get(kMetrics).body, HasSubstr("beats "));
  EXPECT_THAT(get("/metrics", "Authorization: Bearer 0123456789abcdef0123456789abcdef\r\n").body, HasSubstr("beats "));
  EXPECT_EQ(get("/metrics").status, 401);
  EXPECT_EQ(get("/metrics", "Authorization: Bearer wrong\r\n").status, 401);
}

TEST_F(PageServerTest, RefusesWithAClearStatusAndALine) {
  start();
  EXPECT_THAT(get("/").body, HasSubstr("401 the token is missing or wrong"));
  EXPECT_EQ(get("/?token=0123456789abcdef0123456789abcdeg").status, 401);
  EXPECT_EQ(get(kPage, "", "evil.example").status, 403);
  EXPECT_EQ(get("/licences/a.txt", "", "evil.example:" + std::to_string(server->port())).status, 403);
  EXPECT_EQ(get("/licences/a.txt", "Origin: http://evil.example\r\n").status, 403);
  EXPECT_EQ(get("/nothing").status, 404);
  const Answer posted = ask("POST / HTTP/1.1\r\nHost: " + host() + "\r\n\r\n");
  EXPECT_EQ(posted.status, 405);
  EXPECT_EQ(posted.whole[http::field::allow], "GET");
  EXPECT_EQ(ask("GET " + std::string(kLive) + " HTTP/1.0\r\nHost: " + host() + "\r\n\r\n").status, 505);
  EXPECT_EQ(server->counts().refused, server->counts().requests);
}

TEST_F(PageServerTest, HasNoWayToOtherFiles) {
  start();
  for (const char* const target :
       {"/../index.html", "/licences/../index.html", "/licences/", "/licences", "//etc/passwd", "/%2e%2e/index.html",
        "/..%2findex.html", "/index.html%00", "/etc/passwd"}) {
    const unsigned status = get(target).status;
    EXPECT_TRUE(status == 404 || status == 400) << target << " " << status;
  }
}

TEST_F(PageServerTest, RefusesGarbageLongHeadersAndBodies) {
  start();
  EXPECT_EQ(ask("\x16\x03\x01 garbage\r\n\r\n").status, 400);
  EXPECT_EQ(ask("GET / HTTP/9.9\r\n\r\n").status, 400);
  EXPECT_EQ(get("/", "X: " + std::string(10000, 'x') + "\r\n").status, 431);
  const Answer body = ask("GET / HTTP/1.1\r\nHost: " + host() + "\r\nContent-Length: 5\r\n\r\nhello");
  EXPECT_EQ(body.status, 413);
  EXPECT_EQ(get("/licences/a.txt").status, 200);
}

TEST_F(PageServerTest, SpeaksWithViewers) {
  start();
  const auto viewer = join();
  ASSERT_NE(viewer, nullptr);
  EXPECT_EQ(next(*viewer), "hello");
  viewer->write(asio::buffer(std::string("hi")));
  EXPECT_EQ(next(*viewer), "you said hi");
  viewer->write(asio::buffer(std::string("fault")));
  viewer->write(asio::buffer(std::string("still there")));
  EXPECT_EQ(next(*viewer), "you said still there");
  EXPECT_EQ(server->counts().faults, 1);
  EXPECT_EQ(server->counts().messages, 3);
}

TEST_F(PageServerTest, RefusesViewersWithoutTokenOfOtherOriginsAndTooMany) {
  start();
  EXPECT_EQ(refusal("/live"), 401);
  EXPECT_EQ(refusal("/live?token=wrong"), 401);
  EXPECT_EQ(refusal(kLive, "Origin: http://evil.example\r\n"), 403);
  EXPECT_EQ(refusal(kLive, "Origin: null\r\n"), 403);
  std::vector<std::unique_ptr<Stream>> viewers;
  for (int i = 0; i < 4; ++i) {
    viewers.push_back(join());
    ASSERT_NE(viewers.back(), nullptr);
  }
  EXPECT_EQ(refusal(kLive), 429);
  viewers.pop_back();  // it leaves, and another may come
  wait_until([&] {
    auto viewer = join();
    if (viewer) viewers.push_back(std::move(viewer));
    return viewers.size() == 4;
  });
}

TEST_F(PageServerTest, ShowsSpeakersOfTheSubprotocolTheirOwnSubjectFromAnyOriginThatHasTheToken) {
  start();
  const std::string origin = "https://elsewhere.example";
  const auto speaker = join(kPage, origin, "newer.v2, other.v1");
  ASSERT_NE(speaker, nullptr);
  EXPECT_EQ(chosen(), "other.v1");
  const auto viewer = join();
  ASSERT_NE(viewer, nullptr);
  EXPECT_EQ(chosen(), "");
  EXPECT_EQ(next(*speaker), "elsewhere");
  EXPECT_EQ(next(*viewer), "hello");
  wait_until([&] { return elsewhere.looking == 1; });
  const std::string content("\x01\0\xff", 3);
  speaker->binary(true);
  speaker->write(asio::buffer(content));
  EXPECT_EQ(next(*speaker), content);
  EXPECT_TRUE(speaker->got_binary());
  EXPECT_EQ(join(kPage, origin, ""), nullptr);
  EXPECT_EQ(join("/?token=wrong", origin, "other.v1"), nullptr);
  EXPECT_EQ(refusal("/", "Sec-WebSocket-Protocol: other.v1\r\n"), 401);
  EXPECT_EQ(refusal(kPage, "Sec-WebSocket-Protocol: other.v2\r\n"), 400);
  EXPECT_EQ(get(kPage, "Origin: " + origin + "\r\nSec-WebSocket-Protocol: other.v1\r\n").status, 403)
      << "the page itself";
  speaker->next_layer().close();
  wait_until([&] { return elsewhere.left == 1 && elsewhere.looking == 0; });
}

TEST_F(PageServerTest, SendsALineForEachMessageToWhoAsksWithoutAWebSocket) {
  start();
  EXPECT_EQ(get("/live").status, 401);
  Tcp::socket socket = connected();
  asio::write(socket, asio::buffer("GET " + std::string(kLive) + " HTTP/1.1\r\nHost: " + host() + "\r\n\r\n"));
  std::string received;
  asio::read_until(socket, asio::dynamic_buffer(received), "6\r\nhello\n\r\n");
  EXPECT_THAT(received, HasSubstr("200 OK"));
  EXPECT_THAT(received, HasSubstr("Transfer-Encoding: chunked\r\n"));
  echo.stream_bytes = 20;
  received.clear();
  asio::read_until(socket, asio::dynamic_buffer(received), "15\r\n" + std::string(20, 'x') + "\n\r\n");
  EXPECT_EQ(server->counts().viewers, 1);
  asio::write(socket, asio::buffer(std::string("more")));  // there is nothing to be said
  wait_until([&] {
    beast::error_code error;
    std::array<char, 4096> rest{};
    socket.read_some(asio::buffer(rest), error);
    return static_cast<bool>(error);
  });
}

TEST_F(PageServerTest, EndsAViewerWhoseMessageIsTooLong) {
  start();
  const auto viewer = join();
  ASSERT_NE(viewer, nullptr);
  EXPECT_EQ(next(*viewer), "hello");
  viewer->write(asio::buffer(std::string(5000, 'x')));
  EXPECT_THROW(next(*viewer), boost::system::system_error);
  EXPECT_EQ(viewer->reason().code, websocket::close_code::too_big);
}

TEST_F(PageServerTest, LeavesOutWhatASlowViewerDoesNotReadAndDropsItInTheEnd) {
  Limits limits;
  limits.stream_bytes = 100'000;
  limits.stalled = std::chrono::seconds{1};
  start(limits);
  const auto reader = join();
  const auto sleeper = join();
  ASSERT_TRUE(reader != nullptr && sleeper != nullptr);
  EXPECT_EQ(next(*reader), "hello");
  echo.stream_bytes = 50'000;
  wait_until([&] {
    EXPECT_EQ(next(*reader).size(), 50'000);
    return server->counts().viewers_dropped == 1;
  });
  EXPECT_GT(server->counts().skipped, 0);
  EXPECT_EQ(next(*reader).size(), 50'000);
}

TEST_F(PageServerTest, DropsAViewerForWhomTooMuchWaitsThatItNeeds) {
  Limits limits;
  limits.needed_bytes = 10'000'000;
  start(limits);
  const auto sleeper = join();
  ASSERT_NE(sleeper, nullptr);
  echo.worth = Worth::needed;
  echo.stream_bytes = 1'000'000;
  wait_until([&] { return server->counts().viewers_dropped == 1; });
}

TEST_F(PageServerTest, ReadsAFloodNoFasterThanItMay) {
  Limits limits;
  limits.messages_at_once = 20;
  limits.messages_per_beat = 2;
  start(limits);
  const std::uint64_t first_beat = echo.beats;
  const auto viewer = join();
  ASSERT_NE(viewer, nullptr);
  std::jthread flood([&] {
    for (int i = 0; i < 200; ++i) viewer->write(asio::buffer(std::string("flood")));
  });
  EXPECT_EQ(next(*viewer), "hello");
  for (int i = 0; i < 200; ++i) EXPECT_EQ(next(*viewer), "you said flood");  // all of them, in their order
  EXPECT_GE(echo.beats - first_beat, (200 - 20) / 2 - 1);
}

TEST_F(PageServerTest, TurnsAwayAThousandSocketsAndServesItsViewersMeanwhile) {
  Limits limits;
  limits.request = std::chrono::seconds{1};
  limits.stalled = std::chrono::hours{1};  // of the viewer, which does not read for as long as this takes
  start(limits);
  const auto viewer = join();
  ASSERT_NE(viewer, nullptr);
  EXPECT_EQ(next(*viewer), "hello");
  std::vector<Tcp::socket> sockets;
  for (int i = 0; i < 1000; ++i) {
    Tcp::socket socket(io);
    beast::error_code error;
    socket.open(Tcp::v4());
    socket.non_blocking(true);
    socket.connect({asio::ip::make_address("127.0.0.1"), server->port()}, error);
    sockets.push_back(std::move(socket));
    if (i % 50 == 0) {
      viewer->write(asio::buffer(std::to_string(i)));
      EXPECT_EQ(next(*viewer), "you said " + std::to_string(i));
    }
  }
  wait_until([&] { return server->counts().turned_away > 100; });
  sockets.clear();
  wait_until([&] { return get("/licences/a.txt").status == 200; });
  EXPECT_EQ(server->counts().viewers_dropped, 0);
}

/// Connections that are kept open, as many as there may be and more, and never end by themselves.
class HeldConnections : public PageServerTest {
 protected:
  static constexpr std::size_t kMost = 32;
  static constexpr std::size_t kHeld = 40;

  void start_full_of(const std::string& said) {
    Limits limits;
    limits.connections = kMost;
    limits.connections_per_beat = 8;
    limits.request = std::chrono::hours{1};
    start(limits);
    for (std::size_t i = 0; i < kHeld; ++i) {
      held.push_back(connected());
      asio::write(held.back(), asio::buffer(said));
    }
  }

  [[nodiscard]] std::string request_for(const std::string& target) const {
    return "GET " + target + " HTTP/1.1\r\nHost: " + host() + "\r\n\r\n";
  }

  std::vector<Tcp::socket> held;
};

TEST_F(HeldConnections, WithHalfRequestsKeepNobodyOutWhoHasTheToken) {
  start_full_of("GET / HT");
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(get(kPage).status, 200);
    EXPECT_EQ(get(kMetrics).status, 200);
  }
  EXPECT_NE(join(), nullptr);
  EXPECT_GE(server->counts().turned_away, kHeld - kMost);
}

TEST_F(HeldConnections, WithAnswersThatAreNotReadKeepNobodyOutWhoHasTheToken) {
  start_full_of("");
  const std::string big = request_for("/big");
  for (Tcp::socket& socket : held) {
    beast::error_code ended;
    asio::write(socket, asio::buffer(big), ended);
  }
  for (int i = 0; i < 10; ++i) EXPECT_EQ(get(kMetrics).status, 200);
}

TEST_F(HeldConnections, AreNotEndedOnceTheyHaveShownTheToken) {
  start_full_of("GET / HT");
  Tcp::socket owner = connected();
  asio::write(owner, asio::buffer(request_for("/big?token=" + std::string(kToken))));
  Tcp::socket reader = connected();
  asio::write(reader, asio::buffer(request_for("/big")));
  const std::uint64_t before = server->counts().turned_away;
  std::vector<Tcp::socket> more;
  for (std::size_t i = 0; i < kHeld; ++i) more.push_back(connected());
  wait_until([&] { return server->counts().turned_away >= before + kHeld; });
  const auto read_all = [](Tcp::socket& socket) {
    beast::flat_buffer buffer;
    http::response_parser<http::string_body> answer;
    answer.body_limit(2 * kBigBytes);
    beast::error_code error;
    http::read(socket, buffer, answer, error);
    return answer.get().body().size();
  };
  EXPECT_EQ(read_all(owner), kBigBytes);
  EXPECT_LT(read_all(reader), kBigBytes) << "so there was need for room";
}

TEST_F(PageServerTest, ClosesAConnectionThatSendsNoRequest) {
  Limits limits;
  limits.request = std::chrono::seconds{1};
  start(limits);
  Tcp::socket socket = connected();
  asio::write(socket, asio::buffer(std::string("GET / HT")));
  std::array<char, 1> byte{};
  beast::error_code error;
  socket.read_some(asio::buffer(byte), error);  // waits until it is closed
  EXPECT_TRUE(error);
}

TEST_F(PageServerTest, EndsWithViewersAndHalfRequestsUnderWay) {
  start();
  const auto viewer = join();
  Tcp::socket half = connected();
  asio::write(half, asio::buffer(std::string("GET / HT")));
  echo.stream_bytes = 100'000;
  const std::uint64_t beats = echo.beats;
  wait_until([&] { return echo.beats > beats + 3; });
  server.reset();
}

TEST_F(PageServerTest, SaysWhyItCannotListen) {
  start();
  try {
    const PageServer second({.port = server->port(), .token = kToken}, echo);
    FAIL() << "listens twice";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr(host()));
    EXPECT_THAT(error.what(), HasSubstr("in use"));
  }
}

}  // namespace
}  // namespace forcebound::page
