// Cases 16, 17 and 19: peers with false messages, and malformed datagrams.

#include <gtest/gtest.h>

#include <limits>
#include <numeric>

#include "tests/hard_cases/network_loop.hpp"
#include "tests/tools/sim/draw.hpp"

namespace forcebound::sim {
namespace {

/// A server that replaces its answers.
class HostileServer : public NetworkHardCase {
 protected:
  /// For some time the client gets this in place of each force.
  void answer_with(const std::function<Bytes(const wire::EnvironmentForce&)>& lie) {
    Bytes held;
    wire::Codec reader;
    loop.network().set_tamper([&](std::span<const std::byte> datagram, Nanoseconds) -> std::span<const std::byte> {
      const auto decoded = reader.decode(datagram);
      const auto* message = std::get_if<wire::Message>(&decoded);
      const auto* force = message != nullptr ? std::get_if<wire::EnvironmentForce>(message) : nullptr;
      if (force == nullptr) return datagram;
      ++lies;
      held = lie(*force);
      return held;
    });
    loop.run(2s);
    loop.network().set_tamper({});
    EXPECT_GT(lies, 1000U);
  }

  std::uint64_t lies = 0;
};

TEST_F(HostileServer, Case16ThatAnswersWithRandomBytesIsCountedAndSurvived) {
  Draw draw(16);
  answer_with([&](const auto&) {
    Bytes bytes(draw.index(1500));
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(draw.index(256));
    return bytes;
  });
  loop.run(20ms);
  EXPECT_EQ(malformed(), lies);
  expect_unbroken_and_back();
}

TEST_F(HostileServer, Case16ThatRequestsNaNIsCountedAndSurvived) {
  for (const double value : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    answer_with([&](wire::EnvironmentForce force) {
      force.answer.force.setConstant(value);
      return bytes_of(codec.encode(force));
    });
  }
  loop.run(20ms);
  EXPECT_EQ(malformed(), lies);
  expect_unbroken_and_back();
}

TEST_F(HostileServer, Case16ThatAsksForAnythingAtAllGetsNoMoreThanTheLawAllows) {
  answer_with([&](wire::EnvironmentForce force) {
    force.answer.force.setConstant(force.sequence % 2 == 0 ? 1e300 : -1e300);
    return bytes_of(codec.encode(force));
  });
  EXPECT_EQ(malformed(), 0U);
  expect_unbroken_and_back();
}

TEST_F(HostileServer, Case16ThatAnswersAnotherSessionIsCountedAndSurvived) {
  answer_with([&](wire::EnvironmentForce force) {
    ++force.session;
    return bytes_of(codec.encode(force));
  });
  loop.run(20ms);
  EXPECT_EQ(loop.totals().foreign_session, lies);
  expect_unbroken_and_back();
}

TEST_F(HostileServer, Case16ThatAnswersMotionsNeverSentIsCountedAndSurvived) {
  answer_with([&](wire::EnvironmentForce force) {
    force.motion_sequence += 1'000'000;
    return bytes_of(codec.encode(force));
  });
  loop.run(20ms);
  EXPECT_EQ(malformed(), lies);
  expect_unbroken_and_back();
}

TEST_F(HostileServer, Case16ThatAnswersTenTimesIsHeardOnce) {
  const auto before = loop.totals();
  std::vector<Bytes> copies;
  loop.network().set_tamper([&](std::span<const std::byte> datagram, Nanoseconds) {
    copies.push_back(bytes_of(datagram));
    return datagram;
  });
  for (int i = 0; i < 1000; ++i) {
    loop.run(1ms);
    const auto now = std::exchange(copies, {});
    for (const Bytes& datagram : now) {
      for (int copy = 0; copy < 9; ++copy) send_to_client(datagram);
    }
    copies.clear();
  }
  loop.network().set_tamper({});
  loop.run(500ms);
  EXPECT_NEAR(static_cast<double>(loop.totals().duplicated - before.duplicated), 9000, 100);
  expect_unbroken_and_back();
}

/// All truncations, and all changes of one byte.
std::vector<Bytes> mangled(const Bytes& whole) {
  std::vector<Bytes> result;
  for (std::size_t length = 0; length < whole.size(); ++length) {
    result.emplace_back(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
  }
  for (std::size_t at = 0; at < whole.size(); ++at) {
    for (const std::byte flip : {std::byte{0x01}, std::byte{0x80}, std::byte{0xff}}) {
      result.push_back(whole);
      result.back()[at] ^= flip;
    }
  }
  return result;
}

class Mangled : public NetworkHardCase {
 protected:
  Mangled() {
    loop.network().set_tamper([this](std::span<const std::byte> datagram, Nanoseconds) {
      force = bytes_of(datagram);
      return datagram;
    });
    loop.run(10ms);
    loop.network().set_tamper({});
    const auto decoded = codec.decode(force);
    session = std::get<wire::EnvironmentForce>(std::get<wire::Message>(decoded)).session;
  }

  Bytes force;  ///< a real one
  std::uint64_t session = 0;
};

TEST_F(Mangled, Case17AnswersOfEveryKindAreCountedByTheClientAndChangeNothing) {
  std::uint64_t sent = 0;
  const std::vector<Bytes> answers{
      force,
      bytes_of(codec.encode(wire::Welcome{.client_nonce = 1, .session = session + 1, .scene = "x"})),
      bytes_of(codec.encode(wire::Refusal{.session = session, .reason = wire::RefusalReason::unknown_session})),
      bytes_of(codec.encode(wire::Bye{.session = session})),
      bytes_of(codec.encode(wire::Hello{.client_nonce = 5, .degrees_of_freedom = 3, .device = "x", .period_s = 1e-3})),
      bytes_of(codec.encode(wire::MotionSample{.session = session, .sequence = 1, .position = Vector::Ones(3)}))};
  for (const Bytes& whole : answers) {
    for (const Bytes& datagram : mangled(whole)) {
      send_to_client(datagram);
      if (++sent % 20 == 0) loop.run(1ms);
    }
  }
  loop.run(100ms);
  EXPECT_GT(sent, 500U);
  EXPECT_EQ(malformed(), sent);
  EXPECT_EQ(loop.totals().reconnects, 0U);
  expect_unbroken_and_back();
}

TEST_F(Mangled, Case17QuestionsOfEveryKindAreCountedByTheServerAndChangeNothing) {
  net::DatagramLink& untrusted = loop.network().add_client();
  std::uint64_t sent = 0;
  const std::vector<Bytes> questions{
      bytes_of(codec.encode(wire::Hello{.client_nonce = 5, .degrees_of_freedom = 3, .device = "x", .period_s = 1e-3})),
      bytes_of(codec.encode(wire::MotionSample{
          .session = session, .sequence = 1'000'000, .device_time = 1s, .position = Vector::Ones(3)})),
      bytes_of(codec.encode(wire::Bye{.session = session})),
      force,
      bytes_of(codec.encode(wire::Welcome{.client_nonce = 5, .session = session, .scene = "x"})),
      bytes_of(codec.encode(wire::Refusal{.session = session, .reason = wire::RefusalReason::unknown_session}))};
  for (const Bytes& whole : questions) {
    for (const Bytes& datagram : mangled(whole)) {
      ASSERT_TRUE(untrusted.send(datagram, loop.network().server_address()));
      if (++sent % 20 == 0) loop.run(1ms);
    }
  }
  loop.run(100ms);
  const auto& counts = loop.server()->counters().malformed;
  EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), std::uint64_t{0}), sent);
  EXPECT_EQ(loop.server()->sessions(), 1U);
  expect_unbroken_and_back();
}

TEST_F(NetworkHardCase, Case19DatagramsAsLongAsAndLongerThanAnyNetworkCarries) {
  net::DatagramLink& untrusted = loop.network().add_client();
  const std::array<std::size_t, 7> lengths{1199, 1200, 1201, 1472, 1500, 9000, 65507};
  for (const std::size_t length : lengths) {
    send_to_client(Bytes(length, std::byte{0x46}));
    ASSERT_TRUE(untrusted.send(Bytes(length, std::byte{0x46}), loop.network().server_address()));
    loop.run(1ms);
  }
  loop.run(100ms);
  EXPECT_EQ(malformed(), lengths.size());
  EXPECT_EQ(loop.totals().malformed[wire::Malformed::oversize], 5U);
  const auto& counts = loop.server()->counters().malformed;
  EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), std::uint64_t{0}), lengths.size());
  expect_unbroken_and_back();
}

TEST_F(NetworkHardCase, Case19AGenuineMessageOfFullLengthIsReadAndOneByteMoreIsNot) {
  net::DatagramLink& untrusted = loop.network().add_client();
  const net::Address server = loop.network().server_address();
  Bytes hello = bytes_of(codec.encode(
      wire::Hello{.client_nonce = 5, .degrees_of_freedom = 3, .device = "x", .period_s = 1e-3, .force_N_max = 1}));
  ASSERT_EQ(hello.size(), wire::kFrameBytesMax);
  ASSERT_TRUE(untrusted.send(hello, server));
  hello.push_back(std::byte{0});
  ASSERT_TRUE(untrusted.send(hello, server));

  const std::string words(wire::kTextBytesMax, 'x');
  Bytes refusal = bytes_of(
      codec.encode(wire::Refusal{.session = 5, .reason = wire::RefusalReason::unknown_session, .text = words}));
  ASSERT_GT(refusal.size(), words.size());
  const auto before = loop.totals();
  send_to_client(refusal);
  refusal.resize(wire::kFrameBytesMax + 1);
  send_to_client(refusal);
  loop.run(100ms);
  constexpr auto kOversize = wire::Malformed::oversize;
  EXPECT_EQ(loop.server()->sessions(), 2U);
  EXPECT_EQ(loop.server()->counters().malformed[kOversize], 1U);
  EXPECT_EQ(loop.totals().foreign_session, before.foreign_session + 1);
  EXPECT_EQ(loop.totals().malformed[kOversize], before.malformed[kOversize] + 1);
  EXPECT_EQ(loop.totals().reconnects, 0U);
  expect_unbroken_and_back();
}

}  // namespace
}  // namespace forcebound::sim
