// Cases 13 to 15 and 18: effects of delay, loss and killed programs on a session in contact.
//
//     trace-sphere at the omni -- session ==( 5 ms each way, and worse )== server, sphere

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "forcebound/device/simulated/make_operator.hpp"
#include "forcebound/time/sequence_window.hpp"
#include "tests/hard_cases/network_loop.hpp"
#include "tests/tools/data/recorded_data.hpp"

namespace forcebound::sim {
namespace {

using netem::Direction;
using nlohmann::json;

class Overtaken : public NetworkHardCase {
 protected:
  Overtaken() : NetworkHardCase(omni_on_the_sphere("delay 10ms 10ms duplicate 30%")) {}
};

TEST_F(Overtaken, Case13DuplicatedAndReorderedDatagramsAreCountedAndDoNoHarm) {
  expect_unbroken_and_back();
  EXPECT_GT(loop.totals().duplicated, 500U);
  EXPECT_GT(loop.totals().reordered, 500U);
}

TEST_F(NetworkHardCase, Case13TenSecondsOldDatagramsAreNotTakenForNew) {
  std::vector<Bytes> old;
  loop.network().set_tamper([&](std::span<const std::byte> datagram, Nanoseconds) {
    old.push_back(bytes_of(datagram));
    return datagram;
  });
  loop.run(500ms);
  loop.network().set_tamper({});
  loop.run(10s);
  const auto before = loop.totals();
  for (const Bytes& datagram : old) {
    send_to_client(datagram);
    loop.run(1ms);
  }
  loop.run(100ms);
  const auto after = loop.totals();
  // A copy, or too old for its motion to be known.
  using enum wire::Malformed;
  EXPECT_EQ(after.duplicated + after.malformed[unreadable] - before.duplicated - before.malformed[unreadable],
            old.size());
  expect_unbroken_and_back();
}

TEST_F(NetworkHardCase, Case13AWholeEarlierSessionPlayedBackIsForeign) {
  std::vector<Bytes> earlier;
  loop.network().set_tamper([&](std::span<const std::byte> datagram, Nanoseconds) {
    earlier.push_back(bytes_of(datagram));
    return datagram;
  });
  loop.run(1s);
  loop.network().set_tamper({});
  loop.kill_server();
  loop.run(300ms);
  loop.start_server();
  loop.run(2s);
  ASSERT_EQ(loop.totals().reconnects, 1U);
  const auto before = loop.totals().foreign_session;
  for (const Bytes& datagram : earlier) {
    send_to_client(datagram);
    loop.run(1ms);
  }
  loop.run(100ms);
  EXPECT_EQ(loop.totals().foreign_session - before, earlier.size());
  expect_unbroken_and_back();
}

TEST(SequenceWindow, Case13WrapsAroundWithoutLosingACopyOrALatecomer) {
  using Arrival = time::SequenceWindow::Arrival;
  time::SequenceWindow window;
  const std::uint64_t start = ~std::uint64_t{0} - 5;
  for (std::uint64_t i = 0; i < 12; i += 2) EXPECT_EQ(window.add(start + i), Arrival::newest) << i;
  for (std::uint64_t i = 1; i < 10; i += 2) EXPECT_EQ(window.add(start + i), Arrival::late) << i;
  for (std::uint64_t i = 0; i < 10; ++i) EXPECT_EQ(window.add(start + i), Arrival::duplicate) << i;
}

TEST_F(NetworkHardCase, Case13AServerAnswersMotionWhoseNumbersWrapAround) {
  net::DatagramLink& untrusted = loop.network().add_client();
  const net::Address server = loop.network().server_address();
  std::array<std::byte, 2048> buffer{};
  ASSERT_TRUE(untrusted.send(
      codec.encode(wire::Hello{
          .client_nonce = 77, .degrees_of_freedom = 3, .device = "untrusted", .period_s = 1e-3, .force_N_max = 1}),
      server));
  loop.run(20ms);
  const auto received = untrusted.receive(buffer);
  ASSERT_TRUE(received.has_value());
  const auto decoded = codec.decode(std::span(buffer).first(received->bytes));
  const auto* message = std::get_if<wire::Message>(&decoded);
  ASSERT_NE(message, nullptr);
  const std::uint64_t session = std::get<wire::Welcome>(*message).session;
  constexpr std::uint64_t kMotions = 40;
  for (std::uint64_t i = 0; i < kMotions; ++i) {
    const std::uint64_t sequence = ~std::uint64_t{0} - kMotions / 2 + i;
    const wire::MotionSample motion{
        .session = session, .sequence = sequence, .device_time = loop.time(), .position = Vector::Zero(3)};
    ASSERT_TRUE(untrusted.send(codec.encode(motion), server));
    loop.run(1ms);
  }
  loop.run(20ms);
  std::uint64_t answers = 0;
  while (untrusted.receive(buffer)) ++answers;
  EXPECT_EQ(answers, kMotions);
  expect_unbroken_and_back();
}

TEST_F(NetworkHardCase, Case14AllLostForAMinuteAndBack) {
  loop.network().set_blackhole(Direction::up, true);
  loop.network().set_blackhole(Direction::down, true);
  loop.run(60s);
  EXPECT_NE(loop.session().state(), client::SessionState::active);
  loop.network().set_blackhole(Direction::up, false);
  loop.network().set_blackhole(Direction::down, false);
  expect_unbroken_and_back();
  const json summary = json::parse(loop.close().to_json());
  EXPECT_EQ(summary["blackouts"]["longest"]["died"], "both");
}

TEST_F(NetworkHardCase, Case14OneWayLostForAMinuteAndBackAndItIsSaidWhich) {
  for (const Direction direction : {Direction::up, Direction::down}) {
    SCOPED_TRACE(direction == Direction::up ? "up" : "down");
    loop.network().set_blackhole(direction, true);
    loop.run(50s);
    loop.network().set_blackhole(direction, false);
    expect_unbroken_and_back();
    loop.run(10s);
  }
  const auto totals = loop.totals();
  EXPECT_NEAR(static_cast<double>(totals.lost_up), 50'000, 10);
  EXPECT_NEAR(static_cast<double>(totals.lost_down), 50'000, 10);
}

TEST_F(NetworkHardCase, Case14OneWayLostForLongerThanTheServerWaitsAndBack) {
  // Without motion the server closes the session after a minute; without answers only the client notices.
  loop.network().set_blackhole(Direction::up, true);
  loop.run(65s);
  EXPECT_NE(loop.session().state(), client::SessionState::active);
  EXPECT_EQ(loop.server()->sessions(), 0U);
  EXPECT_EQ(loop.server()->counters().sessions_idle, 1U);
  loop.network().set_blackhole(Direction::up, false);
  expect_unbroken_and_back();
  EXPECT_EQ(loop.totals().reconnects, 1U);

  loop.network().set_blackhole(Direction::down, true);
  loop.run(65s);
  EXPECT_NE(loop.session().state(), client::SessionState::active);
  EXPECT_EQ(loop.server()->sessions(), 1U) << "its motion still comes";
  loop.network().set_blackhole(Direction::down, false);
  expect_unbroken_and_back();
  EXPECT_EQ(loop.totals().reconnects, 1U);
  EXPECT_GT(loop.totals().lost_down, 64'900U);
}

TEST_F(NetworkHardCase, Case15AServerKilledInContactAndRestarted) {
  for (int i = 0; i < 3; ++i) {
    const std::uint64_t pushed = never.pushed;
    loop.kill_server();
    loop.run(1500ms);
    EXPECT_NE(loop.session().state(), client::SessionState::active);
    loop.start_server();
    loop.run(1s);
    EXPECT_EQ(loop.session().state(), client::SessionState::active) << "a new session within a second";
    EXPECT_GT(never.pushed, pushed + 500) << "felt until the policy dropped it, and felt again";
  }
  EXPECT_EQ(loop.totals().reconnects, 3U);
  expect_unbroken_and_back();
}

TEST_F(NetworkHardCase, Case15AClientKilledInContactAndRestarted) {
  // The killed client sends no Bye; both use the same server.
  for (int i = 0; i < 3; ++i) {
    device::SimulatedDevice device(device::load_device("omni"), device::make_operator("trace-sphere", 3));
    VirtualClock clock(loop.time());
    const auto options = client::Session::Options{.server = loop.network().server_address(),
                                                  .seed = 90U + static_cast<std::uint64_t>(i)};
    client::Session killed(options, device, control::force_bounding_laws().make("fba-exact", device.facts()),
                           loop.network().add_client(), clock, {});
    for (int tick = 0; tick < 1000; ++tick) {
      clock.set(loop.time());
      killed.tick(loop.time());
      loop.run(1ms);
    }
    EXPECT_EQ(killed.state(), client::SessionState::active);
    EXPECT_EQ(loop.server()->sessions(), 2U + static_cast<std::size_t>(i));
  }
  loop.run(70s);
  EXPECT_EQ(loop.server()->sessions(), 1U) << "the dead sessions are closed after a minute";
  expect_unbroken_and_back();
}

TEST(NetworkHardCaseOfTwelveSeconds, Case18RoundTripOfTwelveSecondsIsFadedToNothingAndCounted) {
  auto settings = omni_on_the_sphere("delay 6s limit 20000");
  NeverBroken never(settings.device.facts.force_N_max);
  ClosedLoop loop(settings, {&never});
  loop.run(60s);
  const json summary = json::parse(loop.close().to_json());
  EXPECT_EQ(never.broken, 0U);
  EXPECT_EQ(never.pushed, 0U) << "a force twelve seconds old is dropped";
  EXPECT_GT(summary["received"], 30'000);
  EXPECT_NEAR(summary["rtt_us"]["p50"].get<double>(), 12e6, 5e4);
}

TEST(NetworkHardCaseOfTwelveSeconds, Case18TheRecordedRuralNetworkIsSurvived) {
  const auto trace = recorded_data("network/5g-rural-n8.csv");
  if (!trace) GTEST_SKIP() << "no recorded data; FORCEBOUND_DATA names its folder";
  auto settings = omni_on_the_sphere();
  settings.network.up = settings.network.down = {};
  settings.network.trace = netem::load_trace(trace->string());
  NeverBroken never(settings.device.facts.force_N_max);
  ClosedLoop loop(settings, {&never});
  loop.run(127s);
  const json summary = json::parse(loop.close().to_json());
  EXPECT_EQ(never.broken, 0U);
  EXPECT_GT(never.pushed, 10'000U);
  EXPECT_GT(summary["force_age_ms"]["max"], 5000) << "includes the twelve seconds";
}

}  // namespace
}  // namespace forcebound::sim
