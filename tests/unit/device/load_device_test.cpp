#include "forcebound/device/load_device.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iterator>
#include <numbers>
#include <variant>

#include "forcebound/device/shipped_devices.hpp"
#include "tests/support/source_folder.hpp"

namespace forcebound::device {
namespace {

using testing::HasSubstr;

std::string refusal(const std::function<void()>& attempt) {
  try {
    attempt();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "accepted";
}

std::string refusal_of_file(const std::string& text) {
  return refusal([&] { (void)parse_device(text, "devices/mine.toml"); });
}

constexpr const char* kPoint =
    "kind = 'cartesian'\ndegrees_of_freedom = 2\nmass_kg = 0.1\ndamping_N_s_per_m = 5\nforce_N_max = 30\n";

TEST(LoadDevice, ShipsThePapersDevices) {
  const DeviceDescription wall = load_device("wall-1dof");
  EXPECT_EQ(wall.facts.name, "wall-1dof");
  EXPECT_EQ(wall.facts.degrees_of_freedom(), 1);
  EXPECT_EQ(wall.facts.damping(0, 0), 30);
  EXPECT_EQ(wall.facts.encoder_step[0], 15e-6);
  EXPECT_EQ(wall.facts.friction[0], 0);
  EXPECT_EQ(load_device("cartesian-2dof").facts.damping, Matrix::Identity(2, 2));
  EXPECT_EQ(load_device("cartesian-3dof").facts.damping, 0.5 * Matrix::Identity(3, 3));
  EXPECT_EQ(load_device("firm-3dof").facts.damping, 30 * Matrix::Identity(3, 3));
}

TEST(LoadDevice, EveryShippedDeviceLoadsWithTheHoldTimeOfTwoTicks) {
  ASSERT_EQ(shipped_device_names().size(), 10U);
  for (const std::string& name : shipped_device_names()) {
    const DeviceDescription device = load_device(name);
    EXPECT_EQ(device.facts.hold_s_max, 2e-3) << name;
    EXPECT_EQ(device.facts.latency_s, 0) << name;
    EXPECT_EQ(device.facts.cartesian, std::holds_alternative<std::monostate>(device.geometry)) << name;
    EXPECT_THAT(describe(device), testing::StartsWith(name + ": "));
  }
}

TEST(LoadDevice, OmniIsAnArmWithItsGeometry) {
  const DeviceDescription omni = load_device("omni");
  EXPECT_EQ(std::get<ArmGeometry>(omni.geometry).upper_length_m, 0.1335);
  EXPECT_GT(omni.facts.encoder_step.minCoeff(), 0);
}

/// Whether the tip reaches all of a cylinder about the origin whose axis points at the user.
bool reaches_cylinder(const DeviceDescription& device, double radius_m, double half_length_m) {
  const auto kinematics = make_kinematics(device.geometry);
  for (int turn = 0; turn < 24; ++turn) {
    for (int along = -2; along <= 2; ++along) {
      const double angle = turn * std::numbers::pi / 12;
      Vector place(3);
      place << radius_m * std::cos(angle), half_length_m * along / 2, radius_m * std::sin(angle);
      if ((kinematics->position(kinematics->joints_at(place)) - place).norm() > 1e-9) return false;
    }
  }
  return true;
}

TEST(LoadDevice, PublishedDevicesReachTheirPublishedWorkspaceAndAreMarkedAsGuesses) {
  for (const char* const name : {"falcon", "omega-3", "haply-2diy", "premium-6dof"}) {
    EXPECT_FALSE(load_device(name).identified) << name;
  }
  EXPECT_TRUE(load_device("omni").identified) << "the device of a paper's kind, not a published one's facts";
  EXPECT_TRUE(reaches_cylinder(load_device("falcon"), 0.05, 0.035));
  EXPECT_TRUE(reaches_cylinder(load_device("omega-3"), 0.08, 0.055));
  EXPECT_FALSE(reaches_cylinder(load_device("falcon"), 0.08, 0.055)) << "of two devices the smaller one";
}

TEST(LoadDevice, PremiumReachesItsPublishedWorkspaceWithALevelHandleFarFromSingularPlaces) {
  const DeviceDescription premium = load_device("premium-6dof");
  EXPECT_EQ(premium.facts.force_N_max, 8.5);
  EXPECT_EQ(premium.facts.torque_N_m_max, 0.17);
  const auto kinematics = make_kinematics(premium.geometry);
  for (const double x : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
    for (const double y : {-1.0, 0.0, 1.0}) {
      for (const double z : {-1.0, 0.0, 1.0}) {
        Vector place(3);
        place << 0.5 * 0.381 * x, 0.5 * 0.191 * y, 0.5 * 0.267 * z;
        const Vector joint = kinematics->joints_at_pose(place, Eigen::Quaterniond::Identity());
        EXPECT_LT((kinematics->position(joint) - place).norm(), 1e-9) << place.transpose();
        EXPECT_LT(kinematics->orientation(joint)->vec().norm(), 1e-9) << place.transpose();
        // Zero where the arm, or the gimbal whose axes meet in the tip, is singular.
        const Matrix jacobian = kinematics->jacobian(joint);
        EXPECT_GT(std::abs(jacobian.topLeftCorner<3, 3>().determinant()), 5e-4) << place.transpose();
        EXPECT_GT(std::abs(jacobian.bottomRightCorner<3, 3>().determinant()), 0.2) << place.transpose();
      }
    }
  }
}

TEST(LoadDevice, PublishedDevicesHaveTheirPublishedResolution) {
  const auto finest_and_coarsest_m = [](const char* name) {
    const DeviceDescription device = load_device(name);
    const auto kinematics = make_kinematics(device.geometry);
    const int dof = device.facts.degrees_of_freedom();
    const Matrix steps =
        kinematics->jacobian(kinematics->joints_at(Vector::Zero(dof))) * Matrix(device.facts.encoder_step.asDiagonal());
    return std::pair{steps.colwise().norm().minCoeff(), steps.colwise().norm().maxCoeff()};
  };
  // A Falcon: 400 dots per inch, or better.
  EXPECT_LT(finest_and_coarsest_m("falcon").second, 63.5e-6);
  EXPECT_GT(finest_and_coarsest_m("falcon").first, 20e-6);
  EXPECT_NEAR(finest_and_coarsest_m("omega-3").second, 1e-5, 2e-6);
  EXPECT_NEAR(finest_and_coarsest_m("haply-2diy").second, 1e-4, 3e-5);
}

TEST(ParseDevice, TakesNumbersListsAndFullMatrices) {
  const DeviceDescription device = parse_device(
      "kind = 'cartesian'\ndegrees_of_freedom = 2\nmass_kg = [0.1, 0.2]\ndamping_N_s_per_m = [[2, 1], [1, 3]]\n"
      "friction_N = [0, 0.1]\nencoder_step_m = 1e-5\nactuator_step_N = 0.01\nforce_N_max = 5\nperiod_s = 0.0005\n"
      "hold_s_max = 0.003\nreleases = false\nlatency_s = 1e-4\n",
      "a/b/plane.toml");
  EXPECT_EQ(device.facts.name, "plane");
  EXPECT_EQ(device.inertia(1, 1), 0.2);
  EXPECT_EQ(device.inertia(0, 1), 0);
  EXPECT_EQ(device.facts.damping(0, 1), 1);
  EXPECT_EQ(device.facts.friction[1], 0.1);
  EXPECT_EQ(device.facts.encoder_step[1], 1e-5);
  EXPECT_EQ(device.facts.actuator_step[0], 0.01);
  EXPECT_EQ(device.facts.period_s, 0.0005);
  EXPECT_EQ(device.facts.hold_s_max, 0.003);
  EXPECT_FALSE(device.facts.releases);
  EXPECT_EQ(device.facts.latency_s, 1e-4);
}

TEST(ParseDevice, TakesBoundsOfWhatIsNotKnownExactly) {
  const std::string text =
      std::string(kPoint) +
      "latency_s = 1e-4\nrelease_share = 0.3\nrelease_s = 0.002\nspeed_m_per_s_max = 3\n[uncertainty]\n"
      "stamp_s = [-20e-6, 5e-6]\nlatency_s = [-1e-5, 5e-5]\nlatency_offset_s = [0, 1e-4]\nhold_s = [-1e-4, 1e-4]\n"
      "clock_share = 5e-4\nencoder_steps = 0.1\ndamping_share = 0.02\nfriction_share = 0.2\n"
      "torque_gain_share = [-0.03, 0.1]\nlosses_with_gain = true\ntorque_ripple_share = 0.01\n";
  const DeviceDescription device = parse_device(text, "mine.toml");
  EXPECT_EQ(device.facts.uncertainty, (control::Uncertainty{.stamp_s = {-20e-6, 5e-6},
                                                            .latency_s = {-1e-5, 5e-5},
                                                            .latency_offset_s = {0, 1e-4},
                                                            .hold_s = {-1e-4, 1e-4},
                                                            .clock_share = 5e-4,
                                                            .encoder_steps = 0.1,
                                                            .damping_share = 0.02,
                                                            .friction_share = 0.2,
                                                            .torque_gain_share = {-0.03, 0.1},
                                                            .losses_with_gain = true,
                                                            .torque_ripple_share = 0.01}));
  EXPECT_EQ(device.facts.release_share, 0.3);
  EXPECT_EQ(device.facts.release_s, 0.002);
  EXPECT_EQ(device.facts.speed_max[1], 3);
  EXPECT_THAT(describe(device.facts),
              HasSubstr("then 0.3 of it for 0.002 s, latency 0.0001 s; may be off: readings -2e-05 to 5e-06 s later"));
  EXPECT_EQ(parse_device(kPoint, "mine.toml").facts.uncertainty, control::Uncertainty{}) << "exact unless said";
  const auto told = [](const std::string& line) {
    return parse_device(kPoint + ("[uncertainty]\n" + line), "mine.toml").facts.uncertainty;
  };
  EXPECT_EQ(told("torque_gain_share = 0.03\n").torque_gain_share, (control::Bracket{-0.03, 0.03}));
  EXPECT_EQ(told("actuator_lag_s = 1e-4\n").actuator_lag_s, 1e-4);
  EXPECT_EQ(told("torque_share = 0.02\n").torque_ripple_share, 0.02) << "its name before";
}

TEST(ParseDevice, RefusesStagesOfAReleaseThatIsNone) {
  EXPECT_THAT(refusal_of_file(std::string(kPoint) + "releases = false\nrelease_share = 0.5\nrelease_s = 0.001\n"),
              HasSubstr("release_share must be left out where releases = false"));
}

TEST(ParseDevice, RefusesBoundsThatNoDeviceCanHave) {
  const auto with = [](const std::string& line) { return refusal_of_file(kPoint + ("[uncertainty]\n" + line)); };
  EXPECT_THAT(with("stamp_s = [1e-5, -1e-5]\n"),
              HasSubstr("devices/mine.toml:7: device 'mine', uncertainty: stamp_s must be two numbers, the smaller one "
                        "first, got ["));
  EXPECT_THAT(with("stamp_s = 1e-5\n"), HasSubstr("stamp_s must be two numbers, [least, most], got "));
  EXPECT_THAT(with("stamp_s = [0, 1, 2]\n"), HasSubstr("stamp_s must be two numbers, [least, most]"));
  EXPECT_THAT(with("stamp_s = [0, 1e300]\n"), HasSubstr("stamp_s[1] must be >= -1 and <= 1"));
  EXPECT_THAT(with("hold_s = [-0.002, 0]\n"), HasSubstr("hold_s must be more than minus the hold time"));
  EXPECT_THAT(with("latency_s = [-1e-5, 0]\n"), HasSubstr("or a force would take effect before its command"));
  EXPECT_THAT(with("latency_offset_s = [-1e-5, 0]\n"),
              HasSubstr("latency_offset_s must be no less than minus the least latency"));
  EXPECT_THAT(with("damping_share = 1\n"), HasSubstr("damping_share must be a share >= 0 and < 1, got 1"));
  EXPECT_THAT(with("torque_ripple_share = -0.1\n"), HasSubstr("torque_ripple_share must be >= 0, got -0.1"));
  EXPECT_THAT(with("torque_share = 0.1\ntorque_ripple_share = 0.1\n"),
              HasSubstr("torque_share must be left out: it is the older name of torque_ripple_share"));
  EXPECT_THAT(with("torque_gain_share = 1\n"), HasSubstr("torque_gain_share must be a share >= 0 and < 1, got 1"));
  EXPECT_THAT(with("torque_gain_share = [-1, 0]\n"),
              HasSubstr("torque_gain_share must be more than -1, or the motors' gain could be zero"));
  EXPECT_THAT(with("torque_gain_share = [0.1, 0]\n"), HasSubstr("two numbers, the smaller one first"));
  EXPECT_THAT(with("damping_shore = 0.1\n"), HasSubstr("unknown key 'damping_shore', did you mean 'damping_share'?"));
  EXPECT_THAT(refusal_of_file(kPoint + std::string("uncertainty = 1\n")), HasSubstr("uncertainty must be a table"));
}

TEST(ParseDevice, RefusalNamesFileLineDeviceKeyAndValue) {
  EXPECT_EQ(refusal_of_file("kind = 'cartesian'\ndegrees_of_freedom = 1\nmass_kg = 1\n\ndamping_N_s_per_m = -2\n"),
            "devices/mine.toml:5: device 'mine': damping_N_s_per_m must be > 0, got -2");
}

TEST(ParseDevice, SuggestsTheNearestKeyForAnUnknownOne) {
  EXPECT_THAT(refusal_of_file(std::string(kPoint) + "frcition_N = 1\n"),
              HasSubstr("devices/mine.toml:6: device 'mine': unknown key 'frcition_N', did you mean 'friction_N'?"));
  EXPECT_THAT(refusal_of_file(std::string(kPoint) + "latency = 1\n"), HasSubstr("did you mean 'latency_s'?"));
}

TEST(ParseDevice, RefusesImpossibleDevices) {
  const auto with = [](const std::string& line) { return refusal_of_file(kPoint + line); };
  EXPECT_THAT(with("friction_N = [0, -1]\n"),
              HasSubstr("mine.toml:6: device 'mine': friction_N[1] must be >= 0, got -1"));
  EXPECT_THAT(with("friction_N = [0]\n"), HasSubstr("friction_N must have 2 numbers, got 1"));
  EXPECT_THAT(with("friction_N = 'much'\n"), HasSubstr("friction_N must be a finite number, got 'much'"));
  EXPECT_THAT(with("encoder_step_m = nan\n"), HasSubstr("encoder_step_m must be a finite number, got nan"));
  EXPECT_THAT(with("hold_s_max = 0\n"), HasSubstr("hold_s_max must be > 0 and <= 1, got 0"));
  EXPECT_THAT(with("releases = 1\n"), HasSubstr("releases must be true or false, got 1"));
  EXPECT_THAT(with("hold_s_max = 2\n"), HasSubstr("hold_s_max must be > 0 and <= 1, got 2"));
  EXPECT_THAT(with("latency_s = 0.02\n"), HasSubstr("latency_s must be >= 0 and <= 0.01, got 0.02"));
  EXPECT_THAT(with("[arm]\n"), HasSubstr("mine.toml:6: device 'mine': unknown key 'arm'"));
  EXPECT_THAT(with("force_N_max = 3\n"), HasSubstr("mine.toml:6: not TOML: "));
}

TEST(ParseDevice, RefusesDampingThatIsNotPositiveDefinite) {
  const std::string head = "kind = 'cartesian'\ndegrees_of_freedom = 2\nmass_kg = 1\nforce_N_max = 3\n";
  EXPECT_THAT(refusal_of_file(head + "damping_N_s_per_m = [[1, 2], [2, 1]]\n"),
              HasSubstr("mine.toml:5: device 'mine': damping_N_s_per_m must be symmetric and positive definite, got "));
  EXPECT_THAT(refusal_of_file(head + "damping_N_s_per_m = [[1, 0.5], [0, 1]]\n"), HasSubstr("symmetric"));
  EXPECT_THAT(refusal_of_file(head + "damping_N_s_per_m = [[1, 0]]\n"), HasSubstr("must be 2 rows"));
  EXPECT_THAT(refusal_of_file(head + "damping_N_s_per_m = [[1, 0], 2]\n"), HasSubstr("must be a list of rows"));
}

TEST(ParseDevice, RefusesMissingKeysAndUnknownKinds) {
  EXPECT_EQ(refusal_of_file(""),
            "devices/mine.toml:1: device 'mine': 'kind' is missing (accepted: \"cartesian\", \"arm\", \"five_bar\", "
            "\"delta\", \"chain\")");
  EXPECT_EQ(refusal_of_file("\nkind = 'cartesien'\n"),
            "devices/mine.toml:2: device 'mine': unknown kind 'cartesien', "
            "did you mean 'cartesian'? (known: cartesian, arm, five_bar, delta, chain)");
  EXPECT_THAT(refusal_of_file("kind = 'cartesian'\ndegrees_of_freedom = 1\nmass_kg = 1\ndamping_N_s_per_m = 1\n"),
              HasSubstr("'force_N_max' is missing (accepted: > 0)"));
  EXPECT_THAT(refusal_of_file("kind = 'cartesian'\ndegrees_of_freedom = 2\n"),
              HasSubstr("'mass_kg' is missing (accepted: > 0: one number, 2 numbers, or 2 rows of 2)"));
  EXPECT_THAT(refusal_of_file("kind = 'cartesian'\ndegrees_of_freedom = 7\n"),
              HasSubstr("degrees_of_freedom must be a whole number from 1 to 3, got 7"));
  EXPECT_THAT(refusal_of_file("kind = 'arm'\ndegrees_of_freedom = 3\n"),
              HasSubstr("mine.toml:1: device 'mine': 'arm' is missing (accepted: a table, which a simulated device "
                        "needs; a file of facts alone is a driver's: driver:FILE.so:facts=devices/mine.toml)"));
  EXPECT_THAT(refusal_of_file("kind = 'arm'\ndegrees_of_freedom = 3\n[amr]\n"),
              HasSubstr("'arm' is missing, is 'amr' a misspelling of it?"));
  EXPECT_THAT(refusal_of_file("kind = 'arm'\ndegrees_of_freedom = 3\n[arm]\nupper_length_m = 0\n"),
              HasSubstr("mine.toml:4: device 'mine', arm: upper_length_m must be > 0, got 0"));
}

constexpr const char* kJointFacts =
    "joint_inertia_kg_m2 = 1e-3\njoint_damping_N_m_s_per_rad = 0.01\nencoder_step_rad = 1e-4\nforce_N_max = 5\n";

std::string of_kind(const std::string& kind, int degrees_of_freedom) {
  return "kind = '" + kind + "'\ndegrees_of_freedom = " + std::to_string(degrees_of_freedom) + "\n" + kJointFacts;
}

const std::string& five_bar() {
  static const std::string kText = of_kind("five_bar", 2) +
                                   "[five_bar]\nbase_distance_m = 0.04\nproximal_length_m = 0.07\n"
                                   "distal_length_m = 0.09\norigin_reach_m = ";
  return kText;
}

const std::string& delta() {
  static const std::string kText = of_kind("delta", 3) +
                                   "[delta]\nbase_radius_m = 0.04\nplatform_radius_m = 0.02\n"
                                   "upper_arm_length_m = 0.06\nforearm_length_m = 0.12\nfirst_arm_rad = 1.5\n"
                                   "origin_reach_m = ";
  return kText;
}

/// In the level plane: links of 0.1 m to the user's right, its base at x = -0.15 m.
std::string planar_chain(int joints, int degrees_of_freedom = 2, const std::string& axis = "[0, 0, 1]") {
  std::string text =
      of_kind("chain", degrees_of_freedom) + "[chain]\ntip_m = [" + std::to_string(0.1 * joints - 0.15) + ", 0, 0]\n";
  for (int i = 0; i < joints; ++i) {
    text += "[[chain.joint]]\nname = 'joint " + std::to_string(i) + "'\naxis = " + axis + "\npoint_m = [" +
            std::to_string(0.1 * i - 0.15) + ", 0, 0]\nstart_rad = 0.9\n";
  }
  return text;
}

TEST(ParseDevice, ReadsTheGeometryOfEachKind) {
  const DeviceDescription planar = parse_device(five_bar() + "0.1\n", "mine.toml");
  EXPECT_EQ(std::get<FiveBarGeometry>(planar.geometry).base_distance_m, 0.04);
  EXPECT_EQ(std::get<FiveBarGeometry>(planar.geometry).distal_length_m, 0.09);
  EXPECT_FALSE(planar.facts.cartesian);
  EXPECT_EQ(planar.facts.degrees_of_freedom(), 2);
  EXPECT_THAT(describe(planar), HasSubstr("2 degrees of freedom, five-bar linkage, inertia [0.001 0.001] kg m^2"));
  const DeviceDescription spatial = parse_device(delta() + "0.12\nside_offset_m = -0.001\n", "mine.toml");
  EXPECT_EQ(std::get<DeltaGeometry>(spatial.geometry).side_offset_m, -0.001);
  EXPECT_EQ(std::get<DeltaGeometry>(spatial.geometry).upper_arm_length_m, 0.06);
  EXPECT_THAT(describe(spatial), HasSubstr("3 degrees of freedom, delta, inertia"));
}

TEST(ParseDevice, AChainMayHaveMoreJointsThanItsTipHasAxes) {
  const DeviceDescription two = parse_device(planar_chain(2), "mine.toml");
  EXPECT_EQ(two.facts.tip_axes, 0);
  EXPECT_EQ(two.facts.degrees_of_freedom(), 2);
  EXPECT_THAT(describe(two), HasSubstr("2 degrees of freedom, serial arm of 2 joints, inertia"));
  const DeviceDescription four = parse_device(planar_chain(4), "mine.toml");
  EXPECT_EQ(four.facts.degrees_of_freedom(), 2);
  EXPECT_EQ(four.facts.joints(), 4);
  EXPECT_EQ(four.facts.encoder_step.rows(), 4);
  EXPECT_EQ(std::get<ChainGeometry>(four.geometry).joints[3].start_rad, 0.9);
  EXPECT_EQ(parse_facts(planar_chain(6), "mine.toml").facts.joints(), 6);
}

TEST(ParseDevice, ReadsTheExampleOfThePage) {
  std::ifstream page(forcebound::test::source_folder() / "common/devices/README.md");
  const std::string text(std::istreambuf_iterator<char>(page), {});
  const std::size_t begin = text.find("```toml\n");
  ASSERT_NE(begin, std::string::npos);
  const std::size_t from = text.find('\n', begin) + 1;
  const DeviceDescription device = parse_device(text.substr(from, text.find("```", from) - from), "mine.toml");
  EXPECT_EQ(device.facts.joints(), 3);
  EXPECT_EQ(device.facts.degrees_of_freedom(), 2);
}

TEST(ParseDevice, RefusesGeometryThatCannotBe) {
  EXPECT_THAT(refusal_of_file(of_kind("delta", 3)), HasSubstr("mine.toml:1: device 'mine': 'delta' is missing"));
  EXPECT_THAT(refusal_of_file(of_kind("delta", 2)), HasSubstr("degrees_of_freedom must be a whole number"));
  EXPECT_THAT(refusal_of_file(of_kind("five_bar", 3)), HasSubstr("degrees_of_freedom must be a whole number"));
  EXPECT_THAT(refusal_of_file(five_bar() + "0.3\n"),
              HasSubstr("mine.toml:7: device 'mine', five_bar: the tip does not reach the scene's origin"));
  EXPECT_THAT(refusal_of_file(delta() + "0.3\n"),
              HasSubstr("device 'mine', delta: the tip does not reach the scene's origin"));
  EXPECT_THAT(refusal_of_file(delta() + "nan\n"), HasSubstr("origin_reach_m must be a finite number, got nan"));
  EXPECT_THAT(refusal_of_file(delta() + "0.12\nforearm_m = 1\n"), HasSubstr("unknown key 'forearm_m'"));
  EXPECT_THAT(refusal_of_file(five_bar() + "0.1\n[arm]\n"), HasSubstr("unknown key 'arm'"));
}

TEST(ParseDevice, RefusesChainsThatCannotBe) {
  EXPECT_THAT(refusal_of_file(of_kind("chain", 3) + "[chain]\ntip_m = [0, 0, 0]\n"),
              HasSubstr("device 'mine', chain: needs from degrees_of_freedom = 3 to 6 tables [[chain.joint]], got 0"));
  EXPECT_THAT(refusal_of_file(planar_chain(1)),
              HasSubstr("needs from degrees_of_freedom = 2 to 6 tables [[chain.joint]]"));
  EXPECT_THAT(refusal_of_file(planar_chain(7)), HasSubstr("[[chain.joint]], got 7"));
  EXPECT_THAT(refusal_of_file(planar_chain(4, 3)), HasSubstr("singular at the scene's origin"))
      << "a tip that stays in a plane has no third axis";
  EXPECT_THAT(refusal_of_file(planar_chain(2, 2, "[0, 0, 0]")), HasSubstr("axis must be a direction"));
  EXPECT_THAT(refusal_of_file(planar_chain(4) + "axes = 1\n"), HasSubstr("unknown key 'axes', did you mean 'axis'?"));
  std::string stepped = planar_chain(4);
  stepped.insert(stepped.find("[chain]"), "actuator_step_N_m = 1e-3\n");
  EXPECT_THAT(refusal_of_file(stepped), HasSubstr("actuator_step_N_m must be 0 with more joints than"));
  EXPECT_THAT(refusal_of_file(of_kind("chain", 4)),
              HasSubstr("degrees_of_freedom must be 1, 2 or 3, or 6 for a tip that turns"));
  std::string without_torque = planar_chain(3);
  without_torque.insert(without_torque.find("[chain]"), "torque_N_m_max = 1\n");
  EXPECT_THAT(refusal_of_file(without_torque),
              HasSubstr("torque_N_m_max must be left out, as this tip shows no torque"));
  std::string flat = planar_chain(6, 6);
  flat.insert(flat.find("[chain]"), "torque_N_m_max = 1\n");
  EXPECT_THAT(refusal_of_file(flat), HasSubstr("the tip does not move and turn every way"));
}

TEST(ParseDevice, KeysInMetresAreOfTranslationsAlone) {
  EXPECT_THAT(refusal_of_file("kind = 'cartesian'\ndegrees_of_freedom = 6\n"),
              HasSubstr("degrees_of_freedom must be a whole number from 1 to 3"));
}

TEST(ParseDevice, AChainOfSixAxesHasThreeRotationsAndALimitOfItsTorque) {
  const DeviceDescription arm = load_device("arm-6dof");
  EXPECT_EQ(arm.facts.degrees_of_freedom(), 6);
  EXPECT_EQ(arm.facts.translations(), 3);
  EXPECT_EQ(arm.facts.joints(), 6);
  EXPECT_EQ(arm.facts.torque_N_m_max, 0.3);
  EXPECT_FALSE(arm.identified);
  const auto shipped = std::ranges::find(shipped_devices(), "arm-6dof", &text::EmbeddedText::name);
  std::string text(shipped->text);
  text.erase(text.find("torque_N_m_max"), std::string("torque_N_m_max = 0.3\n").size());
  EXPECT_THAT(refusal_of_file(text), HasSubstr("'torque_N_m_max' is missing"));
  EXPECT_THAT(describe(arm), HasSubstr("force <= 8 N, torque <= 0.3 N m, hold"));
  EXPECT_THAT(describe(load_device("omni")), Not(HasSubstr("torque")));
}

TEST(ParseFacts, NeedNeitherMassNorGeometry) {
  const RealDevice rail =
      parse_facts("kind = 'cartesian'\ndegrees_of_freedom = 1\ndamping_N_s_per_m = 5\nforce_N_max = 10\n", "mine.toml");
  EXPECT_EQ(rail.facts.damping(0, 0), 5);
  EXPECT_EQ(rail.safety, Safety::of_a_person(rail.facts));
  EXPECT_EQ(rail.safety.rms_force_N_max, 6);
  const RealDevice arm = parse_facts(
      "kind = 'arm'\ndegrees_of_freedom = 5\njoint_damping_N_m_s_per_rad = 0.1\nforce_N_max = 10\n", "mine.toml");
  EXPECT_FALSE(arm.facts.cartesian);
  EXPECT_EQ(arm.facts.degrees_of_freedom(), 5);
}

TEST(ParseFacts, HaveLimitsForTheHand) {
  const std::string safety = "[safety]\nramp_s = 2\nworkspace_radius_m = 0.1\nspeed_m_per_s_max = 0\n";
  const Safety wanted{.ramp_s = 2, .speed_m_per_s_max = 0, .workspace_radius_m = 0.1, .rms_force_N_max = 18};
  EXPECT_EQ(parse_facts(kPoint + safety, "mine.toml").safety, wanted);
  EXPECT_EQ(parse_device(kPoint, "mine.toml").safety, Safety{}) << "a simulated hand needs none";
  EXPECT_EQ(parse_device(kPoint + safety, "mine.toml").safety.ramp_s, 2);
  EXPECT_THAT(refusal_of_file(std::string(kPoint) + "[safety]\nramp_s = -1\n"), HasSubstr("ramp_s must be"));
  EXPECT_EQ(parse_facts(kPoint, "mine.toml").safety.dead_man_button, std::nullopt);
  EXPECT_EQ(parse_facts(std::string(kPoint) + "[safety]\ndead_man_button = 0\n", "mine.toml").safety.dead_man_button,
            0);
  EXPECT_THAT(refusal_of_file(std::string(kPoint) + "[safety]\ndead_man_button = 32\n"),
              HasSubstr("dead_man_button must be a whole number from 0 to 31, got 32"));
  EXPECT_THAT(refusal_of_file(std::string(kPoint) + "[safety]\nworkspace_fade_m = 0\n"), HasSubstr("workspace_fade_m"));
  EXPECT_THAT(refusal_of_file(std::string(kPoint) + "[safety]\nramp = 1\n"), HasSubstr("did you mean 'ramp_s'"));
  EXPECT_THAT(refusal_of_file(std::string(kPoint) + "[safety]\nturn_rad_per_s_max = 1\n"),
              HasSubstr("turn_rad_per_s_max"))
      << "it shows no torque";
}

TEST(ParseFacts, LimitHowFastTheHandTurnsWhereATorqueIsShown) {
  const auto shipped = std::ranges::find(shipped_devices(), "arm-6dof", &text::EmbeddedText::name);
  const std::string text(shipped->text);
  EXPECT_EQ(parse_facts(text, "mine.toml").safety.turn_rad_per_s_max, 20);
  EXPECT_EQ(parse_facts(text + "[safety]\nturn_rad_per_s_max = 8\n", "mine.toml").safety.turn_rad_per_s_max, 8);
  EXPECT_EQ(parse_facts(kPoint, "mine.toml").safety.turn_rad_per_s_max, 0);
}

TEST(LoadDevice, UnknownNameIsRefusedWithTheKnownNames) {
  const std::string what = refusal([] { (void)load_device("wall-2dof"); });
  EXPECT_THAT(what, HasSubstr("unknown device 'wall-2dof', did you mean 'wall-1dof'?"));
  EXPECT_THAT(
      what,
      HasSubstr(
          "cartesian-2dof, cartesian-3dof, falcon, firm-3dof, haply-2diy, omega-3, omni, premium-6dof, wall-1dof"));
}

TEST(LoadDevice, FactsOfASimulatedDeviceAreRefused) {
  EXPECT_EQ(refusal([] { (void)load_device("omni:facts=mine.toml"); }),
            "'omni' takes no facts: only a driver does, as in driver:FILE.so:facts=mine.toml");
}

TEST(LoadDevice, MissingFileIsNamedWithTheReason) {
  EXPECT_EQ(refusal([] { (void)load_device("no/such.toml"); }),
            "no/such.toml: cannot be read: No such file or directory");
}

TEST(LoadDevice, RefusesADirectoryAndAnEmptyFileWithTheReason) {
  EXPECT_EQ(refusal([] { (void)load_device("./"); }), "./: cannot be read: it is a directory");
  const std::string path = testing::TempDir() + "forcebound_empty.toml";
  std::ofstream(path).close();
  EXPECT_THAT(refusal([&] { (void)load_device(path); }), HasSubstr("forcebound_empty.toml:1: device"));
  std::remove(path.c_str());
}

TEST(LoadDevice, ReadsAFile) {
  const std::string path = testing::TempDir() + "forcebound_plane.toml";
  std::ofstream(path) << kPoint;
  EXPECT_EQ(load_device(path).facts.name, "forcebound_plane");
  std::remove(path.c_str());
}

}  // namespace
}  // namespace forcebound::device
