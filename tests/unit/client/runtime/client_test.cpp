#include "forcebound/client/runtime/client.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>

#include "forcebound/client/runtime/event_queue.hpp"
#include "forcebound/control/law_registry.hpp"
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

}  // namespace
}  // namespace forcebound::client
