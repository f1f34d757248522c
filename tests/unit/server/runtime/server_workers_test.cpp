#include "forcebound/server/runtime/server_workers.hpp"

#include <gmock/gmock.h>

#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "forcebound/server/runtime/steering.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/unit/server/runtime/askers.hpp"

namespace forcebound::server {
namespace {

using test::vector_of;
using testing::HasSubstr;

class WorkersPush final : public Environment {
 public:
  Answer respond(const Motion& motion) noexcept override { return {.force = -100 * motion.position}; }
};

/// "push" is each client's own, the others have two places together.
EnvironmentLibrary pushes() {
  EnvironmentLibrary environments;
  for (const std::string name : {"push", "shared a", "shared b", "shared c", "shared d"}) {
    environments.add({.name = name,
                      .sessions_max = name == "push" ? std::size_t{0} : std::size_t{2},
                      .make = [](const ClientFacts&) {
                        return MadeEnvironment{.environment = std::make_unique<WorkersPush>(), .simulated = "a push"};
                      }});
  }
  return environments;
}

/// Whether the session answers at an address that is new to it: once it has been sent more than that answer.
template <class Any>
bool is_answered_at_new_address(Any& asker, std::uint64_t session) {
  constexpr std::uint64_t kFirst = 2;
  constexpr std::uint64_t kLast = 5;
  for (std::uint64_t n = kFirst; n <= kLast; ++n) asker.send(motion_of(session, n));
  const auto force = asker.template await<wire::EnvironmentForce>();
  // With the challenge sent back all is answered there, also a Bye.
  wire::MotionSample proof = motion_of(session, kLast + 1);
  proof.challenge = force.challenge;
  asker.send(proof);
  return force.session == session;
}

template <class Any>
bool is_answered_elsewhere(Any& asker, std::uint64_t session) {
  asker.move();
  return is_answered_at_new_address(asker, session);
}

std::size_t home_of(std::string_view scene) { return WorkerPlace{.number = 0, .workers = 2}.home_of(scene); }

ServerKeys keys_for_anna() {
  ServerKeys keys{.own = security::key_pair_from(security::key_bytes(2))};
  keys.clients = security::AllowedClients::parse(
      "[[client]]\nname = \"anna\"\npublic_key = \"" + security::public_text(1) + "\"\n", "clients.toml");
  return keys;
}

//   askers ==( UDP of this machine )== two or more sockets at one address, each with a worker; the first worker's turns
//                                      are a thread of the fixture's
class ServerWorkersTest : public testing::Test {
 protected:
  void serve(std::size_t workers, ServerOptions options = {}, std::optional<ServerKeys> keys = std::nullopt,
             ServerObserver* observer = nullptr) {
    options.scene = "push";
    server_.emplace(listen({"127.0.0.1", 0}), ServerWorkers::Settings{.workers = workers}, options, pushes(), observer,
                    std::move(keys));
    server_->start();
    turning_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) server_->turn();
      server_->stop();
    });
  }

  void stop() {
    turning_.request_stop();
    turning_.join();
  }

  std::optional<ServerWorkers> server_;
  std::jthread turning_;
};

TEST_F(ServerWorkersTest, SendEachSessionsMotionsToTheWorkerThatHasIt) {
  constexpr std::size_t kWorkers = 3;
  serve(kWorkers);
  std::set<std::size_t> owners;
  std::vector<std::unique_ptr<Asker>> askers;
  for (std::uint64_t i = 1; i <= 24; ++i) {
    askers.push_back(std::make_unique<Asker>(server_->address()));
    const auto session = askers.back()->ask<wire::Welcome>(hello_of(i)).session;
    owners.insert(WorkerPlace::owner_of(session, kWorkers));
    for (std::uint64_t n = 1; n <= 5; ++n) {
      EXPECT_EQ(askers.back()->ask<wire::EnvironmentForce>(motion_of(session, n)).answer.force, vector_of({-2}));
    }
  }
  EXPECT_EQ(owners.size(), kWorkers) << "of 24 clients each worker has some";
  EXPECT_EQ(server_->sessions(), 24U);
  stop();
  EXPECT_EQ(server_->counters().forces_sent, 24U * 5U);
  EXPECT_EQ(server_->handed_over(), 0U) << "the system steers";
  EXPECT_EQ(server_->sessions(), 0U);
}

TEST_F(ServerWorkersTest, KeepASessionWhoseAddressChanges) {
  serve(2);
  for (std::uint64_t i = 1; i <= 8; ++i) {
    Asker asker(server_->address());
    const auto session = asker.ask<wire::Welcome>(hello_of(i)).session;
    ASSERT_EQ(asker.ask<wire::EnvironmentForce>(motion_of(session, 1)).session, session);
    EXPECT_TRUE(is_answered_elsewhere(asker, session));
    asker.send(wire::Bye{.session = session});
    EXPECT_EQ(asker.await<wire::Bye>().motions_received, 6U);
  }
  stop();
  EXPECT_EQ(server_->counters().addresses_changed, 8U);
  EXPECT_EQ(server_->handed_over(), 0U);
}

TEST_F(ServerWorkersTest, KeepAnEncryptedSessionWhoseAddressChanges) {
  serve(2, {}, keys_for_anna());
  for (std::uint32_t i = 1; i <= 8; ++i) {
    SecureAsker asker(server_->address(), i);
    const auto session = asker.ask<wire::Welcome>(hello_of(i)).session;
    ASSERT_EQ(asker.ask<wire::EnvironmentForce>(motion_of(session, 1)).session, session);
    EXPECT_TRUE(is_answered_elsewhere(asker, session));
  }
  stop();
  EXPECT_EQ(server_->counters().addresses_changed, 8U);
  EXPECT_EQ(server_->handed_over(), 0U);
}

TEST_F(ServerWorkersTest, BringTheClientsOfASharedSceneTogetherWhateverTheirAddresses) {
  serve(2);
  for (const std::string scene : {"shared a", "shared b", "shared c", "shared d"}) {
    // Of eight clients some come to either worker.
    std::vector<std::unique_ptr<Asker>> askers;
    std::size_t let_in = 0;
    for (std::uint64_t i = 1; i <= 8; ++i) {
      askers.push_back(std::make_unique<Asker>(server_->address()));
      askers.back()->send(hello_of(i, scene));
      const wire::Message answer = askers.back()->receive_any();
      const auto* const welcome = std::get_if<wire::Welcome>(&answer);
      if (welcome == nullptr) {
        EXPECT_THAT(std::string(std::get<wire::Refusal>(answer).text), HasSubstr("all 2 places"));
        continue;
      }
      ++let_in;
      const auto session = welcome->session;
      EXPECT_EQ(WorkerPlace::owner_of(session, 2), home_of(scene));
      EXPECT_EQ(askers.back()->ask<wire::EnvironmentForce>(motion_of(session, 1)).session, session);
    }
    EXPECT_EQ(let_in, 2U) << scene;
  }
  stop();
  EXPECT_GT(server_->handed_over(), 0U);
  EXPECT_EQ(server_->not_handed_over(), 0U);
}

TEST_F(ServerWorkersTest, HandTheKeysOverWithAHelloForASharedScene) {
  serve(2, {}, keys_for_anna());
  for (const std::string scene : {"shared a", "shared b", "shared c", "shared d"}) {
    for (std::uint32_t i = 1; i <= 2; ++i) {
      SecureAsker asker(server_->address(), i);
      const auto session = asker.ask<wire::Welcome>(hello_of(i, scene)).session;
      EXPECT_EQ(WorkerPlace::owner_of(session, 2), home_of(scene));
      EXPECT_EQ(asker.ask<wire::EnvironmentForce>(motion_of(session, 1)).session, session);
      EXPECT_TRUE(is_answered_elsewhere(asker, session));
      asker.send(wire::Bye{.session = session});
      EXPECT_EQ(asker.await<wire::Bye>().motions_received, 6U);
    }
  }
  stop();
  EXPECT_EQ(server_->not_handed_over(), 0U);
  EXPECT_EQ(server_->counters().sends_failed, 0U);
}

TEST_F(ServerWorkersTest, KeepASessionWhoseClientMakesNewKeysAtAnotherWorker) {
  serve(2, {}, keys_for_anna());
  std::uint32_t number = 0;
  for (const std::string scene : {"push", "shared a", "shared b", "shared c"}) {
    for (int i = 0; i < 4; ++i) {
      SecureAsker before(server_->address(), ++number);
      const auto session = before.ask<wire::Welcome>(hello_of(number, scene)).session;
      ASSERT_EQ(before.ask<wire::EnvironmentForce>(motion_of(session, 1)).session, session);
      SecureAsker after(server_->address(), ++number);
      ASSERT_TRUE(is_answered_at_new_address(after, session)) << scene;
      after.send(wire::Bye{.session = session});
      EXPECT_EQ(after.await<wire::Bye>().motions_received, 6U);
    }
  }
  stop();
  EXPECT_GT(server_->handed_over(), 0U);
  EXPECT_EQ(server_->counters().motions_without_session, 0U);
}

TEST_F(ServerWorkersTest, OpenEachSharedSceneAtItsHomeThoughOneClientAsksForAllUnderTheSameKeys) {
  serve(2, {}, keys_for_anna());
  SecureAsker asker(server_->address(), 1);
  std::uint64_t nonce = 0;
  for (const std::string scene : {"shared a", "shared b", "shared c", "shared d"}) {
    const auto session = asker.ask<wire::Welcome>(hello_of(++nonce, scene)).session;
    EXPECT_EQ(WorkerPlace::owner_of(session, 2), home_of(scene)) << scene;
    EXPECT_EQ(asker.ask<wire::EnvironmentForce>(motion_of(session, 1)).session, session);
  }
  stop();
  EXPECT_EQ(server_->counters().sessions_opened, 4U);
  EXPECT_EQ(server_->counters().datagrams, 8U) << "each counts once, however often it was handed over";
}

TEST_F(ServerWorkersTest, HoldAClientToTheRateOfHellosWhereverItsKeysAre) {
  constexpr int kRate = 5;
  serve(2, {.hellos_per_s_max = kRate}, keys_for_anna());
  for (const std::string scene : {"shared a", "shared b"}) {
    SecureAsker asker(server_->address(), 1);
    const auto session = asker.ask<wire::Welcome>(hello_of(1, scene)).session;
    for (std::uint64_t nonce = 2; nonce < 16; ++nonce) asker.send(hello_of(nonce, scene));
    asker.send(motion_of(session, 1));
    (void)asker.await<wire::EnvironmentForce>();
    asker.send(wire::Bye{.session = session});
    (void)asker.await<wire::Bye>();
    std::this_thread::sleep_for(std::chrono::seconds{1});  // until Hellos are taken again
  }
  stop();
  EXPECT_GT(server_->counters().hellos_over_rate, 2U * kRate);
}

TEST_F(ServerWorkersTest, HaveNoMoreSessionsThanOneServerWouldHowManyEverAskAtOnce) {
  constexpr std::size_t kMost = 6;
  serve(2, {.sessions_max = kMost, .hellos_per_s_max = 1000});
  std::vector<std::unique_ptr<Asker>> askers;
  for (std::uint64_t i = 1; i <= 40; ++i) {
    askers.push_back(std::make_unique<Asker>(server_->address()));
    askers.back()->send(hello_of(i));
  }
  std::size_t let_in = 0;
  std::size_t refused = 0;
  for (const auto& asker : askers) {
    const wire::Message answer = asker->receive_any();
    if (const auto* const welcome = std::get_if<wire::Welcome>(&answer)) {
      asker->send(motion_of(welcome->session, 1));
      ++let_in;
    } else {
      refused += std::holds_alternative<wire::Refusal>(answer) ? 1 : 0;
    }
  }
  EXPECT_EQ(let_in, kMost);
  EXPECT_EQ(refused, 40U - kMost);
  EXPECT_EQ(server_->sessions(), kMost);
}

TEST_F(ServerWorkersTest, CountAnAddressesSessionsTogether) {
  serve(2, {.sessions_per_address = 3});
  std::vector<std::unique_ptr<Asker>> askers;
  std::size_t let_in = 0;
  for (std::uint64_t i = 1; i <= 12; ++i) {
    askers.push_back(std::make_unique<Asker>(server_->address()));
    askers.back()->send(hello_of(i));
    let_in += std::holds_alternative<wire::Welcome>(askers.back()->receive_any()) ? 1 : 0;
  }
  EXPECT_EQ(let_in, 3U);
}

TEST_F(ServerWorkersTest, AllEndTheirSessionsAtTheEnd) {
  serve(2);
  std::vector<std::unique_ptr<Asker>> askers;
  std::vector<std::uint64_t> sessions;
  for (std::uint64_t i = 1; i <= 12; ++i) {
    askers.push_back(std::make_unique<Asker>(server_->address()));
    sessions.push_back(askers.back()->ask<wire::Welcome>(hello_of(i)).session);
  }
  stop();
  for (std::size_t i = 0; i < askers.size(); ++i) EXPECT_EQ(askers[i]->receive<wire::Bye>().session, sessions[i]);
}

/// Turned by the test itself.
TEST(ServerWorkers, EndAnyWorkersSessionAndAdmitNoneAsAsked) {
  ServerOptions options{.scene = "push"};
  ServerWorkers server(listen({"127.0.0.1", 0}), {.workers = 2}, options, pushes());
  server.start();
  std::vector<std::unique_ptr<Asker>> askers;
  for (std::uint64_t i = 1; i <= 8; ++i) {
    askers.push_back(std::make_unique<Asker>(server.address()));
    askers.back()->send(hello_of(i));
  }
  while (server.sessions() < 8) server.turn();
  for (const auto& asker : askers) {
    const auto session = asker->receive<wire::Welcome>().session;
    EXPECT_TRUE(server.end_session(session));
    EXPECT_EQ(asker->receive<wire::Bye>().session, session);
  }
  while (server.sessions() > 0) server.turn();
  EXPECT_FALSE(server.end_session(2));
  EXPECT_FALSE(server.end_session(3));
  server.admit_none("the end is near");
  while (!server.settled()) server.turn();
  for (std::uint64_t i = 1; i <= 8; ++i) {
    Asker asker(server.address());
    asker.send(hello_of(100 + i));
    const std::uint64_t before = server.counters().datagrams;
    server.turn();
    if (before == server.counters().datagrams) server.turn();
    EXPECT_EQ(asker.receive<wire::Refusal>().text, "the end is near");
  }
  server.stop();
}

TEST(ServerWorkers, BeginEachOtherThreadAsToldTo) {
  std::mutex guard;
  std::set<std::thread::id> begun;
  const auto note = [&] {
    const std::lock_guard lock(guard);
    begun.insert(std::this_thread::get_id());
  };
  ServerWorkers server(listen({"127.0.0.1", 0}), {.workers = 3, .begin_thread = note}, {.scene = "push"}, pushes());
  server.start();
  server.stop();
  EXPECT_EQ(begun.size(), 2U);
  EXPECT_FALSE(begun.contains(std::this_thread::get_id()));
}

class Throws final : public ServerObserver {
 public:
  void on_refused(const net::Address&, std::string_view) override { throw std::logic_error("the observer is broken"); }
};

TEST(ServerWorkers, FailTogetherWithTheOneThatFails) {
  Throws observer;
  ServerWorkers server(listen({"127.0.0.1", 0}), {.workers = 4}, {.scene = "push"}, pushes(), &observer);
  server.start();
  std::vector<std::unique_ptr<Asker>> askers;
  EXPECT_THROW(
      {
        // Refused, as there is no such scene; after a few, one of them by another worker than the first.
        for (std::uint64_t i = 1; i < 1000; ++i) {
          askers.push_back(std::make_unique<Asker>(server.address()));
          askers.back()->send(hello_of(i, "none"));
          server.turn();
        }
      },
      std::logic_error);
}

/// At a session's end in another thread than the test's.
class ThrowsAtTheEnd final : public ServerObserver {
 public:
  void on_closed(const SessionInfo&, CloseReason, const wire::Bye&) override {
    if (std::this_thread::get_id() != test_) throw std::logic_error("the observer is broken");
  }

 private:
  std::thread::id test_ = std::this_thread::get_id();
};

TEST(ServerWorkers, FailAtTheEndWithTheOneThatFails) {
  ThrowsAtTheEnd observer;
  ServerWorkers server(listen({"127.0.0.1", 0}), {.workers = 2}, {.scene = "push"}, pushes(), &observer);
  server.start();
  std::vector<std::unique_ptr<Asker>> askers;
  for (std::uint64_t i = 1; i <= 12; ++i) {
    askers.push_back(std::make_unique<Asker>(server.address()));
    askers.back()->send(hello_of(i));
  }
  while (server.sessions() < 12) server.turn();
  EXPECT_THROW(server.stop(), std::logic_error);
}

TEST(ServerWorkers, AreOneWhereTheSystemCannotSteer) {
  ServerWorkers server(listen({"127.0.0.1", 0}),
                       {.workers = 4, .steer = [](const net::UdpLink&, std::size_t) { return false; }},
                       {.scene = "push"}, pushes());
  EXPECT_EQ(server.size(), 1U);
  server.start();
  for (std::uint64_t i = 1; i <= 8; ++i) {
    Asker asker(server.address());
    asker.send(hello_of(i));
    server.turn();
    EXPECT_NE(asker.receive<wire::Welcome>().session, 0U);
  }
}

/// The first of two workers, turned by the test; the other's mail is not looked at.
class OneOfTwoWorkers : public testing::Test {
 protected:
  void start(std::size_t moved_most) {
    for (int i = 0; i < 2; ++i) mail_.push_back(std::make_unique<WorkerMail>());
    moved_.emplace(moved_most, 2);
    const ServerOptions options{.scene = "push", .worker = {.number = 0, .workers = 2, .limits = &limits_}};
    server_.emplace(listen({"127.0.0.1", 0}), options, pushes(), nullptr, keys_for_anna(), mail_, &*moved_);
  }

  /// With keys.
  std::unique_ptr<SecureAsker> asker(std::uint32_t number) {
    const std::jthread turning([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) server_->turn();
    });
    return std::make_unique<SecureAsker>(server_->address(), number);
  }

  SharedLimits limits_{1000, time::SteadyClock().now(), 1};
  std::vector<std::unique_ptr<WorkerMail>> mail_;
  std::optional<MovedKeys> moved_;
  std::optional<UdpServer> server_;
};

TEST_F(OneOfTwoWorkers, HandsKeysOverWithAMotionAndDoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  start(20);
  constexpr std::uint64_t kOfTheOther = 1;
  const security::KeyBytes anna = security::public_key(1).bytes;
  const auto place = limits_.take({.session = kOfTheOther,
                                   .address = {},
                                   .client = std::string(reinterpret_cast<const char*>(anna.data()), anna.size())},
                                  {.all = 1});
  ASSERT_TRUE(place.has_value());
  for (std::uint32_t i = 1; i <= 3; ++i) {
    const auto client = asker(i);
    client->send(motion_of(kOfTheOther, i));
    const test::AllocationGuard guard;
    server_->turn();
    EXPECT_EQ(guard.heap_operations(), 0U);
    EXPECT_EQ(moved_->count(), i);
  }
}

TEST_F(OneOfTwoWorkers, RefusesAHelloForAnothersSceneWhereTooManyHaveMoved) {
  start(0);
  std::string scene = "shared a";
  while (home_of(scene) != 1) ++scene.back();
  const auto client = asker(1);
  client->send(hello_of(1, scene));
  server_->turn();
  EXPECT_THAT(std::string(client->receive<wire::Refusal>().text), HasSubstr("too many clients are in shared scenes"));
  EXPECT_EQ(server_->encryption()->confirmed(), 1U) << "its keys have stayed";
}

TEST(ServerWorkers, AreAliveWhileAllTurn) {
  ServerWorkers server(listen({"127.0.0.1", 0}), {.workers = 2}, {.scene = "push"}, pushes());
  const time::SteadyClock clock;
  EXPECT_TRUE(server.alive(clock.now()));
  EXPECT_FALSE(server.alive(clock.now() + std::chrono::seconds{10})) << "none has turned since";
  server.turn();
  EXPECT_FALSE(server.alive(clock.now() + std::chrono::seconds{10}));
}

TEST(ServerWorkers, RefuseToBeNone) {
  EXPECT_THROW(ServerWorkers(listen({"127.0.0.1", 0}), {.workers = 0}, {.scene = "push"}, pushes()),
               std::invalid_argument);
  EXPECT_THROW(ServerWorkers(listen({"127.0.0.1", 0}), {.workers = 257}, {.scene = "push"}, pushes()),
               std::invalid_argument);
}

TEST(ServerWorkers, LeaveTheirAddressToNoOtherServer) {
  const ServerWorkers server(listen({"127.0.0.1", 0}), {.workers = 2}, {.scene = "push"}, pushes());
  EXPECT_THROW((void)listen({"127.0.0.1", server.address().port}), std::runtime_error);
}

}  // namespace
}  // namespace forcebound::server
