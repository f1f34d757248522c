#include <forcebound.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

#include "tests/library/handles.hpp"
#include "tests/support/becomes_true.hpp"
#include "tests/support/special_numbers.hpp"

/// Client of the library ==( UDP of this machine )== server of the library -- callbacks.
namespace forcebound::library {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double kStiffness_N_per_m = 123.4;

/// A spring to zero, and what befell it.
struct Spring {
  std::atomic<int> created{0};
  std::atomic<int> destroyed{0};
  std::atomic<int> updates{0};
  std::atomic<int> axes{0};
  /// Before the answer; it may spoil that.
  std::function<fb_status(fb_answer&)> also = [](fb_answer&) { return FB_OK; };
};

fb_status create_spring(void* user, const fb_client_facts* client, void** own) {
  auto& spring = *static_cast<Spring*>(user);
  ++spring.created;
  spring.axes = client->axes;
  *own = user;
  return FB_OK;
}

fb_status update_spring(void* own, const fb_client_motion* motion, fb_answer* answer) {
  auto& spring = *static_cast<Spring*>(own);
  ++spring.updates;
  answer->force_N[0] = -kStiffness_N_per_m * motion->position_m[0];
  return spring.also(*answer);
}

fb_environment environment_of(Spring& spring) {
  fb_environment environment = FB_INIT(fb_environment);
  environment.name = "spring";
  environment.simulated = "a spring of 123.4 N/m";
  environment.axes = 1;
  environment.user = &spring;
  environment.create = create_spring;
  environment.update = update_spring;
  environment.destroy = [](void* own) { ++static_cast<Spring*>(own)->destroyed; };
  return environment;
}

Owned<fb_server> started(const fb_environment& environment, const fb_server_settings& settings = at_free_port()) {
  fb_server* server = nullptr;
  EXPECT_EQ(fb_server_create(&settings, &environment, &server), FB_OK) << fb_last_error();
  Owned<fb_server> owned(server);
  EXPECT_EQ(fb_server_start(server), FB_OK) << fb_last_error();
  return owned;
}

/// A client whose device is held at a place.
class Held {
 public:
  explicit Held(const std::string& server, double x_m = 0.001) : x_m_(x_m), client_(made(server)) {
    EXPECT_EQ(fb_client_start(client_.get()), FB_OK) << fb_last_error();
  }

  [[nodiscard]] fb_client_state look() const {
    fb_client_state state = FB_INIT(fb_client_state);
    EXPECT_EQ(fb_client_look(client_.get(), &state), FB_OK) << fb_last_error();
    return state;
  }
  /// A person's limits let the force grow.
  [[nodiscard]] bool becomes_spring(double x_m) const {
    return test::becomes_true([&] { return std::abs(look().request_N[0] + kStiffness_N_per_m * x_m) < 1e-12; });
  }
  [[nodiscard]] fb_client* get() const { return client_.get(); }

 private:
  Owned<fb_client> made(const std::string& server) {
    fb_device_callbacks callbacks = FB_INIT(fb_device_callbacks);
    callbacks.user = this;
    callbacks.read = [](void* user, fb_reading* reading) -> fb_status {
      reading->position_m[0] = static_cast<Held*>(user)->x_m_;
      return FB_OK;
    };
    callbacks.command = [](void*, const double*, std::size_t) -> fb_status { return FB_OK; };
    const Owned<fb_device> device = still_device(callbacks);
    fb_client_settings settings = FB_INIT(fb_client_settings);
    settings.server = server.c_str();
    settings.once = 1;
    settings.remote_rendering = 1;
    fb_client* client = nullptr;
    EXPECT_EQ(fb_client_create(&settings, device.get(), &client), FB_OK) << fb_last_error();
    return Owned<fb_client>(client);
  }

  double x_m_;
  Owned<fb_client> client_;  ///< last: it reads the device
};

TEST(LibraryServer, GivesTheForceWhereEachDeviceIs) {
  Spring spring;
  const Owned<fb_server> server = started(environment_of(spring));
  const Held right(state_of(server).address, 0.001);
  const Held left(state_of(server).address, -0.0007);
  EXPECT_TRUE(right.becomes_spring(0.001));
  EXPECT_TRUE(left.becomes_spring(-0.0007));
  EXPECT_EQ(spring.axes, 1);
}

TEST(LibraryServer, TellsItsPortAndWhoIsThereAndEndsAllSessions) {
  Spring spring;
  const Owned<fb_server> server = started(environment_of(spring));
  EXPECT_EQ(fb_server_start(server.get()), FB_NOT_NOW);
  EXPECT_THAT(fb_last_error(), HasSubstr("a server runs once"));
  const fb_server_state before = state_of(server);
  EXPECT_EQ(before.running, 1);
  EXPECT_EQ(before.address, "127.0.0.1:" + std::to_string(before.port));
  EXPECT_EQ(before.clients, 0U);
  const Held one(before.address);
  const Held other(before.address);
  ASSERT_TRUE(test::becomes_true([&] { return state_of(server).clients == 2 && state_of(server).forces > 0; }));
  EXPECT_STREQ(one.look().simulated, "a spring of 123.4 N/m");
  EXPECT_EQ(spring.created, 2);
  EXPECT_EQ(spring.destroyed, 0);
  ASSERT_EQ(fb_server_stop(server.get()), FB_OK) << fb_last_error();
  EXPECT_EQ(fb_server_stop(server.get()), FB_OK) << "again: nothing more";
  EXPECT_EQ(spring.destroyed, 2);
  const fb_server_state state = state_of(server);
  EXPECT_EQ(state.running, 0);
  EXPECT_EQ(state.clients, 0U);
  EXPECT_GE(state.motions, state.forces);
  EXPECT_EQ(state.callbacks_failed, 0U);

  std::size_t needed = 0;
  EXPECT_EQ(fb_server_summary(server.get(), nullptr, 0, &needed), FB_TOO_SMALL);
  std::string json(needed, '?');
  ASSERT_EQ(fb_server_summary(server.get(), json.data(), json.size(), nullptr), FB_OK);
  EXPECT_THAT(
      json, AllOf(HasSubstr("\"environment\": \"spring\""), HasSubstr("\"encryption\": \"none\""),
                  HasSubstr("\"sessions_opened\": 2"), HasSubstr("\"forces_sent\": " + std::to_string(state.forces))));
}

/// A callback that throws, fails or gives what is not finite: zero force, counted, and right again afterwards.
TEST(LibraryServer, AnswersZeroForceForACallbackThatFails) {
  const std::function<fb_status(fb_answer&)> faults[] = {
      [](fb_answer&) -> fb_status { throw std::runtime_error("of a program in C++"); },
      [](fb_answer&) -> fb_status { return FB_FAILED; },
      [](fb_answer& answer) -> fb_status {
        answer.force_N[0] = test::kNaN;
        return FB_OK;
      },
      [](fb_answer& answer) -> fb_status {
        answer.has = FB_HAS_CONTACT;
        answer.depth_m = -1;
        return FB_OK;
      }};
  for (const auto& fault : faults) {
    Spring spring;
    std::atomic<bool> fails{true};
    spring.also = [&](fb_answer& answer) { return fails ? fault(answer) : FB_OK; };
    const Owned<fb_server> server = started(environment_of(spring));
    const Held held(state_of(server).address);
    ASSERT_TRUE(test::becomes_true([&] { return state_of(server).forces_zero > 10; }));
    EXPECT_EQ(held.look().request_N[0], 0);
    EXPECT_EQ(state_of(server).clients, 1U);
    fails = false;
    EXPECT_TRUE(test::becomes_true([&] { return held.look().request_N[0] < 0; }));
    const bool told = &fault == &faults[0] || &fault == &faults[1];
    EXPECT_EQ(state_of(server).callbacks_failed > 0, told);
  }
}

TEST(LibraryServer, CountsACallbackOf100msAndAnswersItsClientsLate) {
  Spring spring;
  spring.also = [&](fb_answer&) {
    if (spring.updates == 50) std::this_thread::sleep_for(std::chrono::milliseconds{100});
    return FB_OK;
  };
  const Owned<fb_server> server = started(environment_of(spring));
  const Held held(state_of(server).address);
  EXPECT_TRUE(test::becomes_true([&] { return spring.updates > 100; }));
  EXPECT_GE(state_of(server).callbacks_late, 1U);
  EXPECT_EQ(state_of(server).forces_zero, 0U);
  EXPECT_TRUE(test::becomes_true([&] { return held.look().request_N[0] < 0; }));
}

TEST(LibraryServer, RefusesAClientForWhichNothingIsCreated) {
  Spring spring;
  for (const bool throws : {false, true}) {
    fb_environment environment = environment_of(spring);
    environment.create = throws ? [](void*, const fb_client_facts*, void**) -> fb_status { throw 1; }
                                : [](void*, const fb_client_facts*, void**) -> fb_status { return FB_FAILED; };
    const Owned<fb_server> server = started(environment);
    const Held held(state_of(server).address);
    EXPECT_EQ(fb_client_wait(held.get(), -1), FB_FAILED);
    fb_event event = FB_INIT(fb_event);
    ASSERT_EQ(fb_client_event(held.get(), &event), FB_OK);
    EXPECT_EQ(event.kind, FB_EVENT_REFUSED);
    EXPECT_THAT(event.text, HasSubstr(std::string("callback 'create' ") + (throws ? "threw" : "failed")));
    EXPECT_EQ(fb_server_stop(server.get()), FB_OK);
    EXPECT_GE(state_of(server).clients_refused, 1U);
    EXPECT_EQ(state_of(server).callbacks_failed, state_of(server).clients_refused);
  }
  EXPECT_EQ(spring.destroyed, 0);
}

TEST(LibraryServer, ACallbackCannotStopItsOwnServer) {
  Spring spring;
  std::atomic<fb_server*> own{nullptr};
  std::atomic<fb_status> stopped{-1};
  spring.also = [&](fb_answer&) {
    if (own != nullptr) stopped = fb_server_stop(own);
    return FB_OK;
  };
  const Owned<fb_server> server = started(environment_of(spring));
  own = server.get();
  const Held held(state_of(server).address);
  EXPECT_TRUE(test::becomes_true([&] { return stopped == FB_NOT_NOW; }));
}

/// Of an older header: an environment that ends before `destroy`, settings that end behind the address.
TEST(LibraryServer, TakesTheSmallerStructsOfAnOlderProgram) {
  Spring spring;
  fb_environment environment = environment_of(spring);
  environment.size = offsetof(fb_environment, destroy);
  fb_server_settings settings = at_free_port();
  std::memset(static_cast<void*>(&settings.key), 0x5a, sizeof settings - offsetof(fb_server_settings, key));
  settings.size = offsetof(fb_server_settings, key);
  {
    const Owned<fb_server> server = started(environment, settings);
    const Held held(state_of(server).address);
    EXPECT_TRUE(test::becomes_true([&] { return spring.updates > 10; }));
  }
  EXPECT_EQ(spring.destroyed, 0);
}

TEST(LibraryServer, RefusesWhatCannotBeInOneLine) {
  Spring spring;
  const auto refused = [](const fb_server_settings& settings, const fb_environment& environment, fb_status status,
                          const std::string& why) {
    fb_server* server = nullptr;
    EXPECT_EQ(fb_server_create(&settings, &environment, &server), status) << why;
    EXPECT_THAT(fb_last_error(), AllOf(HasSubstr("fb_server_create: "), HasSubstr(why)));
    EXPECT_EQ(server, nullptr);
  };
  fb_environment environment = environment_of(spring);
  environment.update = nullptr;
  refused(at_free_port(), environment, FB_INVALID, "fb_environment.update must be a function, got null");
  environment = environment_of(spring);
  environment.axes = 7;
  refused(at_free_port(), environment, FB_INVALID, "fb_environment.axes must be 0 to 6, got 7");
  environment.axes = 1;
  environment.name = "";
  refused(at_free_port(), environment, FB_INVALID, "fb_environment.name must be a name");
  environment.name = "spring";
  environment.size = 3;
  refused(at_free_port(), environment, FB_INVALID, "fb_environment.size is 3");
  environment.size = sizeof environment;

  fb_server_settings settings = at_free_port();
  settings.size = 1;
  refused(settings, environment, FB_INVALID, "fb_server_settings.size is 1");
  settings = at_free_port();
  settings.clients_max = -1;
  refused(settings, environment, FB_INVALID, "fb_server_settings.clients_max must be at least 0, got -1");
  settings = at_free_port();
  settings.idle_s = test::kNaN;
  refused(settings, environment, FB_INVALID, "fb_server_settings.idle_s must be 0 to 1e6 s");
  settings = at_free_port();
  settings.listen = "nowhere";
  refused(settings, environment, FB_INVALID, "nowhere");
  settings.listen = "0.0.0.0:0";
  refused(settings, environment, FB_INVALID,
          "sessions must be encrypted; accepted are 'key' with 'clients', or 'shared_key'");
  settings = at_free_port();
  settings.clients = "/no/such/file";
  refused(settings, environment, FB_INVALID, "'clients': they are let in by their keys, so it needs 'key'");
  settings = at_free_port();
  settings.key = "/no/such/file";
  refused(settings, environment, FB_INVALID, "alone it would let anybody in");
  settings.shared_key = "/no/such/file";
  refused(settings, environment, FB_FAILED, "/no/such/file");

  const Owned<fb_server> first = started(environment);
  const std::string taken = state_of(first).address;
  settings = at_free_port();
  settings.listen = taken.c_str();
  refused(settings, environment, FB_FAILED, taken);
  EXPECT_EQ(fb_server_create(&settings, nullptr, nullptr), FB_INVALID);
  EXPECT_EQ(fb_server_stop(nullptr), FB_INVALID);
  fb_server_destroy(nullptr);
}

}  // namespace
}  // namespace forcebound::library
