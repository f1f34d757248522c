#include "forcebound/client/commands/identify/identification.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "forcebound/client/commands/identify/facts_text.hpp"
#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/make_operator.hpp"
#include "tests/tools/lab/identification/hidden_device.hpp"
#include "tests/tools/lab/identification/run_guide.hpp"

namespace forcebound::lab::identification {
namespace {

using client::commands::identify::Findings;
using client::commands::identify::Guide;
using client::commands::identify::GuideSettings;
using client::commands::identify::KnownMass;
using client::commands::identify::LowerBound;
using client::commands::identify::UsableForce;
using control::Matrix;
using control::Vector;

constexpr double kConfidence = 0.99;

/// A device between the guide and the simulated one, with a fault.
class FaultyDevice : public device::HapticDevice {
 public:
  explicit FaultyDevice(device::HapticDevice& device) : device_(device) {}
  [[nodiscard]] const control::DeviceFacts& facts() const noexcept override { return device_.facts(); }
  device::Reading read(time::Nanoseconds now) noexcept override { return device_.read(now); }
  void apply(time::Nanoseconds now, const Vector& force_N) noexcept override {
    largest_N_ = std::max(largest_N_, force_N.norm());
    device_.apply(now, force_N);
  }
  [[nodiscard]] std::optional<time::Nanoseconds> released_at() const noexcept override { return device_.released_at(); }
  [[nodiscard]] double largest_N() const noexcept { return largest_N_; }

 protected:
  device::HapticDevice& device_;
  double largest_N_ = 0;
};

class StuckDevice final : public FaultyDevice {
 public:
  using FaultyDevice::FaultyDevice;
  void apply(time::Nanoseconds now, const Vector& force_N) noexcept override {
    largest_N_ = std::max(largest_N_, force_N.norm());
    device_.apply(now, Vector::Zero(force_N.size()));
  }
};

/// Its motors give no more than so much.
class SaturatedDevice final : public FaultyDevice {
 public:
  SaturatedDevice(device::HapticDevice& device, double most_N) : FaultyDevice(device), most_N_(most_N) {}
  void apply(time::Nanoseconds now, const Vector& force_N) noexcept override {
    const double size = force_N.norm();
    device_.apply(now, size > most_N_ ? Vector(force_N * (most_N_ / size)) : force_N);
  }

 private:
  double most_N_;
};

class UnpluggedDevice final : public FaultyDevice {
 public:
  UnpluggedDevice(device::HapticDevice& device, int readings) : FaultyDevice(device), left_(readings) {}
  device::Reading read(time::Nanoseconds now) noexcept override {
    device::Reading reading = device_.read(now);
    if (--left_ < 0) reading.status = device::Reading::Status::failed;
    return reading;
  }
  void apply(time::Nanoseconds now, const Vector& force_N) noexcept override {
    if (left_ < 0) force_after_N_ = std::max(force_after_N_, force_N.norm());
    device_.apply(now, force_N);
  }
  [[nodiscard]] double force_after_N() const noexcept { return force_after_N_; }

 private:
  int left_;
  double force_after_N_ = 0;
};

/// Someone presses a button.
class ButtonDevice final : public FaultyDevice {
 public:
  /// @param from reading at which button 1 is pressed
  /// @param always button 0 is
  ButtonDevice(device::HapticDevice& device, int from, bool always)
      : FaultyDevice(device), left_(from), always_(always) {}
  device::Reading read(time::Nanoseconds now) noexcept override {
    device::Reading reading = device_.read(now);
    reading.handle.buttons = (always_ ? 1U : 0U) | (--left_ < 0 ? 2U : 0U);
    return reading;
  }
  void apply(time::Nanoseconds now, const Vector& force_N) noexcept override {
    last_N_ = force_N.norm();
    device_.apply(now, force_N);
  }
  [[nodiscard]] double last_N() const noexcept { return last_N_; }

 private:
  int left_;
  bool always_;
  double last_N_ = 0;
};

/// Its motors are connected the wrong way round.
class InvertedDevice final : public FaultyDevice {
 public:
  using FaultyDevice::FaultyDevice;
  device::Reading read(time::Nanoseconds now) noexcept override {
    device::Reading reading = device_.read(now);
    farthest_m_ = std::max(farthest_m_, reading.position.norm());
    return reading;
  }
  void apply(time::Nanoseconds now, const Vector& force_N) noexcept override {
    last_N_ = force_N.norm();
    device_.apply(now, -force_N);
  }
  [[nodiscard]] double last_N() const noexcept { return last_N_; }
  [[nodiscard]] double farthest_m() const noexcept { return farthest_m_; }

 private:
  double last_N_ = 0;
  double farthest_m_ = 0;
};

/// How fast its forces grow.
class GrowthDevice final : public FaultyDevice {
 public:
  using FaultyDevice::FaultyDevice;
  void apply(time::Nanoseconds now, const Vector& force_N) noexcept override {
    const double force = force_N[0];
    const double from = force * last_N_ > 0 ? std::abs(last_N_) : 0;
    fastest_N_ = std::max(fastest_N_, std::abs(force) - from);
    last_N_ = force;
    device_.apply(now, force_N);
  }
  [[nodiscard]] double fastest_N() const noexcept { return fastest_N_; }

 private:
  double last_N_ = 0;
  double fastest_N_ = 0;  ///< in a tick
};

/// One axis that no seed draws, between light and heavy.
HiddenDevice plain_device() {
  HiddenDevice hidden;
  control::DeviceFacts& facts = hidden.description.facts;
  facts.name = "plain";
  facts.damping = Matrix::Constant(1, 1, 2);
  facts.friction = Vector::Constant(1, 0.2);
  facts.encoder_step = Vector::Constant(1, 20e-6);
  facts.actuator_step = Vector::Zero(1);
  facts.force_N_max = 8;
  facts.hold_s_max = 3e-3;
  facts.latency_s = 400e-6;
  hidden.description.inertia = Matrix::Constant(1, 1, 0.15);
  return hidden;
}

Findings found(const HiddenDevice& hidden, device::HapticDevice& device, const GuideSettings& settings = {},
               const KnownMass& known = {}) {
  const control::DeviceFacts declared = declared_facts(hidden);
  Guide guide(declared, settings);
  run_in_virtual_time(guide, device, declared.period_s, settings.seed, 600);
  EXPECT_TRUE(guide.done()) << guide.doing();
  return evaluate(guide, declared, kConfidence, known);
}

std::string all(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + '\n';
  return text;
}

class HiddenDevices : public testing::TestWithParam<std::uint64_t> {};

TEST_P(HiddenDevices, HaveNoBoundAboveTheTruthAndNoneFarBelow) {
  const HiddenDevice hidden = draw_hidden_device(GetParam());
  const control::DeviceFacts& truth = hidden.description.facts;
  SCOPED_TRACE(testing::Message() << "seed " << GetParam() << ": " << describe(hidden.description));
  const auto device = without_hand(hidden.description, hidden.flaws);
  const Findings findings = found(hidden, *device, {}, known_mass(hidden));
  ASSERT_TRUE(findings.complete()) << all(findings.refusals(truth.cartesian));
  const control::DeviceFacts facts = facts_of(findings, declared_facts(hidden));
  EXPECT_LE(1 + facts.uncertainty.torque_gain_share.least, device->motor_gain().minCoeff());
  EXPECT_GE(1 + facts.uncertainty.torque_gain_share.most, device->motor_gain().maxCoeff());
  EXPECT_GE(facts.uncertainty.torque_gain_share.least, -0.1);
  EXPECT_LE(facts.uncertainty.torque_gain_share.most, 0.1);
  for (Eigen::Index i = 0; i < truth.damping.rows(); ++i) {
    const double gain = device->motor_gain()[i];
    EXPECT_LE(gain * facts.damping(i, i), truth.damping(i, i));
    EXPECT_GE(gain * facts.damping(i, i), 0.75 * truth.damping(i, i));
    EXPECT_LE(gain * facts.friction[i], truth.friction[i]);
    EXPECT_GE(gain * facts.friction[i], 0.75 * truth.friction[i]);
    EXPECT_NEAR(facts.encoder_step[i] / truth.encoder_step[i], 1, 1e-9);
  }
  EXPECT_GE(facts.latency_s, truth.latency_s);
  EXPECT_LE(facts.latency_s, truth.latency_s + 100e-6);
  EXPECT_LE(facts.latency_s + facts.uncertainty.latency_s.least, truth.latency_s);
  EXPECT_EQ(facts.releases, truth.releases);
  if (truth.releases) {
    EXPECT_GE(facts.hold_s_max, truth.hold_s_max);
    EXPECT_LE(facts.hold_s_max + facts.uncertainty.hold_s.least, truth.hold_s_max);
  }
}

// 1: arm with friction. 4: three light axes, much damping. 12: arm without friction. 19: three heavy axes.
INSTANTIATE_TEST_SUITE_P(Seeds, HiddenDevices, testing::Values(1, 4, 12, 19), testing::PrintToStringParamName());

TEST(Identification, WritesAFileOfFactsThatLoadsAsWhatWasFound) {
  const HiddenDevice hidden = plain_device();
  const control::DeviceFacts declared = declared_facts(hidden);
  const auto device = without_hand(hidden.description);
  const Findings findings = found(hidden, *device);
  ASSERT_TRUE(findings.complete()) << all(findings.refusals(true));
  const std::string text = facts_text(findings, declared, kConfidence);
  SCOPED_TRACE(text);
  const control::DeviceFacts loaded = device::parse_facts(text, "plain.toml").facts;
  const control::DeviceFacts facts = facts_of(findings, declared);
  EXPECT_LE(loaded.damping(0, 0), facts.damping(0, 0));
  EXPECT_NEAR(loaded.damping(0, 0), facts.damping(0, 0), 1e-4 * facts.damping(0, 0));
  EXPECT_LE(loaded.friction[0], facts.friction[0]);
  EXPECT_EQ(loaded.encoder_step[0], facts.encoder_step[0]);
  EXPECT_EQ(loaded.latency_s, facts.latency_s);
  EXPECT_EQ(loaded.hold_s_max, facts.hold_s_max);
  EXPECT_EQ(loaded.uncertainty.latency_s, facts.uncertainty.latency_s);
  EXPECT_EQ(loaded.uncertainty.hold_s, facts.uncertainty.hold_s);
}

/// Two equal axes, of which only the motors differ.
HiddenDevice two_axes() {
  HiddenDevice hidden = plain_device();
  control::DeviceFacts& facts = hidden.description.facts;
  facts.damping = 2 * Matrix::Identity(2, 2);
  facts.friction = Vector::Constant(2, 0.2);
  facts.encoder_step = Vector::Constant(2, 20e-6);
  facts.actuator_step = Vector::Zero(2);
  hidden.description.inertia = 0.15 * Matrix::Identity(2, 2);
  hidden.flaws = {.seed = 3, .torque_gain_share = {-0.1, 0.1}};
  return hidden;
}

TEST(Identification, TellsMotorsApartByAKnownMass) {
  const HiddenDevice hidden = two_axes();
  const auto device = without_hand(hidden.description, hidden.flaws);
  const Findings findings = found(hidden, *device, {}, {.of_joints = {0.15, 0.15}, .share = 0.005});
  ASSERT_TRUE(findings.complete()) << all(findings.refusals(true));
  const std::string text = facts_text(findings, declared_facts(hidden), kConfidence);
  SCOPED_TRACE(text);
  const control::DeviceFacts loaded = device::parse_facts(text, "two.toml").facts;
  for (Eigen::Index i = 0; i < 2; ++i) {
    const control::Bracket& share = findings.joints[static_cast<std::size_t>(i)].gain_share;
    EXPECT_LE(1 + share.least, device->motor_gain()[i]);
    EXPECT_GE(1 + share.most, device->motor_gain()[i]);
    EXPECT_LE(share.most - share.least, 0.1);
    EXPECT_LE(device->motor_gain()[i] * loaded.damping(i, i), 2);
    EXPECT_LE(device->motor_gain()[i] * loaded.friction[i], 0.2);
    EXPECT_TRUE(loaded.uncertainty.losses_with_gain);
    EXPECT_LE(loaded.uncertainty.torque_gain_share.least, share.least);
    EXPECT_GE(loaded.uncertainty.torque_gain_share.most, share.most);
  }
}

// Found are damping and friction as the motors' commands see them: motors that make less make both seem more.
TEST(Identification, TellsLossesAsTheCommandsSeeThemWithTheGainThatTheDriverTells) {
  const HiddenDevice hidden = two_axes();
  const auto device = without_hand(hidden.description, hidden.flaws);
  const Findings findings = found(hidden, *device);
  ASSERT_TRUE(findings.complete()) << all(findings.refusals(true));
  const control::DeviceFacts facts = facts_of(findings, declared_facts(hidden));
  EXPECT_EQ(facts.uncertainty.torque_gain_share, (control::Bracket{-0.1, 0.1}));
  EXPECT_TRUE(facts.uncertainty.losses_with_gain);
  for (Eigen::Index i = 0; i < 2; ++i) {
    const double as_commanded = 2 / device->motor_gain()[i];
    EXPECT_LE(facts.damping(i, i), as_commanded);
    EXPECT_GE(facts.damping(i, i), 0.9 * as_commanded);
    EXPECT_LE(facts.friction[i], 0.1 * as_commanded);
  }
}

TEST(Identification, LetsTheGainOfASingleMotorBe) {
  const HiddenDevice hidden = plain_device();
  const auto device = without_hand(hidden.description, {.torque_gain_share = {0.1, 0.1}});
  const Findings findings = found(hidden, *device, {}, {.of_joints = {0.15}, .share = 0.01});
  ASSERT_TRUE(findings.complete()) << all(findings.refusals(true));
  const control::DeviceFacts facts = facts_of(findings, declared_facts(hidden));
  EXPECT_EQ(facts.uncertainty.torque_gain_share, control::Bracket{});
  EXPECT_LE(facts.damping(0, 0), 2 / 1.1);
  EXPECT_GE(facts.damping(0, 0), 0.9 * 2 / 1.1);
  EXPECT_LE(1 + findings.joints[0].gain_share.least, 1.1);
  EXPECT_GE(1 + findings.joints[0].gain_share.most, 1.1);
}

TEST(Identification, RefusesAKnownMassThatIsNotTheJoints) {
  const HiddenDevice hidden = plain_device();
  const auto device = without_hand(hidden.description);
  const Findings findings = found(hidden, *device, {}, {.of_joints = {1.5}, .share = 0.01});
  EXPECT_FALSE(findings.complete());
  EXPECT_NE(all(findings.refusals(true))
                .find("damping of axis 1: it moves like 0.15, the known mass is 1.5: its motor would make 10 times "
                      "what is commanded; 0.9 to 1.1 would be accepted"),
            std::string::npos)
      << all(findings.refusals(true));
}

TEST(Identification, AsksForNoMoreThanItsShareOfTheForce) {
  const HiddenDevice hidden = draw_hidden_device(1);
  const auto device = without_hand(hidden.description);
  FaultyDevice watched(*device);
  (void)found(hidden, watched, {.force_share = 0.2});
  EXPECT_GT(watched.largest_N(), 0.1 * hidden.description.facts.force_N_max);
  EXPECT_LE(watched.largest_N(), 0.2 * hidden.description.facts.force_N_max * (1 + 1e-12));
}

TEST(Identification, LetsEveryForceGrowInARamp) {
  const HiddenDevice hidden = plain_device();
  const auto device = without_hand(hidden.description);
  GrowthDevice watched(*device);
  (void)found(hidden, watched);
  // To 90 % of 30 % of the device's largest force in 30 ms.
  EXPECT_LE(watched.fastest_N(), 0.9 * 0.3 * 8 / 30 * (1 + 1e-9));
  EXPECT_GT(watched.fastest_N(), 0);
}

TEST(Identification, EndsWithZeroForceOnAButton) {
  const HiddenDevice hidden = plain_device();
  const auto device = without_hand(hidden.description);
  ButtonDevice pressed(*device, 5000, true);
  Guide guide(declared_facts(hidden), {});
  run_in_virtual_time(guide, pressed, 1e-3, 1, 600);
  EXPECT_TRUE(guide.done());
  EXPECT_TRUE(guide.stopped_by_button());
  EXPECT_EQ(guide.trouble(), "button 1 of the device was pressed");
  EXPECT_EQ(guide.readings().ticks, 5001U);
  EXPECT_EQ(pressed.last_N(), 0);
}

TEST(Identification, TakesAButtonThatIsNeverReleasedForStuck) {
  const HiddenDevice hidden = plain_device();
  const auto device = without_hand(hidden.description);
  ButtonDevice stuck(*device, 1'000'000'000, true);
  const Findings findings = found(hidden, stuck);
  EXPECT_TRUE(findings.complete()) << all(findings.refusals(true));
}

TEST(Identification, EndsNearbyWhereTheMotorsPushTheWrongWay) {
  const HiddenDevice hidden = plain_device();
  const auto device = without_hand(hidden.description);
  InvertedDevice inverted(*device);
  const Findings findings = found(hidden, inverted);
  EXPECT_FALSE(findings.trouble.empty());
  EXPECT_EQ(inverted.last_N(), 0);
  EXPECT_LE(inverted.farthest_m(), 0.12);
}

TEST(Identification, RepeatsSlidesInWhichATickWasSoLateThatTheDeviceLetGo) {
  HiddenDevice hidden = plain_device();
  hidden.description.facts.hold_s_max = 1.2e-3;
  const control::DeviceFacts& truth = hidden.description.facts;
  const control::DeviceFacts declared = declared_facts(hidden);
  const auto device = without_hand(hidden.description);
  Guide guide(declared, {});
  device->start();
  time::Nanoseconds now = std::chrono::seconds(1);
  constexpr int kTicksBetween = 997;
  constexpr int kTicksMost = 600'000;
  for (int tick = 1; tick < kTicksMost && !guide.done(); ++tick) {
    now += std::chrono::microseconds(tick % kTicksBetween == 0 ? 5000 : 1000);
    const device::Reading reading = device->read(now);
    if (const auto force = guide.tick(reading, time::to_seconds(now))) device->apply(now, *force);
    if (const auto work = guide.take_work()) work();
  }
  const Findings findings = evaluate(guide, declared, kConfidence);
  ASSERT_TRUE(findings.complete()) << all(findings.refusals(true));
  EXPECT_GT(findings.readings.late_slides, 3U);
  EXPECT_LE(findings.joints[0].balance.damping.bound, truth.damping(0, 0));
  EXPECT_GE(findings.joints[0].balance.damping.bound, 0.7 * truth.damping(0, 0));
  EXPECT_LE(findings.joints[0].balance.friction.bound, truth.friction[0]);
  EXPECT_GE(findings.latency.most_s, truth.latency_s);
  EXPECT_LE(findings.latency.least_s, truth.latency_s);
}

TEST(Identification, RefusesADeviceThatDoesNotMove) {
  const HiddenDevice hidden = plain_device();
  const auto device = without_hand(hidden.description);
  StuckDevice stuck(*device);
  const Findings findings = found(hidden, stuck);
  EXPECT_FALSE(findings.complete());
  EXPECT_NE(findings.joints[0].balance.damping.refused.find("did not move under 2.16 N"), std::string::npos)
      << all(findings.refusals(true));
  EXPECT_LE(stuck.largest_N(), 0.3 * 8 * (1 + 1e-12));
  const std::string text = facts_text(findings, declared_facts(hidden), kConfidence);
  EXPECT_THROW((void)device::parse_facts(text, "stuck.toml"), std::runtime_error) << text;
}

TEST(Identification, RefusesADeviceUnpluggedMidway) {
  const HiddenDevice hidden = plain_device();
  const auto device = without_hand(hidden.description);
  UnpluggedDevice unplugged(*device, 9000);
  const Findings findings = found(hidden, unplugged);
  EXPECT_FALSE(findings.complete());
  EXPECT_NE(findings.trouble.find("unplugged"), std::string::npos) << findings.trouble;
  EXPECT_EQ(unplugged.force_after_N(), 0);
}

TEST(Identification, RefusesADeviceInAHand) {
  const HiddenDevice hidden = plain_device();
  // A hand that rests, with the stiffness of a light grip.
  device::SimulatedDevice device(
      hidden.description,
      device::make_operator("press:from_m=0,to_m=0,mass_kg=0.1,stiffness_N_per_m=60,damping_N_s_per_m=2", 1));
  const Findings findings = found(hidden, device);
  EXPECT_FALSE(findings.complete()) << findings_text(findings, declared_facts(hidden));
}

TEST(Identification, TellsHowMuchOfTheLargestPushArrived) {
  const HiddenDevice hidden = plain_device();
  const auto device = without_hand(hidden.description);
  const Findings findings = found(hidden, *device);
  const UsableForce& force = findings.joints[0].balance.force;
  EXPECT_TRUE(force.told()) << force.share << " +- " << force.share_error;
  EXPECT_FALSE(force.falls_short());
  EXPECT_NEAR(force.share, 1, force.share_error + UsableForce::kSlack);
}

TEST(Identification, RefusesMotorsThatGiveLessThanCommanded) {
  const HiddenDevice hidden = plain_device();
  const auto device = without_hand(hidden.description);
  SaturatedDevice saturated(*device, 0.9);
  const Findings findings = found(hidden, saturated);
  EXPECT_TRUE(findings.joints[0].balance.force.falls_short()) << findings.joints[0].balance.force.share;
  EXPECT_NE(findings.joints[0].balance.damping.refused.find("gave only"), std::string::npos)
      << all(findings.refusals(true));
  for (const LowerBound* const bound : {&findings.joints[0].balance.damping, &findings.joints[0].balance.friction}) {
    const double truth = bound == &findings.joints[0].balance.damping ? 2 : 0.2;
    EXPECT_TRUE(!bound->refused.empty() || bound->bound <= truth) << bound->bound << " > " << truth << '\n'
                                                                  << findings_text(findings, declared_facts(hidden));
  }
}

}  // namespace
}  // namespace forcebound::lab::identification
