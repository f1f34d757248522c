#include "forcebound/client/runtime/client.hpp"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "forcebound/client/runtime/event_queue.hpp"
#include "forcebound/control/law_registry.hpp"
#include "forcebound/net/udp_link.hpp"
#include "tests/support/fake_device.hpp"

namespace forcebound::client {
namespace {

/// A closed port.
Client::Settings closed_port() { return {.server = "127.0.0.1:9", .seed = 3, .duration_s = 0.05}; }

Client client_of(const Client::Settings& settings, device::HapticDevice& device) {
  return Client(settings, device, control::force_bounding_laws().make("fba-exact", device.facts()));
}

TEST(Client, EndsWithZeroForceWithoutAServer) {
  test::FakeDevice device(1);
  device.applied = control::Vector::Constant(1, 5);
  Client client = client_of(closed_port(), device);
  const std::atomic<bool> stop{false};
  int kept = 0;
  client.run(stop, [&](time::Nanoseconds, time::Nanoseconds) { ++kept; });
  EXPECT_EQ(device.applied, control::Vector(control::Vector::Zero(1)));
  EXPECT_GT(kept, 0);
  EXPECT_EQ(client.why_no_session(), "");
  EXPECT_NE(client.summary().to_json().find("\"fba-exact\""), std::string::npos);
  EXPECT_NE(client.summary().to_json().find("\"local\""), std::string::npos) << "unless it is told otherwise";
}

TEST(Client, SaysWhyItGaveUp) {
  test::FakeDevice device(1);
  Client::Settings settings = closed_port();
  settings.once = true;
  Client client = client_of(settings, device);
  const std::atomic<bool> stop{false};
  client.run(stop);
  EXPECT_EQ(client.why_no_session().find("no answer from 127.0.0.1:9"), 0U);
}

TEST(Client, EndsAtOnceWhenItIsStopped) {
  test::FakeDevice device(1);
  Client::Settings settings = closed_port();
  settings.duration_s = 0;
  Client client = client_of(settings, device);
  const std::atomic<bool> stop{true};
  client.run(stop);
  EXPECT_EQ(device.applied, control::Vector(control::Vector::Zero(1)));
}

TEST(Client, EndsTheLoopIfItsHousekeepingThrows) {
  test::FakeDevice device(1);
  Client::Settings settings = closed_port();
  settings.duration_s = 0;
  Client client = client_of(settings, device);
  const std::atomic<bool> stop{false};
  const auto fails = [](time::Nanoseconds, time::Nanoseconds) { throw std::runtime_error("no terminal"); };
  EXPECT_THROW(client.run(stop, fails), std::runtime_error);
  EXPECT_EQ(device.applied, control::Vector(control::Vector::Zero(1)));
}

TEST(Client, RefusesAServerThatIsNoAddress) {
  test::FakeDevice device(1);
  Client::Settings settings = closed_port();
  settings.server = "somewhere";
  EXPECT_THROW((void)client_of(settings, device), std::exception);
}

TEST(Client, RecordsTicksAsTheyAreAmended) {
  struct AnHourOld final : TickAmendment {
    void on_force(const record::ForceRecord& /*force*/) noexcept override {}
    void amend(record::TickRecord& tick) noexcept override {
      tick.force_sequence = tick.tick;
      tick.force_age = std::chrono::hours{1};
    }
  };
  struct OtherAges final : record::TickSink {
    void on_tick(const record::TickRecord& tick) noexcept override {
      if (tick.force_age != std::chrono::hours{1}) ++count;
    }
    int count = 0;
  };
  test::FakeDevice device(1);
  AnHourOld amendment;
  OtherAges others;
  Client::Settings settings = closed_port();
  settings.amendment = &amendment;
  Client client(settings, device, control::force_bounding_laws().make("fba-exact", device.facts()), {&others});
  const std::atomic<bool> stop{false};
  client.run(stop);
  EXPECT_EQ(others.count, 0);
  EXPECT_NE(client.summary().to_json().find("3600000"), std::string::npos) << "ms";
}

TEST(EventQueue, CountsWhatItHasNoRoomFor) {
  EventQueue queue;
  Event event;
  EXPECT_FALSE(queue.take(event));
  event.set_text("first");
  queue.on_event(event);
  for (int i = 0; i < 1000; ++i) queue.on_event(Event());
  EXPECT_GT(queue.dropped(), 0U);
  ASSERT_TRUE(queue.take(event));
  EXPECT_EQ(event.words(), "first");
}

/// A client by a name, which leads nowhere at first and then to an address.
struct ByName {
  explicit ByName(const net::Address& address, int failures)
      : settings{.server = "haptics.example:47800",
                 .resolver = [address, left = std::make_shared<std::atomic<int>>(failures)](const net::Endpoint&) {
                   if ((*left)-- > 0) throw std::runtime_error("nobody knows it");
                   return std::vector{address};
                 }} {}

  Client::Settings settings;
};

TEST(Client, GoesOnWithoutAnAddressAndUsesTheOneThatItsServersNameIsGivenLater) {
  net::UdpLink server = net::UdpLink::listen(net::resolve({"127.0.0.1", 0}));
  test::FakeDevice device(1);
  Client client = client_of(ByName(server.local_address(), 2).settings, device);
  EXPECT_EQ(client.take_server_problem(), "nobody knows it");
  EXPECT_EQ(client.server_in_words(), "haptics.example:47800 (nobody knows it)");
  std::atomic<bool> stop{false};
  std::array<std::byte, net::kDatagramBytesMax> buffer{};
  client.run(stop, [&](time::Nanoseconds, time::Nanoseconds elapsed) {
    if (server.receive(buffer) || elapsed > std::chrono::seconds{60}) stop = true;
  });
  EXPECT_EQ(client.server_in_words(), "haptics.example:47800 (at " + net::to_string(server.local_address()) + ")");
}

TEST(Client, SaysTheAddressesOfAServerThatDoesNotAnswer) {
  const net::UdpLink server = net::UdpLink::listen(net::resolve({"127.0.0.1", 0}));
  test::FakeDevice device(1);
  Client::Settings settings = ByName(server.local_address(), 0).settings;
  settings.once = true;
  settings.duration_s = 0.05;
  Client client = client_of(settings, device);
  const std::atomic<bool> stop{false};
  client.run(stop);
  EXPECT_EQ(client.why_no_session(),
            "no answer from haptics.example:47800 (at " + net::to_string(server.local_address()) + ")");
}

TEST(Client, SendsNothingInTheClearToAnotherMachineThatItsServersNameLeadsTo) {
  const net::Address elsewhere = net::resolve({"192.0.2.1", 47800});
  test::FakeDevice device(1);
  EXPECT_THROW(client_of(ByName(elsewhere, 0).settings, device), std::invalid_argument);
  Client later = client_of(ByName(elsewhere, 1).settings, device);
  (void)later.take_server_problem();
  std::atomic<bool> stop{false};
  std::string problem;
  later.run(stop, [&](time::Nanoseconds, time::Nanoseconds elapsed) {
    if (problem.empty()) problem = later.take_server_problem();
    if (!problem.empty() || elapsed > std::chrono::seconds{60}) stop = true;
  });
  EXPECT_NE(problem.find("is on another machine, and no keys are given"), std::string::npos) << problem;
  EXPECT_EQ(later.server_in_words().find("192.0.2.1"), std::string::npos);
}

}  // namespace
}  // namespace forcebound::client
