#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/error.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>

#include "tests/process/page_address.hpp"
#include "tests/process/programs.hpp"

namespace forcebound::test {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
using namespace std::chrono_literals;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// A browser that looks at a program's page.
class Viewer {
 public:
  explicit Viewer(Process& program) {
    const PageAddress page(program);
    stream_.next_layer().connect({asio::ip::make_address(page.host), page.port});
    stream_.handshake(page.authority(), "/live" + page.query);
  }

  void say(const json& message) { stream_.write(asio::buffer(message.dump())); }

  /// Throws where none comes for half a minute.
  json next() {
    beast::flat_buffer buffer;
    std::optional<beast::error_code> read;
    stream_.async_read(buffer, [&read](beast::error_code error, std::size_t) { read = error; });
    io_.restart();
    io_.run_for(30s);
    if (!read) {
      stream_.next_layer().close();
      io_.run();
      throw std::runtime_error("the page says nothing more");
    }
    if (*read) throw beast::system_error(*read);
    return json::parse(beast::buffers_to_string(buffer.data()));
  }

  /// The first message of the kind for which the condition holds; waits for it, throws where it does not come in half a
  /// minute. Others are passed over.
  json wait_for(const std::string& kind, const std::function<bool(const json&)>& condition = {}) {
    const auto until = std::chrono::steady_clock::now() + 30s;
    while (std::chrono::steady_clock::now() < until) {
      json message = next();
      if (message["kind"] == kind && (!condition || condition(message))) return message;
    }
    throw std::runtime_error("the page does not say what is waited for: " + kind);
  }

 private:
  asio::io_context io_;
  beast::websocket::stream<asio::ip::tcp::socket> stream_{io_};
};

const Words kBall{"--scene", "sphere", "--page", "0", "--rendering", "local"};

Words and_also(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

json choose(const std::string& setting, const json& value) {
  return {{"kind", "choose"}, {"setting", setting}, {"value", value}};
}

/// Of the newest tick, the tip's distance from the middle of the ball.
double distance_m(const json& ticks) {
  double squares = 0;
  for (const json& axis : ticks["position_m"].back()) squares += axis.get<double>() * axis.get<double>();
  return std::sqrt(squares);
}

TEST(APage, ShowsTheRunAndItsPointerMovesTheHandUntilTheBallAnswers) {
  Server server;
  Client client(server.address(), kBall);
  Viewer viewer(client);
  const json hello = viewer.wait_for("hello");
  EXPECT_EQ(hello["program"], "client");
  EXPECT_EQ(hello["settings"]["law"], "fba-exact");
  EXPECT_EQ(hello["settings"]["scene"], "sphere");
  EXPECT_TRUE(hello["pointer"]);
  EXPECT_TRUE(hello["settings"]["network"].is_null());
  const json scene = viewer.wait_for("scene");
  EXPECT_EQ(scene["shapes"][0]["kind"], "sphere");
  EXPECT_EQ(scene["shapes"][0]["radius_m"], 0.02);
  viewer.say({{"kind", "hand"}, {"point_m", {0, 0, 0}}});
  const json touched = viewer.wait_for("ticks", [](const json& ticks) { return ticks["contact"].back() == 1; });
  EXPECT_LT(distance_m(touched), 0.02);
  viewer.wait_for("ticks", [](const json& ticks) { return ticks["applied_N"].back()[0].get<double>() > 0.5; });
  viewer.say({{"kind", "hand"}, {"point_m", {0.06, 0, 0}}});
  viewer.wait_for("ticks", [](const json& ticks) { return distance_m(ticks) > 0.05; });
  const json status = viewer.wait_for("status", [](const json& each) { return each["state"] == "connected"; });
  EXPECT_GT(status["network"]["received"], 0);
  EXPECT_EQ(client.stop(SIGINT), client.expected_end());
}

TEST(APage, BeginsWithALawBesideToCompareWith) {
  Server server;
  Client client(server.address(), kBall);
  Viewer viewer(client);
  const json hello = viewer.wait_for("hello");
  EXPECT_EQ(hello["settings"]["law_beside"], "none");
  EXPECT_EQ(hello["tracks"].size(), 2);
  viewer.wait_for("ticks", [](const json& ticks) { return ticks["track"] == 1; });
  Client scripted(server.address(), and_also(kBall, {"--operator", "trace-sphere"}));
  Viewer other(scripted);
  EXPECT_EQ(other.wait_for("hello")["tracks"].size(), 1) << "whose hand is not the page's";
}

TEST(APage, OfARobotHasOneLawBecauseOneHandLeadsIt) {
  if (run(kServer, {"--help"}).out.find("--follower ROBOT") == std::string::npos) GTEST_SKIP() << "without robots";
  Server server({"--follower", "reach-7", "--task", "stiff-wall"});
  Client client(server.address(), {"--device", "firm-3dof", "--page", "0"});
  Viewer viewer(client);
  viewer.wait_for("event", [](const json& event) {
    const std::string text = event["text"];
    return text.starts_with("no second law runs beside: ") && text.find("is led by 'firm-3dof'") != std::string::npos;
  });
  EXPECT_EQ(
      viewer.wait_for("hello", [](const json& hello) { return hello["tracks"].size() == 1; })["settings"]["law_beside"],
      nullptr);
  const json moved = viewer.wait_for("moved", [](const json& message) { return message.contains("values"); });
  EXPECT_TRUE(moved["values"].contains("torque_z_N_m"));
  viewer.wait_for("moved", [](const json& message) {
    return message.contains("values") && message["values"]["leader_has_clutch"] == 1;  // a pointer has buttons
  });
}

/// A scene that no client knows.
std::string ball(const std::string& name, const std::string& radius_m, const std::string& more = "") {
  return "[scene]\nname = \"" + name + "\"\ndescription = \"A ball.\"\ndegrees_of_freedom = 3\n" + more + R"(
[[object]]
name = "ball"
shape = { kind = "sphere", center_m = [0, 0, 0], radius_m = )" +
         radius_m + R"( }
effects = ["surface"]

[object.surface]
stiffness_N_per_m = 500
)";
}

// A client that names no scene does not know where its hand begins until the server has told.
TEST(APage, BeginsWhereTheServersOwnSceneSuggests) {
  const TemporaryFolder folder;
  const std::string file = folder.file("far.toml");
  // About the place where hands begin elsewhere.
  write_file(file, ball("far", "0.07", R"(suggested_hand = "press:axis=2,from_m=0.09,to_m=0.06")"));
  for (const char* const rendering : {"local", "remote"}) {
    Server server({"--scene", file});
    Client client(server.address(), {"--page", "0", "--rendering", rendering});
    Viewer viewer(client);
    viewer.wait_for("scene", [](const json& scene) { return scene["name"] == "far"; });
    viewer.wait_for("hello");  // the run begins again, elsewhere
    const json ticks = viewer.wait_for("ticks");
    EXPECT_NEAR(distance_m(ticks), 0.09, 2e-3) << rendering;
  }
}

// What the client does not know of a scene, the server does.
TEST(APage, GoesBackToTheDeviceThatTheServerTook) {
  const TemporaryFolder folder;
  const std::string file = folder.file("own.toml");
  write_file(file, ball("own", "0.02"));
  Server server({"--scene", file});
  Client client(server.address(), {"--page", "0"});
  Viewer viewer(client);
  const json device =
      viewer.wait_for("hello", [](const json& hello) { return hello["dof"] == 3; })["settings"]["device"];
  viewer.wait_for("status", [](const json& status) { return status["state"] == "connected"; });
  viewer.say(choose("device", "wall-1dof"));
  viewer.wait_for("hello", [](const json& hello) { return hello["settings"]["device"] == "wall-1dof"; });
  const std::string why =
      viewer.wait_for("refused", [](const json& refused) { return refused["about"] == "run"; })["text"];
  EXPECT_THAT(why, HasSubstr(" refused: device wall-1dof instead of " + device.get<std::string>()));
  viewer.wait_for("hello", [&device](const json& hello) { return hello["settings"]["device"] == device; });
  viewer.wait_for("status", [](const json& status) { return status["state"] == "connected"; });
  EXPECT_EQ(client.stop(SIGINT), client.expected_end());
}

TEST(APage, ChangesLawSceneAndDeviceAndRunsASecondLawBeside) {
  Server server;
  Client client(server.address(), kBall);
  Viewer viewer(client);
  viewer.wait_for("hello");
  viewer.say(choose("law", "fba-more"));
  viewer.wait_for("hello", [](const json& hello) { return hello["settings"]["law"] == "fba-more"; });
  viewer.say(choose("law_beside", "none"));
  viewer.wait_for("hello", [](const json& hello) { return hello["tracks"].size() == 2; });
  viewer.wait_for("ticks", [](const json& ticks) { return ticks["track"] == 1; });
  viewer.wait_for("ticks", [](const json& ticks) { return ticks["track"] == 0; });
  viewer.say(choose("law_beside", nullptr));
  viewer.wait_for("hello", [](const json& hello) { return hello["tracks"].size() == 1; });
  viewer.say(choose("device", "wall-1dof"));
  EXPECT_EQ(viewer.wait_for("refused")["about"], "device");  // the ball is in space
  viewer.say(choose("scene", "wall"));
  viewer.wait_for("hello", [](const json& hello) { return hello["settings"]["scene"] == "wall"; });
  viewer.wait_for("scene", [](const json& scene) { return scene["shapes"][0]["kind"] == "half_space"; });
  viewer.say(choose("device", "wall-1dof"));
  viewer.wait_for("hello", [](const json& hello) { return hello["dof"] == 1; });
  viewer.say(choose("scene", "sphere"));  // takes a device of its own along
  viewer.wait_for("hello", [](const json& hello) { return hello["settings"]["device"] == "omni"; });
  viewer.say(choose("stiffness_N_per_m", 77));
  viewer.wait_for("hello", [](const json& hello) { return hello["settings"]["stiffness_N_per_m"] == 77; });
  viewer.say(choose("law", "fba-exakt"));
  EXPECT_THAT(viewer.wait_for("refused")["text"].get<std::string>(), HasSubstr("fba-exact"));
  viewer.say(choose("network", {{"delay_ms", 1}, {"jitter_ms", 0}, {"loss_percent", 0}}));
  EXPECT_THAT(viewer.wait_for("refused")["text"].get<std::string>(), HasSubstr("--relay-control"));
  // Late ticks can cost fba-more its passivity.
  EXPECT_THAT(client.stop(SIGINT), testing::AnyOf(testing::Optional(0), testing::Optional(3)));
}

/// What the page shows next of a choice: a run of it, whose ticks come, or why there is none, in one line.
bool runs_or_is_refused(Viewer& viewer, const std::string& setting, const std::string& value) {
  viewer.say(choose(setting, value));
  for (;;) {
    const json message = viewer.next();
    if (message["kind"] == "refused") {
      EXPECT_THAT(message["text"].get<std::string>(), AllOf(HasSubstr(value), Not(HasSubstr("\n"))));
      return false;
    }
    if (message["kind"] == "hello" && message["settings"][setting] == value) break;
  }
  viewer.wait_for("ticks");
  return true;
}

// The lab's tests run each scene on each device, in virtual time.
TEST(APage, RunsEverySceneThatShipsAndEveryDevice) {
  Server server;
  Client client(server.address(), kBall);
  Viewer viewer(client);
  const json choices = viewer.wait_for("hello")["choices"];
  int runs = 0;
  for (const std::string scene : choices["scenes"]) {
    SCOPED_TRACE("scene " + scene);
    ASSERT_TRUE(runs_or_is_refused(viewer, "scene", scene)) << "with a device that suits it";
    ++runs;
    if (scene != "plane" && scene != "wall") continue;
    int devices = 0;
    for (const std::string device : choices["devices"]) {
      SCOPED_TRACE("device " + device);
      devices += runs_or_is_refused(viewer, "device", device) ? 1 : 0;
    }
    EXPECT_GT(devices, 0);
  }
  EXPECT_GT(runs, 30);
  EXPECT_THAT(client.stop(SIGINT), testing::AnyOf(testing::Optional(0), testing::Optional(3)));
}

TEST(APage, KeepsTheTipWhereItIsWhenTheLawChanges) {
  Server server;
  Client client(server.address(), kBall);
  Viewer viewer(client);
  viewer.say({{"kind", "hand"}, {"point_m", {0.06, 0.03, 0}}});
  viewer.wait_for("ticks", [](const json& ticks) { return distance_m(ticks) > 0.065; });
  viewer.say(choose("law", "none"));
  viewer.wait_for("hello", [](const json& hello) { return hello["settings"]["law"] == "none"; });
  EXPECT_GT(distance_m(viewer.wait_for("ticks")), 0.06);
}

TEST(APage, TellsTheRelayWhatNetworkToEmulateWithoutANewRun) {
  Server server;
  Relay relay(server.address(), {"--control", "127.0.0.1:0"});
  Client client(relay.address(), and_also(kBall, {"--relay-control", control_of(relay)}));
  Viewer viewer(client);
  EXPECT_EQ(viewer.wait_for("hello")["settings"]["network"]["delay_ms"], 0);
  viewer.say(choose("network", {{"delay_ms", 30}, {"jitter_ms", 0}, {"loss_percent", 0}}));
  viewer.wait_for("hello", [](const json& hello) { return hello["settings"]["network"]["delay_ms"] == 30; });
  viewer.wait_for("status", [](const json& status) {
    const json& round_trip = status["network"]["round_trip_ms"];
    return !round_trip.is_null() && round_trip["p99"].get<double>() > 59;
  });
  EXPECT_EQ(client.stop(SIGINT), client.expected_end());
  EXPECT_THAT(unwrapped(client.out()), HasSubstr("network, each way: delay 30ms"));
}

TEST(APage, BeginsAndEndsRecordingsOfWholeRuns) {
  const TemporaryFolder folder;
  const std::string file = folder.file("run.mcap");
  Server server;
  Client client(server.address(), and_also(kBall, {"--record", file}));
  Viewer viewer(client);
  const auto is_connected = [](const json& status) { return status["state"] == "connected"; };
  EXPECT_EQ(viewer.wait_for("hello")["recording"], file);
  viewer.wait_for("status", is_connected);
  viewer.say({{"kind", "record"}, {"on", false}});
  viewer.wait_for("hello", [](const json& hello) { return hello["recording"].is_null(); });
  viewer.say({{"kind", "record"}, {"on", true}});
  const std::string third = folder.file("run-3.mcap");
  viewer.wait_for("hello", [&third](const json& hello) { return hello["recording"] == third; });
  viewer.wait_for("status", is_connected);
  // The summary is of the last run, and each run may have been late.
  EXPECT_THAT(client.stop(SIGINT), testing::AnyOf(testing::Optional(0), testing::Optional(3)));
  for (const std::string& recording : {file, third}) {
    const Ran report = run(kForcebound, {"report", recording});
    EXPECT_EQ(report.exit_code, 0) << report.err;
    EXPECT_THAT(report.out, HasSubstr("fba-exact"));
  }
}

TEST(APage, OfAServerShowsSessionsAndEndsThem) {
  Server server({"--page", "0"});
  Viewer viewer(server);
  EXPECT_EQ(viewer.wait_for("hello")["program"], "server");
  EXPECT_EQ(viewer.wait_for("sessions")["sessions"].size(), 0);
  const auto tells = [&viewer](const std::string& part) {
    viewer.wait_for("event", [&part](const json& event) {
      return event["text"].get<std::string>().find(part) != std::string::npos;
    });
  };
  Client client(server.address(), {});
  tells("connected to scene 'wall' with device 'wall-1dof'");
  const json seen = viewer.wait_for("sessions", [](const json& message) {
    return message["sessions"].size() == 1 && message["load"]["motions_per_s"].get<double>() > 0;
  });
  EXPECT_EQ(seen["sessions"][0]["device"], "wall-1dof");
  EXPECT_EQ(seen["sessions"][0]["scene"], "wall");
  viewer.say({{"kind", "kick"}, {"session", seen["sessions"][0]["id"]}});
  tells("is disconnected, as asked for on the page");
  EXPECT_TRUE(client.wait_for("the server ended the session"));
}

TEST(APage, IsRefusedWhereItsPortIsTaken) {
  Server server;
  Client first(server.address(), kBall);
  ASSERT_TRUE(first.wait_for("/?token="));
  const std::string out = first.out();
  const std::size_t begin = out.find("127.0.0.1:");
  const std::string at = out.substr(begin, out.find('/', begin) - begin);
  const Ran second = run(kClient, {"--server", server.address(), "--page", at});
  EXPECT_EQ(second.exit_code, 1);
  EXPECT_THAT(second.err, HasSubstr("no page at " + at));
}

// What a page with remote rendering, and of what moves, shows is the server's to tell.
TEST(APage, ShowsScenesThatAreNotHandedOverAndWhatMovesInThem) {
  Server server;
  Client sphere(server.address(), {"--scene", "sphere", "--page", "0", "--rendering", "remote"});
  Viewer viewer(sphere);
  const json scene = viewer.wait_for("scene");
  EXPECT_EQ(scene["name"], "sphere");
  EXPECT_EQ(scene["shapes"][0]["radius_m"], 0.02);
  viewer.say(choose("scene", "pad"));
  viewer.wait_for("hello", [](const json& hello) { return hello["settings"]["scene"] == "pad"; });
  const json pad = viewer.wait_for("scene", [](const json& message) { return !message["meshes"].empty(); });
  const json moved = viewer.wait_for("moved", [](const json& message) { return !message["meshes"].empty(); });
  EXPECT_EQ(moved["meshes"][0]["name"], pad["meshes"][0]["name"]);
  EXPECT_EQ(moved["meshes"][0]["vertices_m"].size(), pad["meshes"][0]["vertices_m"].size());
}

/// A client's recording of a few seconds.
std::string recorded_in(const TemporaryFolder& folder) {
  const std::string file = folder.file("run.mcap");
  Server server;
  const Ran ran = run(kClient, {"--server", server.address(), "--scene", "wall", "--device", "wall-1dof", "--duration",
                                "2", "--record", file, "--quiet"});
  EXPECT_THAT(ran.exit_code, testing::AnyOf(0, 3)) << ran.err;
  return file;
}

TEST(APage, PlaysARecordingAndSeeksInIt) {
  const TemporaryFolder folder;
  const std::string file = recorded_in(folder);
  Process view(kForcebound, {"view", file, "--page", "0"});
  Viewer viewer(view);
  const json hello = viewer.wait_for("hello");
  EXPECT_EQ(hello["program"], "view");
  EXPECT_EQ(hello["settings"]["scene"], "wall");
  EXPECT_GT(hello["duration_s"], 1.5);
  EXPECT_EQ(viewer.wait_for("scene")["shapes"][0]["kind"], "half_space");
  const json shown = viewer.wait_for("ticks", [](const json& ticks) { return ticks["time_s"].back() > 0.3; });
  viewer.say({{"kind", "play"}, {"on", false}});
  viewer.wait_for("hello", [](const json& now) { return now.value("playing", true) == false; });
  // A tick that there was: a slow machine may have left out those at any other time.
  const double there_s = shown["time_s"].front();
  viewer.say({{"kind", "seek"}, {"time_s", there_s + 1e-4}});
  viewer.wait_for("ticks", [&](const json& ticks) {
    const double last_s = ticks["time_s"].back();
    return std::abs(last_s - there_s) < 2e-3;
  });
  EXPECT_EQ(view.stop(SIGINT), 0);
}

TEST(APage, OfARecordingShowsWhatADamagedOneHasAndRefusesOthersInOneLine) {
  const TemporaryFolder folder;
  const std::string file = recorded_in(folder);
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  Process view(kForcebound, {"view", file, "--page", "0"});
  Viewer viewer(view);
  EXPECT_THAT(viewer.wait_for("event")["text"].get<std::string>(), HasSubstr("incomplete"));
  viewer.wait_for("ticks");
  EXPECT_THAT(view.err(), HasSubstr("incomplete"));
  EXPECT_EQ(view.stop(SIGINT), 0);
  const Ran missing = run(kForcebound, {"view", folder.file("none.mcap")});
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_THAT(missing.err, HasSubstr("cannot be read"));
  const Ran wrong = run(kForcebound, {"view", file, "--page", "no:port:at all"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("--page"));
}

}  // namespace
}  // namespace forcebound::test
