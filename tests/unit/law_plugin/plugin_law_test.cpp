#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>

#include "forcebound/control/force_bounder.hpp"
#include "forcebound/control/less_conservative_law.hpp"
#include "forcebound/law_plugin/known_laws.hpp"
#include "forcebound/law_plugin/plugin_law.hpp"
#include "forcebound/text/file.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/tools/temporary_folder.hpp"

namespace forcebound::law_plugin {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;
using testing::ThrowsMessage;

constexpr double kPeriod_s = 1e-3;

std::string file_of(const std::string& name) {
  return std::string(FORCEBOUND_TEST_LAWS) + "/forcebound-law-" + name + ".so";
}

/// The laws, once this one of them is loaded.
control::LawRegistry laws_with(const std::string& law) {
  (void)law_named(file_of(law));
  return known_laws();
}

control::DeviceFacts facts_of(int axes) {
  control::DeviceFacts facts;
  facts.name = "rails";
  facts.damping = 5 * control::Matrix::Identity(axes, axes);
  facts.friction = facts.encoder_step = facts.actuator_step = Vector::Zero(axes);
  facts.force_N_max = 8;
  return facts;
}

/// A law on a device that is moved by hand.
class Loop {
 public:
  explicit Loop(const std::string& law, int axes = 1)
      : facts_(facts_of(axes)),
        damping_(control::Damping::from_matrix(facts_.damping)),
        bounder_(facts_, laws_with(law).make(law, facts_)) {
    motion_.position = motion_.joint = Vector::Zero(axes);
    motion_.jacobian = control::Matrix::Identity(axes, axes);
    motion_.damping = &damping_;
    motion_.latency_s_max = 1e-4;
  }

  Vector tick(double moved_m, const Vector& request_N) {
    motion_.position.array() += moved_m;
    motion_.joint = motion_.position;
    const Vector force = bounder_.tick(motion_, request_N);
    motion_.interval_s = kPeriod_s;
    return force;
  }

  [[nodiscard]] control::ForceBounder& bounder() { return bounder_; }
  [[nodiscard]] const control::ForceBounder::Counts& counts() const { return bounder_.counts(); }

 private:
  control::DeviceFacts facts_;
  control::Damping damping_;
  control::ForceBounder bounder_;
  control::Motion motion_;
};

TEST(PluginLaw, AgreesWithTheLawOfThePaperThatItWritesInC) {
  Loop plugin("saver", 2);
  const control::DeviceFacts facts = facts_of(2);
  const auto damping = control::Damping::from_matrix(facts.damping);
  control::ForceBounder own(facts, std::make_unique<control::LessConservativeLaw>(2, kPeriod_s));
  control::Motion motion;
  motion.position = motion.joint = Vector::Zero(2);
  motion.jacobian = control::Matrix::Identity(2, 2);
  motion.damping = &damping;
  double largest_N = 0;
  for (int n = 0; n < 500; ++n) {
    const double moved_m = 2e-5 * std::sin(0.1 * n);
    const Vector request = Vector{{3 * std::sin(0.07 * n), -5 * std::cos(0.03 * n)}};
    motion.position.array() += moved_m;
    motion.joint = motion.position;
    const Vector expected = own.tick(motion, request);
    motion.interval_s = kPeriod_s;
    EXPECT_TRUE(plugin.tick(moved_m, request).isApprox(expected, 1e-9) || expected.norm() < 1e-9) << n;
    EXPECT_NEAR(plugin.bounder().law().energy_J(), own.law().energy_J(), 1e-12) << n;
    largest_N = std::max(largest_N, expected.norm());
  }
  EXPECT_GT(largest_N, 1);
}

TEST(PluginLaw, TicksWithoutAllocating) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  Loop loop("saver", 3);
  const Vector request = Vector::Constant(3, -2);
  (void)loop.tick(0, request);
  const test::AllocationGuard guard;
  for (int n = 0; n < 100; ++n) (void)loop.tick(1e-5, request);
  EXPECT_EQ(guard.heap_operations(), 0U);
}

TEST(PluginLaw, IsZeroForceAndCountedWhereItIsFaulty) {
  const Vector request = Vector::Constant(1, -2);
  Loop not_finite("not-finite");
  EXPECT_EQ(not_finite.tick(0, request)[0], -2);
  EXPECT_EQ(not_finite.tick(0, request)[0], 0);
  EXPECT_EQ(not_finite.counts().forces_not_finite, 1U);
  Loop failing("failing");
  EXPECT_EQ(failing.tick(0, request)[0], 0);
  EXPECT_EQ(failing.counts().forces_not_finite, 1U);
  Loop throwing("throwing");
  EXPECT_EQ(throwing.tick(0, request)[0], -2);
  EXPECT_EQ(throwing.tick(0, request)[0], 0);
  EXPECT_EQ(throwing.tick(0, request)[0], -2);
  EXPECT_EQ(throwing.counts().forces_not_finite, 1U);
}

TEST(PluginLaw, IsZeroForceAndCountedWhereItsForceIsLaterThanItWasTold) {
  Loop loop("longer");
  const Vector force = loop.tick(0, Vector::Constant(1, -2));
  EXPECT_EQ(loop.bounder().confirmed(force, 1e-4)[0], -2);
  EXPECT_EQ(loop.bounder().confirmed(force, 1.1e-4)[0], 0);
  EXPECT_EQ(loop.counts().withdrawn, 1U);
}

TEST(PluginLaw, HasOneLineForADeviceThatItRefuses) {
  const auto refusal = [](const std::string& law, int axes) { return laws_with(law).refusal(law, facts_of(axes)); };
  EXPECT_EQ(refusal("refusing", 1), "law 'refusing': no device is good enough");
  EXPECT_EQ(refusal("throwing", 3), "law 'throwing': three axes are too many");
  EXPECT_EQ(refusal("throwing", 2), "");
  control::DeviceFacts arm = facts_of(2);
  arm.cartesian = false;
  EXPECT_EQ(laws_with("saver").refusal("saver", arm), "law 'saver': 'rails' is not Cartesian");
  EXPECT_THAT(known_laws().refusal("saver", facts_of(1), {.parameters = {{"share", 2}}}),
              HasSubstr("share must be 0.01 to 1, got 2"));
}

TEST(LawNamed, LoadsALawOnceAndNamesItAsItCallsItself) {
  EXPECT_EQ(law_named(file_of("saver")), "saver");
  EXPECT_EQ(law_named(file_of("saver")), "saver");
  EXPECT_EQ(law_named("saver"), "saver");
  EXPECT_EQ(law_named("fba-exact"), "fba-exact");
  EXPECT_THAT(known_laws().names(), Contains("saver").Times(1));
  EXPECT_THAT(known_laws().help("saver"), AllOf(HasSubstr("spends a share"), HasSubstr("share")));
  EXPECT_EQ(known_laws().parameters("saver", facts_of(1)).at("share"), 1);
}

TEST(LawNamed, FindsALawByItsNameInTheFoldersOfTheVariable) {
  ::setenv("FORCEBOUND_LAW_PATH", ("/nonexistent:" + std::string(FORCEBOUND_TEST_LAWS)).c_str(), 1);
  EXPECT_EQ(law_named("longer"), "longer");
  ::unsetenv("FORCEBOUND_LAW_PATH");
}

TEST(LawNamed, SaysInOneLineWhatIsWrong) {
  const auto refused = [](const std::string& asked, const std::string& why) {
    EXPECT_THAT([&] { (void)law_named(asked); },
                ThrowsMessage<std::invalid_argument>(AllOf(HasSubstr(asked), HasSubstr(why), Not(HasSubstr("\n")))));
  };
  refused("fba-exat", "unknown law 'fba-exat', did you mean 'fba-exact'? (known: none,");
  refused("/nonexistent/law.so", "cannot be loaded: there is no such file");
  refused(file_of("empty"), "is no law: it lacks the function 'forcebound_law_entry' of forcebound_law.h");
  refused(file_of("newer"), "has interface 99, this program has 1: build it with this program's forcebound_law.h");
  refused(file_of("mute"), "lacks the function 'tick'; forcebound_law.h names all");
  refused(file_of("shorter"), "lacks the function 'destroy'");
  refused(file_of("shipped"), "calls itself 'fba-less', as one that ships; give it another name");
  refused(file_of("shouting"), "its name must be of small letters, digits and '-', got 'My Law'");
  refused(file_of("unlikely"), "its parameter 'gain' must be standard from least to most, got 7 from 0 to 2");
  (void)law_named(file_of("refusing"));
  refused(file_of("twin"), "calls itself 'refusing', as " + file_of("refusing") + " does");
}

TEST(LawNamed, SaysInOneLineWhatAFileIsNot) {
  const test::TemporaryFolder folder;
  const auto refused = [&](const std::string& content, const std::string& why) {
    text::write_file(folder.file("law.so"), content);
    EXPECT_THAT([&] { (void)law_named(folder.file("law.so")); },
                ThrowsMessage<std::invalid_argument>("law " + folder.file("law.so") + ": cannot be loaded: " + why));
  };
  refused("", "it is no shared library");
  refused("[law]\nname = \"mine\"\n", "it is no shared library");
  // As one built for a processor of 183, AArch64, or 243, RISC-V; both on one of neither.
  const std::string own = text::read_file(file_of("saver"));
  for (const auto& [machine, name] : {std::pair('\xb7', "AArch64"), std::pair('\xf3', "RISC-V")}) {
    if (own[18] == machine) continue;
    std::string other = own;
    other[18] = machine;
    other[19] = 0;
    text::write_file(folder.file("other.so"), other);
    EXPECT_THAT([&] { (void)law_named(folder.file("other.so")); },
                ThrowsMessage<std::invalid_argument>(
                    AllOf(HasSubstr("cannot be loaded: it is for " + std::string(name) + ", this program for "),
                          Not(HasSubstr("\n")))));
  }
  text::write_file(folder.file("cut.so"), own.substr(0, 200));
  EXPECT_THAT([&] { (void)law_named(folder.file("cut.so")); },
              ThrowsMessage<std::invalid_argument>(AllOf(HasSubstr("cannot be loaded: "), Not(HasSubstr("\n")))));
  std::filesystem::copy_file(file_of("saver"), folder.file("open.so"));
  std::filesystem::permissions(folder.file("open.so"), std::filesystem::perms::others_write,
                               std::filesystem::perm_options::add);
  EXPECT_THAT([&] { (void)law_named(folder.file("open.so")); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("open.so")));
}

}  // namespace
}  // namespace forcebound::law_plugin
