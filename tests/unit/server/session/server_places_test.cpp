#include "tests/unit/server/session/server_fixture.hpp"

namespace forcebound::server {
namespace {

/// The servers of two workers, with the limits of both together. Their timers run by the test's clock.
class ServerPlaces : public testing::Test {
 protected:
  static constexpr std::size_t kWorkers = 2;

  void serve(const ServerOptions& options = {}) {
    for (std::size_t i = 0; i < kWorkers; ++i) {
      ServerOptions own = options;
      own.worker = {.number = i, .workers = kWorkers, .limits = &limits};
      servers.push_back(
          std::make_unique<Server>(own, SceneLibrary::shipped(), links[i], clock, [this] { return next_id_++; }));
    }
  }

  void arrive(std::size_t worker, const wire::Message& message, std::uint16_t port, const ClientRights& rights = {}) {
    servers[worker]->on_datagram(codec_.encode(message), address(port), clock.time, rights);
  }

  /// What the worker has answered since; nothing: it has not.
  std::optional<wire::Message> answer(std::size_t worker) {
    std::optional<wire::Message> last;
    if (!links[worker].sent.empty()) last = std::get<wire::Message>(heard_.decode(links[worker].sent.back().bytes));
    links[worker].sent.clear();
    return last;
  }

  /// The session that the worker opens; 0: it does not.
  std::uint64_t join(std::size_t worker, std::uint16_t port, const ClientRights& rights = {}) {
    arrive(worker, {wire::Hello{.client_nonce = port, .degrees_of_freedom = 1, .period_s = 1e-3}}, port, rights);
    const auto answered = answer(worker);
    const auto* const welcome = answered ? std::get_if<wire::Welcome>(&*answered) : nullptr;
    return welcome == nullptr ? 0 : welcome->session;
  }

  void move(std::size_t worker, std::uint64_t session, std::uint64_t sequence, std::uint16_t port,
            const ClientRights& rights = {}) {
    arrive(worker, {wire::MotionSample{.session = session, .sequence = sequence, .position = vector_of({0.001})}}, port,
           rights);
    (void)answer(worker);
  }

  void pass(seconds time) {
    clock.time += time;
    for (const auto& server : servers) server->on_timer(clock.time);
    for (auto& link : links) link.sent.clear();
  }

  test::FakeClock clock;
  SharedLimits limits{1000, clock.time, 1};
  std::array<test::FakeLink, kWorkers> links;
  std::vector<std::unique_ptr<Server>> servers;

 private:
  std::uint64_t next_id_ = 1;
  wire::Codec codec_;
  wire::Codec heard_;
};

TEST_F(ServerPlaces, AClientThatComesBackAtAnotherWorkerGetsItsPlaceBack) {
  const ClientRights anna{.name = "anna", .key = "anna's key", .sessions_max = 1};
  serve();
  const std::uint64_t session = join(0, 1, anna);
  ASSERT_NE(session, 0U);
  move(0, session, 1, 1, anna);
  pass(seconds{10});
  arrive(1, {wire::Hello{.client_nonce = 2, .degrees_of_freedom = 1, .period_s = 1e-3}}, 2, anna);
  EXPECT_TRUE(std::holds_alternative<wire::Refusal>(answer(1).value())) << "it may be there still";
  pass(seconds{11});
  EXPECT_EQ(join(1, 2, anna), 0U);
  EXPECT_EQ(servers[1]->counters().hellos_too_early, 1U) << "not refused: it repeats its Hello";
  pass(seconds{0});
  EXPECT_NE(join(1, 2, anna), 0U);
  EXPECT_EQ(servers[0]->sessions(), 0U);
}

TEST_F(ServerPlaces, AreFairlySharedByKeysOverAllWorkers) {
  const ClientRights stolen{.name = "anna", .key = "stolen key"};
  serve({.sessions_max = 8});
  std::uint16_t port = 0;
  int held = 0;
  for (int i = 0; i < 32; ++i) held += join(static_cast<std::size_t>(i) % kWorkers, ++port, stolen) != 0 ? 1 : 0;
  EXPECT_EQ(held, 4);
  for (std::size_t worker = 0; worker < kWorkers; ++worker) {
    EXPECT_NE(join(worker, ++port, {.name = "bert", .key = "bert's key"}), 0U);
  }
}

TEST_F(ServerPlaces, ForgedHellosAtOneWorkerKeepNobodyFromAnother) {
  constexpr std::uint16_t kMost = 4;
  serve({.sessions_max = kMost});
  for (std::uint16_t port = 1; port <= kMost; ++port) ASSERT_NE(join(0, port), 0U);
  arrive(1, {wire::Hello{.client_nonce = 9, .degrees_of_freedom = 1, .period_s = 1e-3}}, 9);
  EXPECT_TRUE(std::holds_alternative<wire::Refusal>(answer(1).value())) << "they may send motion still";
  pass(seconds{2});
  EXPECT_EQ(join(1, 9), 0U);
  EXPECT_EQ(join(1, 9), 0U) << "one place was asked for";
  pass(seconds{0});
  EXPECT_NE(join(1, 9), 0U);
  EXPECT_EQ(servers[0]->sessions(), kMost - 1U);
}

TEST_F(ServerPlaces, ASessionThatMovesAgainKeepsItsPlaceThoughItWasAskedFor) {
  serve({.sessions_max = 1});
  const std::uint64_t session = join(0, 1);
  pass(seconds{2});
  EXPECT_EQ(join(1, 2), 0U);
  move(0, session, 1, 1);
  pass(seconds{0});
  EXPECT_EQ(servers[0]->sessions(), 1U);
  arrive(1, {wire::Hello{.client_nonce = 2, .degrees_of_freedom = 1, .period_s = 1e-3}}, 2);
  EXPECT_TRUE(std::holds_alternative<wire::Refusal>(answer(1).value()));
}

TEST_F(ServerPlaces, AHelloDoesNotWaitForAnotherWorkersScene) {
  serve({.memory = {.in_use = [] { return std::size_t{1} << 20U; }}});
  {
    const auto making = limits.try_making();
    ASSERT_TRUE(making);
    EXPECT_EQ(join(0, 1), 0U);
    EXPECT_EQ(servers[0]->counters().hellos_too_early, 1U);
  }
  EXPECT_NE(join(0, 1), 0U);
}

TEST_F(ServerPlaces, OnlyAHelloThatAnotherHasJudgedIsBeyondTheRate) {
  SharedLimits few(1, clock.time, 1);
  ServerOptions options;
  options.worker = {.number = 0, .workers = kWorkers, .limits = &few};
  Server server(options, SceneLibrary::shipped(), links[0], clock, [id = std::uint64_t{0}]() mutable { return ++id; });
  wire::Codec codec;
  const auto hello_of = [&](std::uint64_t nonce) {
    return codec.encode(wire::Hello{.client_nonce = nonce, .degrees_of_freedom = 1, .period_s = 1e-3});
  };
  server.receive(hello_of(1), {.address = address(1)}, clock.time);
  server.receive(hello_of(2), {.address = address(1)}, clock.time);
  EXPECT_EQ(server.sessions(), 1U);
  server.receive(hello_of(3), {.address = address(1), .judged = true}, clock.time);
  EXPECT_EQ(server.sessions(), 2U);
  EXPECT_EQ(server.counters().datagrams, 2U) << "who has judged it has counted it";
}

}  // namespace
}  // namespace forcebound::server
