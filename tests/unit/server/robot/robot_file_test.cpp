#include <gmock/gmock.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "forcebound/config/config_error.hpp"
#include "forcebound/server/robot/driver_robot.hpp"
#include "forcebound/server/robot/robot_description.hpp"
#include "forcebound/text/file.hpp"
#include "tests/support/driven_arm.hpp"
#include "tests/support/source_folder.hpp"
#include "tests/tools/temporary_folder.hpp"

namespace forcebound::server {
namespace {

using test::robot_driver;
using test::RobotFileText;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using testing::ThrowsMessage;

const std::string kPendulum = R"(kind = "robot"
driver = "pendulum.so"
period_s = 0.001
hold_s_max = 0.01
latency_s = 0.0005
brakes = true
compensates_gravity = false
tool_m = [0, 0, 1.5]
tool_speed_m_per_s_max = 1
tool_turn_rad_per_s_max = 2
[settings]
port = "/dev/ttyUSB0"
[sensor]
period_s = 0.002
noise_N_sd = 0.1
[[joint]]
name = "hinge"
axis = [0, 2, 0]
point_m = [0, 0, 0.5]
lowest_rad = -1
highest_rad = 2
rest_rad = 0.25
speed_rad_per_s_max = 3
torque_N_m_max = 20
torque_N_m_per_s_max = 500
damping_N_m_s_per_rad = 2
friction_N_m = 0.1
mass_kg = 4
centre_m = [0, 0, 0.8]
inertia_kg_m2 = 0.01
)";

/// With another line in place of the one that begins so.
std::string with_line(const std::string& begin, const std::string& line) {
  const std::size_t at = kPendulum.find("\n" + begin) + 1;
  const std::size_t end = kPendulum.find('\n', at);
  return kPendulum.substr(0, at) + line + kPendulum.substr(end);
}

TEST(RobotFile, IsThatOfTheExampleDriver) {
  const std::string place = (test::source_folder() / "tests/consumer/own_robot/my-arm.toml").string();
  const RobotFile file = parse_robot(text::read_file(place), place);
  EXPECT_THAT(file.driver, testing::EndsWith("own_robot/arm.so"));
  EXPECT_EQ(file.robot.facts.joints(), 1);
}

TEST(RobotFile, TellsARobotItsDriverAndItsSettings) {
  const RobotFile file = parse_robot(kPendulum, "/home/me/pendulum.toml");
  EXPECT_EQ(file.driver, "/home/me/pendulum.so") << "relative to the file";
  EXPECT_THAT(file.settings, testing::ElementsAre(testing::Pair("port", "/dev/ttyUSB0")));
  const RobotDescription& robot = file.robot;
  EXPECT_EQ(robot.facts.name, "pendulum");
  EXPECT_EQ(robot.facts.joints(), 1);
  EXPECT_EQ(robot.facts.period_s, 0.001);
  EXPECT_EQ(robot.facts.hold_s_max, 0.01);
  EXPECT_EQ(robot.facts.damping(0, 0), 2);
  EXPECT_EQ(robot.facts.friction[0], 0.1);
  EXPECT_EQ(robot.facts.encoder_step[0], 0);
  EXPECT_EQ(robot.facts.force_N_max, 20);
  EXPECT_EQ(robot.facts.speed_max[0], 4 * 3) << "no joint is ever faster";
  EXPECT_EQ(robot.facts.latency_s, 0.0005);
  EXPECT_FALSE(robot.identified);
  EXPECT_TRUE(robot.brakes);
  EXPECT_FALSE(robot.compensates_gravity);
  EXPECT_EQ(robot.chain.limits.torque_rate_max[0], 500);
  EXPECT_EQ(robot.chain.rest[0], 0.25);
  ASSERT_TRUE(robot.sensor);
  EXPECT_EQ(robot.sensor->noise_N_sd, 0.1);
}

TEST(RobotFile, HasTheGeometryAndTheMassesOfAPendulum) {
  const SerialChain chain(parse_robot(kPendulum, "pendulum.toml").robot.chain);
  const Vector q = Vector::Constant(1, 0.3);
  const ToolPose tool = chain.pose(q);
  EXPECT_LT((tool.position - Eigen::Vector3d(std::sin(0.3), 0, 0.5 + std::cos(0.3))).norm(), 1e-12);
  EXPECT_NEAR(chain.mass_matrix(q)(0, 0), 0.01 + 4 * 0.3 * 0.3, 1e-12);
  EXPECT_NEAR(chain.gravity(q)[0], -4 * kGravity_m_per_s2 * 0.3 * std::sin(0.3), 1e-12);
}

TEST(RobotFile, IsRefusedWithItsLine) {
  const auto refused = [](const std::string& text, const std::string& where, const std::string& why) {
    EXPECT_THAT([&] { (void)parse_robot(text, "pendulum.toml"); },
                ThrowsMessage<config::ConfigError>(
                    AllOf(StartsWith("pendulum.toml:" + where), HasSubstr(why), Not(HasSubstr("\n")))))
        << text;
  };
  refused(with_line("driver", "drivr = 'pendulum.so'"), "2: ", "unknown key 'drivr'");
  refused(with_line("period_s", "period_s = 1"), "3: ", "period_s");
  refused(with_line("hold_s_max", "hold_s_max = 0.0001"), "4: ", "hold_s_max");
  refused(with_line("brakes", "brakes = false"), "", "must have brakes, or it would fall at each stop");
  refused(with_line("tool_m", "tool_m = [0, 1]"), "8: ", "tool_m");
  refused(with_line("port", "port = 1"), "12: ", "port must be a text, as the driver gets it");
  refused(with_line("noise_N_sd", "noise_N_sd = -1"), "15: ", "noise_N_sd");
  refused(with_line("axis", "axis = [0, 0, 0]"), "18: ", "axis must be a direction");
  refused(with_line("highest_rad", "highest_rad = -2"), "21: ", "highest_rad must be > lowest_rad");
  refused(with_line("rest_rad", "rest_rad = 3"), "22: ", "rest_rad");
  refused(with_line("torque_N_m_max", "torque_N_m_max = 0"), "24: ", "torque_N_m_max must be > 0, got 0");
  refused(with_line("torque_N_m_max", ""), "", "torque_N_m_max");
  refused(with_line("torque_N_m_per_s_max", "torque_N_m_per_s_max = -1"), "25: ", "torque_N_m_per_s_max");
  refused(with_line("friction_N_m", "fricton_N_m = 1"), "27: ", "unknown key 'fricton_N_m'");
  refused(with_line("mass_kg", "mass_kg = 0"), "28: ", "mass_kg must be > 0, got 0");
  refused(with_line("inertia_kg_m2", "inertia_kg_m2 = -1"), "30: ", "inertia_kg_m2");
  refused(with_line("[[joint]]", "[[axle]]"), "", "[[joint]], got 0");
  refused(RobotFileText{.joints = 8}.text(), "", "needs 1 to 7 tables [[joint]], got 8");
  std::string chain = kPendulum;
  chain.replace(chain.find("robot"), 5, "chain");
  refused(chain, "1: ", "kind");
}

class FileOfDrivenArm : public testing::Test {
 protected:
  /// The file of the arm, written.
  std::string written(const RobotFileText& text) const {
    const std::string file = folder_.file("my-arm.toml");
    text::write_file(file, text.text());
    return file;
  }
  static std::string of_driver(const std::string& name = "arm") { return "driver = '" + robot_driver(name) + "'\n"; }

  void expect_refused(const RobotFileText& text, const std::string& why) const {
    const std::string file = written(text);
    EXPECT_THAT([&] { (void)open_robot(robot_driver() + ":facts=" + file); },
                ThrowsMessage<std::runtime_error>(AllOf(StartsWith(file), HasSubstr(why), Not(HasSubstr("\n")))));
  }

  test::TemporaryFolder folder_;
};

TEST_F(FileOfDrivenArm, IsAllThatIsNeeded) {
  const auto arm = open_robot_of_file(written({.head = of_driver(), .joint = "torque_N_m_per_s_max = 300\n"}));
  EXPECT_EQ(arm->facts().name, "my-arm");
  EXPECT_EQ(arm->facts().joints(), 7);
  EXPECT_EQ(arm->model().limits().torque_rate_max, Vector::Constant(7, 300));
  EXPECT_FALSE(arm->bounds_are_identified());
  EXPECT_THAT(arm->facts_in_words(), HasSubstr("bounds not identified: guesses"));
}

TEST_F(FileOfDrivenArm, ReplacesWhatTheDriverTells) {
  const auto arm = open_robot(robot_driver() + ":facts=" + written({}));
  EXPECT_EQ(arm->model().limits().torque_max, Vector::Constant(7, 20));
  EXPECT_EQ(arm->force_sensor(), std::nullopt);
}

TEST_F(FileOfDrivenArm, IsRefusedWhereItDoesNotMatchTheDriver) {
  const std::string robot = "the robot of driver '" + robot_driver() + "' has ";
  expect_refused({.joints = 2}, "joints: 2, but " + robot + "7");
  expect_refused({.period_s = 0.0005}, "period_s = 5e-04, but " + robot + "at least 0.001");
  expect_refused({.torque_N_m = 30}, "torque_N_m_max of joint 5 = 30, but " + robot + "at most 20");
  const auto refuse = [&](const std::string& key, const std::string& why) { expect_refused({.line = key}, why); };
  refuse("speed_rad_per_s_max = 3", "speed_rad_per_s_max of joint 1 = 3, but " + robot + "at most 2");
  refuse("lowest_rad = -3", "lowest_rad of joint 1 = -3, but " + robot + "at least -2.9");
  refuse("highest_rad = 3", "highest_rad of joint 1 = 3, but " + robot + "at most 2.9");
  refuse("tool_speed_m_per_s_max = 1.1", "tool_speed_m_per_s_max = 1.1, but " + robot + "at most 1");
  refuse("tool_turn_rad_per_s_max = 2.1", "tool_turn_rad_per_s_max = 2.1, but " + robot + "at most 2");
  refuse("hold_s_max = 0.009", "hold_s_max = 0.009, but " + robot + "at least 0.01");
}

TEST_F(FileOfDrivenArm, IsRefusedWhereItClaimsWhatTheDriverLacks) {
  const auto refuse = [this](const std::string& settings, const std::string& head, const std::string& why) {
    const std::string file = written({.head = head});
    EXPECT_THAT([&] { (void)open_robot(robot_driver() + ":" + settings + "facts=" + file); },
                ThrowsMessage<std::runtime_error>(
                    AllOf(StartsWith(file), HasSubstr("but the robot of driver '" + robot_driver() + "' " + why))));
  };
  refuse("", "brakes = true\ncompensates_gravity = false\n", "compensates its weight itself");
  refuse("gravity=1,", "", "leaves its weight to the program");
  refuse("brakes=0,", "brakes = true\n", "has none");
  refuse("sensor=0,", "[sensor]\nperiod_s = 0.001\n", "has no force sensor");
  refuse("rate=100,", "", "has at most 100");
  EXPECT_NO_THROW((void)open_robot(
      robot_driver() + ":gravity=1,facts=" + written({.head = "brakes = true\ncompensates_gravity = false\n"})));
}

TEST_F(FileOfDrivenArm, IsRefusedWithoutADriver) {
  const std::string file = written({});
  EXPECT_THAT([&] { (void)open_robot_of_file(file); },
              ThrowsMessage<std::runtime_error>(
                  file + ": robot 'my-arm': driver must be the path of its driver, FILE.so, to be driven"));
  EXPECT_THROW((void)open_robot_of_file("/nonexistent.toml"), std::runtime_error);
}

TEST_F(FileOfDrivenArm, GivesTheDriverItsSettings) {
  EXPECT_THAT([&] { (void)open_robot_of_file(written({.head = of_driver() + "settings = { colour = 'red' }\n"})); },
              ThrowsMessage<std::runtime_error>(HasSubstr("'colour=red' is not accepted")));
}

}  // namespace
}  // namespace forcebound::server
