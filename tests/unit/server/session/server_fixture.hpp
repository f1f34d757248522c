#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "forcebound/server/environment/scene_library.hpp"
#include "forcebound/server/session/server.hpp"
#include "tests/support/fake_clock.hpp"
#include "tests/support/fake_link.hpp"
#include "tests/support/vector_of.hpp"

namespace forcebound::server {

using std::chrono::milliseconds;
using std::chrono::seconds;

using test::vector_of;

inline net::Address address(std::uint16_t port) { return {.ip = {}, .port = port}; }

class Diary final : public ServerObserver {
 public:
  void on_opened(const SessionInfo& info) override { lines.push_back("opened " + info.device + " in " + info.scene); }
  void on_closed(const SessionInfo& info, CloseReason reason, const wire::Bye&) override {
    const char* why[] = {"bye", "idle", "stop", "still", "asked"};
    lines.push_back("closed " + info.device + ": " + why[static_cast<int>(reason)]);
  }
  void on_refused(const net::Address&, std::string_view text) override {
    lines.push_back("refused " + std::string(text));
  }
  void on_quarantined(const SessionInfo&, std::string_view object) noexcept override {
    left_out = object;
    ++times_left_out;
  }
  void on_unsound_response(const SessionInfo&) noexcept override { ++unsound; }
  void on_motion(const wire::MotionSample&) noexcept override { ++motions; }
  void on_force(const wire::EnvironmentForce&) noexcept override { ++forces; }

  std::vector<std::string> lines;
  std::string left_out;  ///< short, hence never on the heap
  int times_left_out = 0;
  int unsound = 0;
  int motions = 0;
  int forces = 0;
};

/// One server on a link that records what is sent:
///
///     test --on_datagram--> Server --send--> FakeLink
class ServerFixture : public testing::Test {
 protected:
  void SetUp() override { start({}); }

  void start(const ServerOptions& options, EnvironmentLibrary environments = SceneLibrary::shipped()) {
    server.emplace(
        options, std::move(environments), link, clock, [this] { return next_id_ += 1000; }, &diary);
  }

  void arrive(const wire::Message& message, const net::Address& from = address(1)) {
    const auto datagram = client_.encode(message);
    server->on_datagram(datagram, from, clock.time);
  }

  /// The answers since the last call, each decoded; the caller must copy their texts.
  std::vector<wire::Message> answers() {
    std::vector<wire::Message> messages;
    for (const auto& sent : link.sent) {
      decoders_.emplace_back();
      messages.push_back(std::get<wire::Message>(decoders_.back().decode(sent.bytes)));
      sent_to.push_back(sent.peer);
    }
    link.sent.clear();
    return messages;
  }

  template <class T>
  T only_answer() {
    const auto all = answers();
    EXPECT_EQ(all.size(), 1u);
    if (all.size() != 1 || !std::holds_alternative<T>(all[0])) {
      ADD_FAILURE() << "another answer";
      return {};
    }
    return std::get<T>(all[0]);
  }

  static wire::Hello hello(std::uint64_t nonce = 1) {
    return {.client_nonce = nonce, .degrees_of_freedom = 1, .device = "wall-1dof", .period_s = 1e-3};
  }

  std::uint64_t join(std::uint64_t nonce = 1, const net::Address& from = address(1)) {
    arrive(hello(nonce), from);
    return only_answer<wire::Welcome>().session;
  }

  /// One motion each millisecond. Of a number far ahead the lower 32 bits tell the time, which then has a
  /// representation.
  static wire::MotionSample motion(std::uint64_t session, std::uint64_t sequence, double x_m = 0.001) {
    return {.session = session,
            .sequence = sequence,
            .device_time = milliseconds{static_cast<std::uint32_t>(sequence)},
            .position = vector_of({x_m})};
  }

  test::FakeLink link;
  test::FakeClock clock;
  Diary diary;
  std::optional<Server> server;
  std::vector<net::Address> sent_to;

 private:
  std::uint64_t next_id_ = 5000;
  wire::Codec client_;
  std::vector<wire::Codec> decoders_;
};

}  // namespace forcebound::server
