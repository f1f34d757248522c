#include <forcebound.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <thread>

#include "tests/library/handles.hpp"

namespace forcebound::library {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr const char* kNobody = "127.0.0.1:9";

/// A device that stands still, and does on its 50th reading what a test says.
struct StillDevice {
  std::atomic<int> readings{0};
  std::atomic<int> commands{0};
  std::atomic<int> stops{0};
  std::atomic<double> force_N{9};
  void (*at_fifty)() = [] {};
};

fb_status read_still(void* user, fb_reading* reading) {
  auto& device = *static_cast<StillDevice*>(user);
  reading->position_m[0] = 0.001;
  if (++device.readings == 50) device.at_fifty();
  return FB_OK;
}

fb_status command_still(void* user, const double* force_N, std::size_t axes) {
  auto& device = *static_cast<StillDevice*>(user);
  ++device.commands;
  device.force_N = axes == 1 ? force_N[0] : -1;
  return FB_OK;
}

fb_device_callbacks callbacks_of(StillDevice& still) {
  fb_device_callbacks callbacks = FB_INIT(fb_device_callbacks);
  callbacks.user = &still;
  callbacks.read = read_still;
  callbacks.command = command_still;
  callbacks.stop = [](void* user) { ++static_cast<StillDevice*>(user)->stops; };
  return callbacks;
}

fb_client_settings briefly() {
  fb_client_settings settings = FB_INIT(fb_client_settings);
  settings.server = kNobody;
  settings.duration_s = 0.3;
  settings.once = 1;
  return settings;
}

Owned<fb_client> client_of(const fb_client_settings& settings, const Owned<fb_device>& device) {
  fb_client* client = nullptr;
  EXPECT_EQ(fb_client_create(&settings, device.get(), &client), FB_OK) << fb_last_error();
  return Owned<fb_client>(client);
}

fb_client_state state_of(const Owned<fb_client>& client) {
  fb_client_state state = FB_INIT(fb_client_state);
  EXPECT_EQ(fb_client_look(client.get(), &state), FB_OK) << fb_last_error();
  return state;
}

TEST(LibraryClient, TicksADeviceOfCallbacksAndSaysWhyThereWasNoSession) {
  StillDevice still;
  Owned<fb_device> device = still_device(callbacks_of(still));
  const Owned<fb_client> client = client_of(briefly(), device);
  device.reset();  // the client has it
  ASSERT_EQ(fb_client_start(client.get()), FB_OK) << fb_last_error();
  EXPECT_EQ(fb_client_start(client.get()), FB_NOT_NOW);
  EXPECT_THAT(fb_last_error(), HasSubstr("a client runs once"));
  std::size_t needed = 0;
  EXPECT_EQ(fb_client_summary(client.get(), nullptr, 0, &needed), FB_NOT_NOW);
  EXPECT_EQ(fb_client_wait(client.get(), -1), FB_FAILED);
  EXPECT_THAT(fb_last_error(), HasSubstr("fb_client_wait: no answer from 127.0.0.1:9"));

  const fb_client_state state = state_of(client);
  EXPECT_EQ(state.running, 0);
  EXPECT_GT(state.ticks, 0U);
  EXPECT_EQ(state.position_m[0], 0.001);
  EXPECT_EQ(still.force_N, 0);
  EXPECT_EQ(fb_client_summary(client.get(), nullptr, 0, &needed), FB_TOO_SMALL);
  std::string json(needed, '?');
  ASSERT_EQ(fb_client_summary(client.get(), json.data(), json.size(), nullptr), FB_OK);
  EXPECT_THAT(json, AllOf(HasSubstr("\"still\""), HasSubstr("\"fba-exact\"")));
  EXPECT_EQ(json.find('\0'), needed - 1);
}

/// A callback that throws, and one that takes 100 ms: zero force, counted, and it goes on.
TEST(LibraryClient, OutlivesCallbacksThatThrowOrTakeTooLong) {
  StillDevice throws;
  throws.at_fifty = [] { throw std::runtime_error("of a program in C++"); };
  StillDevice sleeps;
  sleeps.at_fifty = [] { std::this_thread::sleep_for(std::chrono::milliseconds{100}); };
  for (StillDevice* const still : {&throws, &sleeps}) {
    const Owned<fb_device> device = still_device(callbacks_of(*still));
    const Owned<fb_client> client = client_of(briefly(), device);
    ASSERT_EQ(fb_client_start(client.get()), FB_OK);
    EXPECT_EQ(fb_client_wait(client.get(), -1), FB_FAILED);  // nobody answers
    const fb_client_state state = state_of(client);
    EXPECT_EQ(state.callbacks_failed, still == &throws ? 1U : 0U);
    EXPECT_GE(state.callbacks_late, still == &throws ? 0U : 1U);
    EXPECT_GT(still->readings, 50);
    EXPECT_EQ(still->force_N, 0);
  }
  EXPECT_GE(sleeps.stops, 1);  // by the watchdog, meanwhile
}

TEST(LibraryClient, RunsWithASimulatedDeviceAndKnowsP) {
  fb_device* opened = nullptr;
  ASSERT_EQ(fb_device_open("wall-1dof", nullptr, &opened), FB_OK) << fb_last_error();
  const Owned<fb_device> device(opened);
  const Owned<fb_client> client = client_of(briefly(), device);
  fb_client* another = nullptr;
  const fb_client_settings settings = briefly();
  EXPECT_EQ(fb_client_create(&settings, device.get(), &another), FB_NOT_NOW);
  EXPECT_THAT(fb_last_error(), HasSubstr("another client has this device"));
  ASSERT_EQ(fb_client_start(client.get()), FB_OK);
  (void)fb_client_wait(client.get(), -1);
  fb_ledger ledger = FB_INIT(fb_ledger);
  ASSERT_EQ(fb_client_ledger(client.get(), &ledger), FB_OK);
  EXPECT_EQ(ledger.audited, 1);
  EXPECT_GE(ledger.P_J, 0);
  EXPECT_EQ(ledger.P_J_least, 0);
}

/// Of an older header: settings that end behind the server, a state that ends behind the position.
TEST(LibraryClient, TakesTheSmallerStructsOfAnOlderProgram) {
  StillDevice still;
  const Owned<fb_device> device = still_device(callbacks_of(still));
  fb_client_settings settings = briefly();
  std::memset(static_cast<void*>(&settings.scene), 0x5a, sizeof settings - offsetof(fb_client_settings, scene));
  settings.size = offsetof(fb_client_settings, scene);
  const Owned<fb_client> client = client_of(settings, device);
  ASSERT_EQ(fb_client_start(client.get()), FB_OK) << fb_last_error();
  while (state_of(client).ticks < 20) std::this_thread::sleep_for(std::chrono::milliseconds{1});
  EXPECT_EQ(fb_client_stop(client.get()), FB_OK) << fb_last_error();  // it was not to give up
  fb_client_state state = FB_INIT(fb_client_state);
  state.size = offsetof(fb_client_state, request_N);
  state.request_N[0] = 42;
  ASSERT_EQ(fb_client_look(client.get(), &state), FB_OK);
  EXPECT_EQ(state.position_m[0], 0.001);
  EXPECT_EQ(state.request_N[0], 42);
}

TEST(LibraryClient, TakesALawOfYourOwnWithItsParameters) {
  StillDevice still;
  const Owned<fb_device> device = still_device(callbacks_of(still));
  fb_client_settings settings = briefly();
  settings.law = FORCEBOUND_TEST_LAWS "/forcebound-law-saver.so";
  settings.law_parameters = "[saver]\nshare = 7\n";
  fb_client* refused = nullptr;
  EXPECT_NE(fb_client_create(&settings, device.get(), &refused), FB_OK);
  EXPECT_THAT(fb_last_error(), AllOf(HasSubstr("law_parameters:2"), HasSubstr("share")));
  settings.law_parameters = "[saver]\nshare = 0.25\n";
  const Owned<fb_client> client = client_of(settings, device);
  ASSERT_EQ(fb_client_start(client.get()), FB_OK);
  (void)fb_client_wait(client.get(), -1);  // nobody answers
  std::string json(1 << 16, ' ');
  ASSERT_EQ(fb_client_summary(client.get(), json.data(), json.size(), nullptr), FB_OK) << fb_last_error();
  EXPECT_THAT(json, AllOf(HasSubstr("\"saver\""), HasSubstr("share 0.25")));
}

TEST(LibraryClient, RefusesWhatCannotBeInOneLine) {
  StillDevice still;
  fb_device_callbacks callbacks = callbacks_of(still);
  callbacks.read = nullptr;
  fb_facts* parsed = nullptr;
  ASSERT_EQ(fb_facts_parse(kStillFacts, "still", &parsed), FB_OK);
  const Owned<fb_facts> facts(parsed);
  fb_device* made = nullptr;
  EXPECT_EQ(fb_device_of_callbacks(facts.get(), &callbacks, &made), FB_INVALID);
  EXPECT_THAT(fb_last_error(), HasSubstr("read and command must be functions, got null"));
  EXPECT_EQ(fb_device_open("omny", nullptr, &made), FB_INVALID);
  EXPECT_THAT(fb_last_error(), HasSubstr("omni"));
  EXPECT_EQ(made, nullptr);

  const Owned<fb_device> device = still_device(callbacks_of(still));
  const auto refused = [&](const fb_client_settings& settings, const std::string& why) {
    fb_client* client = nullptr;
    EXPECT_NE(fb_client_create(&settings, device.get(), &client), FB_OK) << why;
    EXPECT_THAT(fb_last_error(), HasSubstr(why));
    EXPECT_EQ(client, nullptr);
  };
  fb_client_settings settings = briefly();
  settings.size = 3;
  refused(settings, "fb_client_settings.size is 3");
  settings = briefly();
  settings.server = nullptr;
  refused(settings, "server must be HOST:PORT, got null");
  settings.server = "nowhere";
  refused(settings, "nowhere");
  settings = briefly();
  settings.law = "fba-exakt";
  refused(settings, "fba-exact");
  settings = briefly();
  settings.server = "192.0.2.1:47800";
  refused(settings, "no keys are given; accepted are 'server_key' or 'known_servers', 'shared_key', or 'insecure'");
  settings.server_key = "a";
  settings.trust_new = 1;
  refused(settings, "'server_key' says the server's key; 'known_servers' and 'trust_new' go without it");
  settings = briefly();
  settings.recording = "/no/such/folder/run.mcap";
  refused(settings, "/no/such/folder/run.mcap");
  (void)client_of(briefly(), device);  // the device is free after all that
}

}  // namespace
}  // namespace forcebound::library
