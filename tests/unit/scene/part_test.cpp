#include "forcebound/scene/part.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace forcebound::scene {
namespace {

using testing::HasSubstr;

const Registry& registry() {
  static const Registry kRegistry = Registry::standard();
  return kRegistry;
}

PartDescription ball() {
  return {
      .name = "ball",
      .shape = NamedValues{"sphere", {{"center_m", Point(0.1, 0, 0)}, {"radius_m", 0.02}}},
      .effects = {{"surface", {{"stiffness_N_per_m", 500.0}}}, {"magnet", {{"force_N_max", 1.0}, {"range_m", 0.01}}}}};
}

std::string refusal_of(const PartDescription& description, Eigen::Index axes = 3) {
  try {
    (void)make_part(description, registry(), axes);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "accepted";
}

TEST(MakePart, MakesWhatIsDescribed) {
  const SceneObject part = make_part(ball(), registry());
  EXPECT_EQ(part.name, "ball");
  EXPECT_EQ(part.shape_text, "sphere, center_m [0.1, 0, 0], radius_m 0.02");
  ASSERT_EQ(part.effects.size(), 2U);
  EXPECT_EQ(part.effects[0].parameters, "stiffness_N_per_m 500");
  std::vector<std::byte> state(part.shape->facts().state_bytes);
  EXPECT_NEAR(part.shape->nearest({0.1, 0, 0.01}, state.data()).penetration_m, 0.01, 1e-15);
}

TEST(MakePart, IsDescribedByWhatItWasMadeOf) {
  EXPECT_EQ(describe(make_part(ball(), registry())), ball());
  const PartDescription field{.name = "honey", .effects = {{"viscosity", {{"damping_N_s_per_m", 2.0}}}}};
  EXPECT_EQ(describe(make_part(field, registry())), field);
}

TEST(MakePart, ChecksWhatAFileWouldBeCheckedFor) {
  PartDescription wrong = ball();
  wrong.shape->name = "bal";
  EXPECT_THAT(refusal_of(wrong), HasSubstr("unknown kind 'bal'"));
  wrong = ball();
  wrong.shape->values.set("radius_m", -1.0);
  EXPECT_EQ(refusal_of(wrong), "radius_m must be > 0 and <= 1000, got -1");
  wrong = ball();
  wrong.effects[0].values.set("stiffness_N_per_m", std::nan(""));
  EXPECT_EQ(refusal_of(wrong), "stiffness_N_per_m must be a finite number, got nan");
  wrong = ball();
  wrong.effects.push_back(wrong.effects[0]);
  EXPECT_EQ(refusal_of(wrong), "effect 'surface' is asked for twice");
  wrong = ball();
  wrong.shape.reset();
  EXPECT_THAT(refusal_of(wrong), HasSubstr("effect 'surface' needs the surface of an object"));
  wrong = ball();
  wrong.effects = {{"friction", {{"static_coefficient", 0.5}}}};
  EXPECT_THAT(refusal_of(wrong), HasSubstr("effect 'friction' needs another one that pushes"));
  wrong = ball();
  wrong.shape = NamedValues{"torus", {}};
  EXPECT_THAT(refusal_of(wrong, 2), HasSubstr("a torus needs a scene of at least 3 degrees of freedom"));
  wrong.shape = NamedValues{"mesh", {{"file", std::string("nowhere.obj")}}};
  EXPECT_THAT(refusal_of(wrong), HasSubstr("nowhere.obj"));
}

}  // namespace
}  // namespace forcebound::scene
