#include <gmock/gmock.h>
#include <unistd.h>

#include <atomic>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/process/passive.hpp"
#include "tests/process/programs.hpp"

namespace forcebound::test {
namespace {

using namespace std::chrono_literals;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

// DDS's ports are the domain's. Of one domain with few members, a participant is found at the first four of these.
constexpr int kDomains = 100;

std::string domain() { return std::to_string(1 + ::getpid() % kDomains); }

/// No two tests meet on a topic, whatever else runs on this machine.
std::string new_namespace() {
  static std::atomic<int> count{0};
  return "/t" + std::to_string(::getpid()) + "_" + std::to_string(++count);
}

/// forcebound-ros2 with a hand that moves, on topics of its own.
class Hand : private SummaryFile, public Process {
 public:
  explicit Hand(const std::string& name_space, const std::string& drop_ms = "500")
      : Process(kRos2, words(name_space, summary_folder_.file("summary.json"), drop_ms)), name_space_(name_space) {
    EXPECT_TRUE(wait_for("connected; simulated: ")) << err();
  }

  /// Ends it. It was passive, whatever came.
  nlohmann::json end() {
    EXPECT_EQ(stop(SIGINT), 0) << err();
    const nlohmann::json summary = nlohmann::json::parse(content(summary_folder_.file("summary.json")), nullptr, false);
    EXPECT_TRUE(summary.is_object());
    if (!summary.is_object()) return summary;
    EXPECT_GE(summary["passivity"]["minimum_J"].get<double>(), kPassive_J);
    EXPECT_EQ(summary["faults"].value("tick_allocations", 0), 0);
    return summary;
  }

  [[nodiscard]] std::uint64_t wrenches(std::string_view what) const { return counted(out(), "servo_cf", what); }
  [[nodiscard]] std::uint64_t answers(std::string_view what) const { return counted(out(), "answers", what); }
  [[nodiscard]] const std::string& name_space() const { return name_space_; }

 private:
  static Words words(const std::string& name_space, const std::string& summary, const std::string& drop_ms) {
    return {"--namespace",
            name_space,
            "--domain",
            domain(),
            "--quiet",
            "--summary",
            summary,
            "--drop",
            drop_ms,
            "--device",
            "omni",
            "--operator",
            "trace-sphere:button=0,button_from_s=0.2"};
  }

  std::string name_space_;
};

/// The stand-in for a ROS 2 node, on Fast DDS.
class Peer : public Process {
 public:
  Peer(const std::string& name_space, const Words& what) : Process(FORCEBOUND_ROS2_PEER, words(name_space, what)) {}

  /// What it heard, at its end.
  nlohmann::json heard() {
    EXPECT_EQ(wait(), 0) << err();
    const std::string output = out();
    const std::size_t at = output.find('{');
    return at == std::string::npos ? nlohmann::json() : nlohmann::json::parse(output.substr(at), nullptr, false);
  }

 private:
  static Words words(const std::string& name_space, const Words& what) {
    Words all{"domain=" + domain(), "namespace=" + name_space};
    all.insert(all.end(), what.begin(), what.end());
    return all;
  }
};

TEST(Ros2, GivesMotionsAndTakesForcesAtTheRateOfTheTick) {
  Hand hand(new_namespace());
  const nlohmann::json heard = Peer(hand.name_space(), {"seconds=4", "publish=spring"}).heard();
  const nlohmann::json summary = hand.end();
  ASSERT_TRUE(heard.is_object());
  for (const char* const topic : {"poses", "twists", "wrenches", "joint_states", "joys"}) {
    EXPECT_GT(heard[topic], 500) << topic << ": of about 4000";
  }
  EXPECT_EQ(heard["frame"], "forcebound");
  EXPECT_EQ(heard["joints"], 3);
  EXPECT_EQ(heard["pressed"], true);
  EXPECT_GT(heard["way_m"], 0.01);
  EXPECT_GT(heard["fastest_m_per_s"], 0.01);
  EXPECT_GT(heard["largest_N"], 0.1) << "of what the peer asked for was applied";
  EXPECT_THAT(heard["states"], Contains("ENABLED"));
  EXPECT_GT(hand.wrenches("taken"), 500U);
  EXPECT_GT(hand.answers("fresh"), 500U);
  EXPECT_EQ(counted(hand.out(), "measured", "refused by DDS"), 0U);
  const nlohmann::json& counts = summary["counts"];
  EXPECT_EQ(counts["wrenches_taken"], hand.wrenches("taken"));
  EXPECT_EQ(counts["answers_fresh"], hand.answers("fresh"));
  EXPECT_EQ(counts["measured_refused_by_dds"], 0);
  EXPECT_EQ(counts["publishers"], 1);
}

TEST(Ros2, SaysItsDomainItsTopicsAndOnceThatNobodyPublishes) {
  Hand hand(new_namespace());
  const std::string topic = hand.name_space() + "/servo_cf";
  EXPECT_THAT(hand.err(), HasSubstr("DDS domain " + domain() + " of this machine: publishes " + hand.name_space() +
                                    "/measured_cp, "));
  EXPECT_THAT(hand.err(), HasSubstr("subscribes to " + topic + " (geometry_msgs/msg/WrenchStamped)"));
  EXPECT_TRUE(hand.wait_for(topic + ": nobody publishes here, in domain " + domain() +
                            "; wanted is geometry_msgs/msg/WrenchStamped, reliable or best effort"));
  const nlohmann::json summary = hand.end();
  EXPECT_EQ(occurrences(hand.err(), "nobody publishes"), 1U) << hand.err();
  EXPECT_THAT(hand.out(), HasSubstr("publishers: 0 connected\n"));
  EXPECT_THAT(hand.out(), HasSubstr("nobody published " + topic));
  EXPECT_EQ(summary["counts"]["publishers"], 0);
  EXPECT_TRUE(summary["force_age_ms"]["p50"].is_null()) << "there was no force: " << summary["force_age_ms"];
}

TEST(Ros2, SaysThatAPublisherCameAndLeft) {
  Hand hand(new_namespace());
  Peer(hand.name_space(), {"seconds=1", "publish=constant"}).heard();
  EXPECT_TRUE(hand.wait_for("/servo_cf: a publisher is gone, 0 now"));
  const nlohmann::json summary = hand.end();
  EXPECT_THAT(hand.err(), HasSubstr(hand.name_space() + "/servo_cf: a publisher is here, 1 now"));
  EXPECT_THAT(hand.out(), Not(HasSubstr("nobody published")));
  EXPECT_EQ(summary["counts"]["publishers"], 1);
}

TEST(Ros2, NamesTheQualityOfServiceThatDoesNotFit) {
  Hand hand(new_namespace());
  Peer peer(hand.name_space(), {"seconds=4", "publish=constant", "ownership=exclusive"});
  EXPECT_TRUE(hand.wait_for("somebody publishes " + hand.name_space() +
                            "/servo_cf with another quality of service (ownership), and is not connected; accepted is "
                            "ROS 2's default"));
  EXPECT_EQ(peer.heard()["matched"], false);
  EXPECT_EQ(hand.end()["counts"]["publishers_of_another_qos"], 1);
}

TEST(Ros2, BestEffortIsHeardToo) {
  Hand hand(new_namespace());
  const nlohmann::json heard =
      Peer(hand.name_space(), {"seconds=2", "publish=constant", "reliability=best-effort"}).heard();
  hand.end();
  EXPECT_GT(heard["poses"], 100);
  EXPECT_GT(heard["largest_N"], 0.1);
}

TEST(Ros2, FadesAndDropsTheForceOfAPublisherThatFallsSilent) {
  Hand hand(new_namespace());
  const nlohmann::json heard = Peer(hand.name_space(), {"seconds=3", "publish=constant", "until-s=1"}).heard();
  const nlohmann::json summary = hand.end();
  EXPECT_GT(heard["largest_N"], 0.1);
  EXPECT_EQ(heard["force_N"], 0);
  EXPECT_GT(hand.answers("fading"), 0U);
  EXPECT_GT(hand.answers("zero"), 0U);
  EXPECT_THAT(hand.err(), HasSubstr("ms old: zero force"));
  EXPECT_GT(summary["late_force"]["dropped_ticks"], 0) << "of the wrench, not of the server within";
  EXPECT_GE(summary["force_age_ms"]["max"], 500) << "the wrench's, which those dropped were";
}

TEST(Ros2, RefusesWhatIsNotFinite) {
  Hand hand(new_namespace());
  const nlohmann::json heard = Peer(hand.name_space(), {"seconds=2", "publish=nan"}).heard();
  const nlohmann::json summary = hand.end();
  EXPECT_EQ(heard["largest_N"], 0);
  EXPECT_GT(hand.wrenches("not finite"), 0U);
  EXPECT_EQ(hand.wrenches("taken"), 0U);
  EXPECT_EQ(occurrences(hand.err(), "a wrench is refused: not finite"), 1U) << hand.err();
  EXPECT_EQ(summary["faults"]["non_finite_requests"], 0) << "it came no further";
}

TEST(Ros2, RefusesAnotherFrame) {
  Hand hand(new_namespace());
  const nlohmann::json heard = Peer(hand.name_space(), {"seconds=2", "publish=constant", "frame=tool0"}).heard();
  hand.end();
  EXPECT_EQ(heard["largest_N"], 0);
  EXPECT_GT(hand.wrenches("in another frame"), 0U);
  EXPECT_THAT(hand.err(), HasSubstr("its frame is 'tool0', accepted is 'forcebound' (--frame), or none"));
  EXPECT_EQ(hand.wrenches("taken"), 0U);
}

TEST(Ros2, NamesATopicOfAForeignTypeInOneLine) {
  Hand hand(new_namespace());
  Peer peer(hand.name_space(), {"seconds=4", "publish=constant", "type=std_msgs::msg::dds_::String_"});
  EXPECT_TRUE(hand.wait_for("somebody publishes " + hand.name_space() +
                            "/servo_cf as std_msgs/msg/String, and is not connected; accepted is "
                            "geometry_msgs/msg/WrenchStamped"));
  const nlohmann::json heard = peer.heard();
  EXPECT_EQ(hand.end()["counts"]["publishers_of_another_type"], 1);
  EXPECT_EQ(heard["matched"], false);
  EXPECT_EQ(heard["largest_N"], 0);
  EXPECT_EQ(occurrences(hand.err(), "somebody publishes"), 1U) << hand.err();
}

TEST(Ros2, FeelsThePublisherThatCameFirstUntilItIsSilent) {
  // A busy machine may hear of no publisher for most of a second: that is no silence here.
  Hand hand(new_namespace(), "2500");
  Peer first(hand.name_space(), {"seconds=3", "publish=constant", "force=0.5"});
  EXPECT_TRUE(hand.wait_for("servo_cf: a publisher's wrenches arrive"));
  Peer second(hand.name_space(), {"seconds=12", "publish=constant", "force=-0.5"});
  EXPECT_TRUE(hand.wait_for("a wrench is refused: of another publisher"));
  EXPECT_GE(first.heard()["force_N"], 0) << "the second is not felt beside it";
  // At some time: on a busy machine the last tick may have come too late for any force.
  EXPECT_LT(second.heard()["lowest_N"], 0) << "it is felt once the first is gone";
  hand.end();
  EXPECT_GT(hand.wrenches("taken"), 0U);
  EXPECT_EQ(occurrences(hand.err(), "of another publisher"), 1U) << "a line for the first alone";
}

TEST(Ros2, CountsAgesFromArrivalWhateverThePublishersClock) {
  for (const char* const stamp : {"stamp=1970", "stamp=2100"}) {
    SCOPED_TRACE(stamp);
    Hand hand(new_namespace());
    const nlohmann::json heard = Peer(hand.name_space(), {"seconds=2", "publish=constant", stamp}).heard();
    hand.end();
    EXPECT_GT(heard["largest_N"], 0.1);
    EXPECT_GT(hand.answers("fresh"), 0U);
  }
}

TEST(Ros2, GoesOnUnderAFlood) {
  Hand hand(new_namespace());
  const nlohmann::json heard =
      Peer(hand.name_space(), {"seconds=3", "publish=flood", "reliability=best-effort"}).heard();
  const nlohmann::json summary = hand.end();
  EXPECT_GT(heard["poses"], 100);
  EXPECT_GT(hand.wrenches("taken"), 3000U) << "more than one for each tick";
  EXPECT_GT(summary["ticks"], 500);
}

TEST(Ros2, ServesTheHandOfAClientElsewhere) {
  const std::string name_space = new_namespace();
  const TemporaryFolder folder;
  const std::string file = folder.file("server.json");
  Listener server(kRos2, {"--namespace", name_space, "--domain", domain(), "--summary", file});
  Client client(server.address(), {"--device", "omni", "--operator", "trace-sphere", "--quiet"});
  EXPECT_TRUE(client.wait_for("connected; simulated: ")) << client.err();
  const nlohmann::json heard = Peer(name_space, {"seconds=3", "publish=spring"}).heard();
  const Ran second = run(kClient, {"--server", server.address(), "--device", "omni", "--once", "--quiet", "--rendering",
                                   "remote", "--scene-cache", "none"});
  EXPECT_NE(second.exit_code, 0) << "one hand has the topics";
  EXPECT_THAT(second.err, HasSubstr("refused"));
  EXPECT_EQ(client.stop(SIGINT), client.expected_end());
  EXPECT_EQ(server.stop(SIGTERM), 0) << server.err();
  EXPECT_GE(client.summary()["passivity"]["minimum_J"].get<double>(), kPassive_J);
  EXPECT_GT(heard["poses"], 100);
  EXPECT_GT(heard["way_m"], 0.01);
  EXPECT_GT(heard["largest_N"], 0.1);
  EXPECT_GT(counted(server.out(), "answers", "fresh"), 100U);
  const nlohmann::json summary = nlohmann::json::parse(content(file), nullptr, false);
  EXPECT_EQ(summary["answers_fresh"], counted(server.out(), "answers", "fresh"));
  EXPECT_EQ(summary["counts"]["sessions_opened"], 1);
}

TEST(Ros2, RefusesWrongUseInOneLine) {
  struct Wrong {
    Words words;
    const char* says;
  };
  for (const Wrong& wrong :
       {Wrong{{"--namespace", "a b"}, "--namespace: a namespace has letters, digits"},
        Wrong{{"--domain", "300"}, "--domain must be a whole number from 0 to 232, got '300'"},
        Wrong{{"--key", "k"}, "--key needs --listen"},
        Wrong{{"--listen", "127.0.0.1:0", "--device", "omni"}, "--device does not go with --listen"},
        Wrong{{"--listen", "0.0.0.0:0"}, "0.0.0.0"}, Wrong{{"--hold", "600", "--drop", "500"}, "--hold, --drop: "}}) {
    const Ran ran = run(kRos2, wrong.words);
    EXPECT_EQ(ran.exit_code, 2) << wrong.says;
    EXPECT_THAT(ran.err, HasSubstr(wrong.says));
    EXPECT_EQ(lines(ran.err), 1U) << ran.err;
  }
}

}  // namespace
}  // namespace forcebound::test
