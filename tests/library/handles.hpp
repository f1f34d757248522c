#pragma once

#include <forcebound.h>
#include <gtest/gtest.h>

#include <memory>

namespace forcebound::library {

struct End {
  void operator()(fb_facts* facts) const { fb_facts_destroy(facts); }
  void operator()(fb_law* law) const { fb_law_destroy(law); }
  void operator()(fb_leader* leader) const { fb_leader_destroy(leader); }
  void operator()(fb_device* device) const { fb_device_destroy(device); }
  void operator()(fb_client* client) const { fb_client_destroy(client); }
  void operator()(fb_server* server) const { fb_server_destroy(server); }
};
template <class Handle>
using Owned = std::unique_ptr<Handle, End>;

inline fb_server_settings at_free_port() {
  fb_server_settings settings = FB_INIT(fb_server_settings);
  settings.listen = "127.0.0.1:0";
  return settings;
}

inline fb_server_state state_of(const Owned<fb_server>& server) {
  fb_server_state state = FB_INIT(fb_server_state);
  EXPECT_EQ(fb_server_look(server.get(), &state), FB_OK) << fb_last_error();
  return state;
}

inline constexpr const char* kStillFacts =
    "kind = \"cartesian\"\ndegrees_of_freedom = 1\ndamping_N_s_per_m = 5\nforce_N_max = 20\nhold_s_max = 0.005\n";

/// A device of one axis by callbacks.
inline Owned<fb_device> still_device(const fb_device_callbacks& callbacks) {
  fb_facts* facts = nullptr;
  fb_device* device = nullptr;
  EXPECT_EQ(fb_facts_parse(kStillFacts, "still", &facts), FB_OK) << fb_last_error();
  EXPECT_EQ(fb_device_of_callbacks(facts, &callbacks, &device), FB_OK) << fb_last_error();
  fb_facts_destroy(facts);
  return Owned<fb_device>(device);
}

}  // namespace forcebound::library
