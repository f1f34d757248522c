#include "forcebound/server/dynamics/bodies/apparent_mass.hpp"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>

#include "forcebound/server/dynamics/bodies/body_dynamic_model.hpp"

namespace forcebound::server {
namespace {

struct Apparent {
  ModelPointer model;
  DataPointer data;

  explicit Apparent(const std::string& bodies)
      : model(compile_mjcf("<mujoco><option gravity='0 0 0'/><worldbody>" + bodies + "</worldbody></mujoco>", "a.xml")),
        data(make_data(*model)) {}

  double mass_kg(const std::vector<std::string>& names) {
    std::vector<int> bodies;
    bodies.reserve(names.size());
    for (const std::string& name : names) bodies.push_back(mj_name2id(model.get(), mjOBJ_BODY, name.c_str()));
    return apparent_mass_kg(*model, *data, bodies);
  }
};

TEST(ApparentMass, OfAFreeBodyIsItsMass) {
  Apparent free("<body name='b'><freejoint/><inertial pos='0.1 0.2 0.3' mass='0.7' diaginertia='1 2 2.5'/></body>");
  EXPECT_NEAR(free.mass_kg({"b"}), 0.7, 1e-12);
}

TEST(ApparentMass, OfAHingedBodyGrowsAsItsCenterOfMassNearsTheHinge) {
  // (I + m r^2) / r^2 across, infinite along the arm and the axis.
  for (const double arm_m : {0.2, 0.1, 0.01}) {
    Apparent hinged("<body name='b'><joint axis='0 0 1'/><inertial pos='" + std::to_string(arm_m) +
                    " 0 0' mass='0.1' diaginertia='0.001 0.001 0.001'/></body>");
    EXPECT_NEAR(hinged.mass_kg({"b"}), 0.1 + 0.001 / (arm_m * arm_m), 1e-9) << arm_m;
  }
}

TEST(ApparentMass, OfWhatCannotBeMovedIsInfinite) {
  Apparent about_itself("<body name='b'><joint axis='1 2 3'/><geom size='0.1'/></body>");
  EXPECT_TRUE(std::isinf(about_itself.mass_kg({"b"})));
  Apparent fixed("<body name='b'><geom size='0.1'/></body><body><freejoint/><geom size='0.1'/></body>");
  EXPECT_TRUE(std::isinf(fixed.mass_kg({"b"})));
}

// Ten kilograms that slide on a root of ten grams.
constexpr const char* kLightRoot = R"(<body name="root"><joint type="slide" axis="1 0 0"/>
    <geom size="0.01" mass="0.01"/><body name="child"><joint type="slide" axis="1 0 0"/><geom size="0.01" mass="10"/>
  </body></body>)";

TEST(ApparentMass, OfALightRootDoesNotCountWhatSlidesOnIt) {
  EXPECT_NEAR(Apparent(kLightRoot).mass_kg({"root"}), 0.01, 1e-9);
}

TEST(ApparentMass, OfALightLinkOnAHeavyBaseCountsHowItTurns) {
  // Two grams whose inertia, about a hinge one centimetre aside, is that of ten grams.
  Apparent link(R"(<body name="base"><freejoint/><inertial pos="0 0 0" mass="100" diaginertia="100 100 100"/>
      <body name="link"><joint axis="0 0 1"/><inertial pos="0.01 0 0" mass="0.002" diaginertia="8e-7 8e-7 8e-7"/>
    </body></body>)");
  EXPECT_NEAR(link.mass_kg({"link"}), 0.01, 1e-5);
}

TEST(ApparentMass, OfTwoBodiesOnOneJointIsHalfForEach) {
  Apparent rigid(R"(<body name="one"><joint type="slide" axis="1 0 0"/><geom size="0.01" mass="1"/>
      <body name="other" pos="0.1 0 0"><geom size="0.01" mass="1"/></body></body>)");
  EXPECT_NEAR(rigid.mass_kg({"one"}), 2, 1e-9);
  EXPECT_NEAR(rigid.mass_kg({"one", "other"}), 1, 1e-9) << "two couplings at once are as one twice as stiff";
}

TEST(BodyDynamicModel, JudgesTheCouplingByTheApparentMass) {
  const auto refusal = [](const std::string& bodies, const std::string& probe,
                          double stiffness_N_per_m) -> std::string {
    try {
      const BodyDynamicModel dynamic_model(
          compile_mjcf("<mujoco><option timestep='0.001'/><worldbody>" + bodies + "</worldbody></mujoco>", "a.xml"),
          {probe}, {.stiffness_N_per_m = stiffness_N_per_m, .damping_N_s_per_m = 0}, "a.xml");
    } catch (const BodiesError& error) {
      return error.what();
    }
    return "accepted";
  };
  // 4 m / h^2 of ten grams is 40 kN/m.
  EXPECT_EQ(refusal(kLightRoot, "root", 39e3), "accepted");
  EXPECT_EQ(refusal(kLightRoot, "root", 41e3),
            "a.xml: the probe's coupling of 41000 N/m and 0 N s/m is unstable with an apparent mass of 0.01 kg in "
            "steps of 0.001 "
            "s (1.03 of what is stable): use a softer one, a heavier probe or shorter steps");
}

}  // namespace
}  // namespace forcebound::server
