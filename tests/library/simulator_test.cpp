#include <forcebound.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>

#include "tests/library/handles.hpp"
#include "tests/support/becomes_true.hpp"
#include "tests/support/special_numbers.hpp"

/// Client of the library ==( UDP of this machine )== server of the library -- a simulator, stepped by the test.
namespace forcebound::library {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr const char* kThreeAxes =
    "kind = \"cartesian\"\ndegrees_of_freedom = 3\ndamping_N_s_per_m = 5\nforce_N_max = 20\nhold_s_max = 0.005\n";
constexpr double kDepth_m = 0.001;

Owned<fb_server> started() {
  const fb_server_settings settings = at_free_port();
  fb_simulator simulator = FB_INIT(fb_simulator);
  simulator.name = "floor";
  fb_server* server = nullptr;
  EXPECT_EQ(fb_server_of_simulator(&settings, &simulator, &server), FB_OK) << fb_last_error();
  Owned<fb_server> owned(server);
  EXPECT_EQ(fb_server_start(server), FB_OK) << fb_last_error();
  return owned;
}

/// A device of three axes that is held below the floor.
Owned<fb_client> held_below(const std::string& address) {
  fb_facts* facts = nullptr;
  EXPECT_EQ(fb_facts_parse(kThreeAxes, "held", &facts), FB_OK) << fb_last_error();
  fb_device_callbacks callbacks = FB_INIT(fb_device_callbacks);
  callbacks.read = [](void*, fb_reading* reading) -> fb_status {
    reading->position_m[2] = -kDepth_m;
    return FB_OK;
  };
  callbacks.command = [](void*, const double*, std::size_t) -> fb_status { return FB_OK; };
  fb_device* device = nullptr;
  EXPECT_EQ(fb_device_of_callbacks(facts, &callbacks, &device), FB_OK) << fb_last_error();
  const Owned<fb_device> owned(device);
  fb_facts_destroy(facts);
  fb_client_settings settings = FB_INIT(fb_client_settings);
  settings.server = address.c_str();
  settings.once = 1;
  fb_client* client = nullptr;
  EXPECT_EQ(fb_client_create(&settings, device, &client), FB_OK) << fb_last_error();
  EXPECT_EQ(fb_client_start(client), FB_OK) << fb_last_error();
  return Owned<fb_client>(client);
}

fb_touch floor_below() {
  fb_touch touch = FB_INIT(fb_touch);
  touch.normal[2] = 1;
  return touch;
}

/// Asks, and gives the first probe. @returns how many there are
std::size_t ask(const Owned<fb_server>& server, fb_probe& probe) {
  std::size_t probes = 0;
  EXPECT_EQ(fb_server_ask(server.get(), &probes), FB_OK) << fb_last_error();
  probe = FB_INIT(fb_probe);
  EXPECT_EQ(fb_server_probe(server.get(), 0, &probe), probes > 0 ? FB_OK : FB_NOTHING);
  return probes;
}

TEST(LibrarySimulator, IsFeltBetweenItsStepsAndIsToldHowItWasPushed) {
  const Owned<fb_server> server = started();
  const Owned<fb_client> client = held_below(state_of(server).address);
  fb_probe probe;
  double pushed_N = 0;  // in the mean
  std::uint32_t body = 0;
  const auto pushes_the_floor = [&] {
    if (ask(server, probe) == 0) return false;
    pushed_N = 0;
    fb_push push = FB_INIT(fb_push);
    for (std::size_t i = 0; fb_server_push(server.get(), 0, i, &push) == FB_OK; ++i) {
      pushed_N += push.impulse_Ns[2] / probe.interval_s;
      body = push.body;
    }
    fb_touch touch = floor_below();
    touch.body = 7;
    EXPECT_EQ(fb_server_report(server.get(), probe.client, &touch, 1), FB_OK) << fb_last_error();
    return pushed_N < -1.9;
  };
  EXPECT_TRUE(test::becomes_true(pushes_the_floor));
  // Of the coupling's 2000 N/m, on a contact that is a little soft.
  EXPECT_GT(pushed_N, -2.01);
  EXPECT_EQ(body, 7U);
  fb_client_state felt = FB_INIT(fb_client_state);
  EXPECT_TRUE(test::becomes_true([&] {
    (void)pushes_the_floor();
    return fb_client_look(client.get(), &felt) == FB_OK && felt.request_N[2] > 1.9;
  }));
  EXPECT_LT(felt.request_N[2], 2.01);
  EXPECT_EQ(felt.contact, 1);
  EXPECT_STREQ(felt.simulated, "floor");
}

TEST(LibrarySimulator, FadesWhenItSaysNothingForASecond) {
  const Owned<fb_server> server = started();
  const Owned<fb_client> client = held_below(state_of(server).address);
  fb_client_state felt = FB_INIT(fb_client_state);
  fb_probe probe;
  ASSERT_TRUE(test::becomes_true([&] {
    const fb_touch touch = floor_below();
    if (ask(server, probe) > 0) {
      EXPECT_EQ(fb_server_report(server.get(), probe.client, &touch, 1), FB_OK);
    }
    return fb_client_look(client.get(), &felt) == FB_OK && felt.request_N[2] > 1;
  }));
  EXPECT_TRUE(
      test::becomes_true([&] { return fb_client_look(client.get(), &felt) == FB_OK && felt.request_N[2] == 0; }));
}

TEST(LibrarySimulator, RefusesAndCountsReportsThatCannotBe) {
  const Owned<fb_server> server = started();
  const auto refused = [&](std::uint64_t client, const fb_touch* touches, std::size_t count, fb_status status,
                           const std::string& why) {
    EXPECT_EQ(fb_server_report(server.get(), client, touches, count), status) << why;
    EXPECT_THAT(fb_last_error(), AllOf(HasSubstr("fb_server_report: "), HasSubstr(why)));
  };
  fb_touch touch = floor_below();
  refused(1, &touch, 1, FB_NOT_NOW, "client 1 is not there");
  refused(1, nullptr, 1, FB_INVALID, "touches is null");
  refused(1, &touch, 4, FB_INVALID, "count is 4, accepted are up to 3");
  touch.size = 3;
  refused(1, &touch, 1, FB_INVALID, "fb_touch.size is 3");
  touch = floor_below();
  touch.normal[2] = 2;
  refused(1, &touch, 1, FB_INVALID, "touches[0].normal must be of length 1");
  touch = floor_below();
  touch.place_m[1] = test::kNaN;
  refused(1, &touch, 1, FB_INVALID, "touches[0].place_m must be finite");
  touch = floor_below();
  touch.mobility_per_kg[0] = -1;
  refused(1, &touch, 1, FB_INVALID, "touches[0].mobility_per_kg must be symmetric");
  touch = floor_below();
  touch.friction = -0.1;
  refused(1, &touch, 1, FB_INVALID, "touches[0].friction must be 0 to 10");
  touch = floor_below();
  touch.spring_N_per_m = 200;
  refused(1, &touch, 1, FB_INVALID, "touches[0].spring_N_per_m must be 0 where mobility_per_kg is 0");
  EXPECT_EQ(state_of(server).reports_refused, 9U);
  EXPECT_EQ(state_of(server).reports, 0U);
}

TEST(LibrarySimulator, ForgetsAClientThatHasLeft) {
  const Owned<fb_server> server = started();
  fb_probe probe;
  std::uint64_t first = 0;
  {
    const Owned<fb_client> client = held_below(state_of(server).address);
    ASSERT_TRUE(test::becomes_true([&] { return ask(server, probe) == 1; }));
    first = probe.client;
  }
  EXPECT_TRUE(test::becomes_true([&] { return ask(server, probe) == 0; }));
  EXPECT_EQ(fb_server_report(server.get(), first, nullptr, 0), FB_NOT_NOW);
  const Owned<fb_client> client = held_below(state_of(server).address);
  ASSERT_TRUE(test::becomes_true([&] { return ask(server, probe) == 1; }));
  EXPECT_NE(probe.client, first);
  EXPECT_EQ(fb_server_report(server.get(), probe.client, nullptr, 0), FB_OK) << fb_last_error();
}

TEST(LibrarySimulator, IsRefusedInOneLineWhatItCannotBe) {
  const auto refused = [](const fb_simulator& simulator, const std::string& why) {
    const fb_server_settings settings = at_free_port();
    fb_server* server = nullptr;
    EXPECT_EQ(fb_server_of_simulator(&settings, &simulator, &server), FB_INVALID) << why;
    EXPECT_THAT(fb_last_error(), AllOf(HasSubstr("fb_server_of_simulator: "), HasSubstr(why)));
    EXPECT_EQ(server, nullptr);
  };
  fb_simulator simulator = FB_INIT(fb_simulator);
  simulator.probe_mass_kg = -1;
  refused(simulator, "probe_mass_kg must be 0.001 to 100 kg");
  simulator = FB_INIT(fb_simulator);
  simulator.probe_radius_m = test::kNaN;
  refused(simulator, "probe_radius_m must be 0 to 1 m");
  simulator = FB_INIT(fb_simulator);
  simulator.probe_stiffness_N_per_m = 1e6;
  refused(simulator, "probe_stiffness_N_per_m must be above 0, up to 1e5 N/m");
  simulator = FB_INIT(fb_simulator);
  simulator.name = "";
  refused(simulator, "fb_simulator.name must be a name");
  simulator.size = 3;
  refused(simulator, "fb_simulator.size is 3");

  fb_environment environment = FB_INIT(fb_environment);
  environment.update = [](void*, const fb_client_motion*, fb_answer*) -> fb_status { return FB_OK; };
  const fb_server_settings settings = at_free_port();
  fb_server* of_callbacks = nullptr;
  ASSERT_EQ(fb_server_create(&settings, &environment, &of_callbacks), FB_OK) << fb_last_error();
  const Owned<fb_server> owned(of_callbacks);
  std::size_t probes = 0;
  EXPECT_EQ(fb_server_ask(of_callbacks, &probes), FB_INVALID);
  EXPECT_THAT(fb_last_error(), HasSubstr("accepted is one of fb_server_of_simulator"));
  EXPECT_EQ(fb_server_ask(nullptr, &probes), FB_INVALID);
}

}  // namespace
}  // namespace forcebound::library
