#pragma once

#include <cstdint>
#include <memory>
#include <utility>

#include "forcebound/server/session/replies.hpp"
#include "forcebound/server/session/server_options.hpp"
#include "forcebound/server/session/session_table.hpp"
#include "tests/unit/server/session/server_fixture.hpp"

namespace forcebound::server {

/// One newton, wherever it is asked.
class OneNewton final : public Environment {
 public:
  Answer respond(const Motion& /*motion*/) noexcept override { return {.force = vector_of({1})}; }
};

/// A table of sessions without a server, which the test fills. What is sent is recorded.
class PartsFixture : public testing::Test {
 protected:
  /// A session of one degree of freedom, begun now at port `number`, with `number` as nonce.
  Session& open(std::uint64_t number, const std::string& client = {}) {
    const auto from = address(static_cast<std::uint16_t>(number));
    Session session{
        .info = {.session = number, .address = from, .device = "stick", .degrees_of_freedom = 1, .scene = kind->name},
        .nonce = number,
        .kind = kind,
        .made = {.environment = std::make_unique<OneNewton>()},
        .place = {},
        .server_side = {},
        .rate = time::TokenBucket(milliseconds{1}, 1000, clock.time),
        .hellos = time::TokenBucket(milliseconds{50}, 20, clock.time),
        .last_received = clock.time,
        .last_moved = clock.time,
        .proven_at = from,
        .compute = ComputeShare(options.session_compute_max, clock.time)};
    session.arrivals.counts.session = number;
    session.arrivals.motions_per_s_max = 4000;
    session.client = client;
    return table.open(std::move(session));
  }

  /// What was sent since the last call, which must be one message.
  template <class T>
  T only_sent() {
    EXPECT_EQ(link.sent.size(), 1U);
    const auto message = std::get<wire::Message>(decoder_.decode(link.sent.at(0).bytes));
    link.sent.clear();
    return std::get<T>(message);
  }

  ServerOptions options;
  test::FakeClock clock;
  test::FakeLink link;
  Diary diary;
  ServerCounters counters;
  Replies replies{link, counters, diary};
  SessionTable table{options.sessions_max, replies, counters, diary};
  std::shared_ptr<EnvironmentKind> kind = std::make_shared<EnvironmentKind>(EnvironmentKind{.name = "newton"});

 private:
  wire::Codec decoder_;
};

}  // namespace forcebound::server
