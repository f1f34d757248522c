#include "tests/tools/lab/rendering/rendering_tasks.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <numbers>
#include <utility>

#include "forcebound/device/load_device.hpp"
#include "forcebound/scene/geometry/height_field.hpp"
#include "forcebound/scene/geometry/triangle_mesh.hpp"
#include "forcebound/scene/part.hpp"
#include "forcebound/server/environment/body_models.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "forcebound/text/numbers.hpp"
#include "tests/tools/lab/accuracy/harmonic_hand.hpp"
#include "tests/tools/lab/rendering/body_tasks.hpp"
#include "tests/tools/sim/dragged_puck.hpp"
#include "tests/tools/sim/firm_device.hpp"

namespace forcebound::lab {
namespace {

using scene::Point;

constexpr double kWait_s = 2;
// By then a coarse level is to have arrived.
constexpr double kCoarseLevelHere_s = 1;

constexpr const char* kLightDevice = R"(
kind = "cartesian"
degrees_of_freedom = 3
mass_kg = 0.1
damping_N_s_per_m = 1
encoder_step_m = 20e-6
force_N_max = 10
latency_s = 50e-6
)";

constexpr double kFirmStiffness_N_per_m = 10e3;
constexpr double kLightStiffness_N_per_m = 1e3;

/// Stays where it begins for a while, and then does what another hand does.
class LateHand final : public device::Operator {
 public:
  explicit LateHand(std::unique_ptr<const device::Operator> hand) : hand_(std::move(hand)) {}

  std::string_view name() const noexcept override { return hand_->name(); }
  const device::Hand& hand() const noexcept override { return hand_->hand(); }
  int degrees_of_freedom() const noexcept override { return hand_->degrees_of_freedom(); }
  std::string description() const override { return hand_->description(); }
  Target target(double time_s) const noexcept override { return hand_->target(std::max(0.0, time_s - kWait_s)); }

 private:
  std::unique_ptr<const device::Operator> hand_;
};

constexpr int kAxes = 3;

std::function<std::unique_ptr<const device::Operator>()> hand(const HarmonicMotion& motion) {
  return [motion] { return std::make_unique<LateHand>(make_harmonic_hand(motion, kAxes)); };
}

std::function<std::unique_ptr<const device::Operator>()> hand_at_once(const HarmonicMotion& motion) {
  return [motion] { return make_harmonic_hand(motion, kAxes); };
}

HarmonicMotion press(const Point& on_surface_m) {
  return {.kind = HarmonicMotion::Kind::press, .on_surface_m = on_surface_m};
}

/// To and fro over 30 mm, at a speed in the middle.
HarmonicMotion slide(const Point& on_surface_m, double speed_m_per_s = 0.1) {
  HarmonicMotion motion{.kind = HarmonicMotion::Kind::slide, .on_surface_m = on_surface_m};
  motion.frequency_Hz = speed_m_per_s / (std::numbers::pi * motion.length_m);
  return motion;
}

/// Of one object with a surface. @param geometry in place of what the shape's values name
std::shared_ptr<const scene::Scene> scene_with(scene::NamedValues shape, double stiffness_N_per_m,
                                               const scene::ShapeGeometry& geometry = {}) {
  const scene::PartDescription object{.name = "object",
                                      .shape = std::move(shape),
                                      .effects = {{"surface", {{"stiffness_N_per_m", stiffness_N_per_m}}}}};
  scene::SceneParts parts;
  parts.objects.push_back(scene::make_part(object, scene::Registry::standard(), 3, {}, geometry));
  return std::make_shared<const scene::Scene>(scene::SceneFacts{.name = "scene", .description = ""}, std::move(parts));
}

/// @param shape as in a scene file
std::shared_ptr<const scene::Scene> parsed(const std::string& shape, const std::string& more_effects = "",
                                           const std::string& tables = "") {
  return server::parse_scene(
      "[scene]\nname = 'scene'\ndescription = ''\ndegrees_of_freedom = 3\n[[object]]\n"
      "name = 'object'\nshape = " +
          shape + "\neffects = ['surface'" + more_effects +
          "]\n[object.surface]\nstiffness_N_per_m = " + text::to_text(kFirmStiffness_N_per_m) + "\n" + tables,
      "scene.toml");
}

/// A ball of 30 mm with bumps of 0.3 mm.
std::shared_ptr<const scene::TriangleMesh> bumpy_ball(std::uint32_t around, std::uint32_t down) {
  constexpr double kRadius_m = 0.03;
  constexpr double kBump_m = 3e-4;
  constexpr double kBumps = 12;
  std::vector<Point> vertices{Point(0, 0, kRadius_m)};
  for (std::uint32_t row = 1; row < down; ++row) {
    for (std::uint32_t column = 0; column < around; ++column) {
      const double polar = std::numbers::pi * row / down;
      const double turn = 2 * std::numbers::pi * column / around;
      const double radius_m = kRadius_m + kBump_m * std::sin(kBumps * polar) * std::sin(kBumps * turn);
      vertices.emplace_back(radius_m * std::sin(polar) * std::cos(turn), radius_m * std::sin(polar) * std::sin(turn),
                            radius_m * std::cos(polar));
    }
  }
  vertices.emplace_back(0, 0, -kRadius_m);
  const auto last = static_cast<std::uint32_t>(vertices.size() - 1);
  const auto at = [&](std::uint32_t row, std::uint32_t column) { return 1 + (row - 1) * around + column % around; };
  std::vector<scene::Triangle> triangles;
  for (std::uint32_t column = 0; column < around; ++column) {
    triangles.push_back({0, at(1, column), at(1, column + 1)});
    for (std::uint32_t row = 1; row + 1 < down; ++row) {
      triangles.push_back({at(row, column), at(row + 1, column), at(row + 1, column + 1)});
      triangles.push_back({at(row, column), at(row + 1, column + 1), at(row, column + 1)});
    }
    triangles.push_back({at(down - 1, column), last, at(down - 1, column + 1)});
  }
  return std::make_shared<const scene::TriangleMesh>("bumpy ball", vertices, triangles);
}

/// Bumps of 1 mm, 10 mm apart, on 100 x 100 mm.
std::shared_ptr<const scene::Scene> bumps() {
  constexpr double kSpacing_m = 5e-4;
  constexpr std::size_t kSide = 201;
  scene::HeightGrid grid{.origin_m = Point(-0.05, -0.05, 0), .spacing_m = kSpacing_m, .columns = kSide};
  for (std::size_t row = 0; row < kSide; ++row) {
    for (std::size_t column = 0; column < kSide; ++column) {
      const double turn = 2 * std::numbers::pi * kSpacing_m / 0.01;
      grid.heights_m.push_back(5e-4 * std::sin(turn * static_cast<double>(column)) *
                               std::cos(turn * static_cast<double>(row)));
    }
  }
  const Point origin_m = grid.origin_m;
  return scene_with({"height_field", {{"origin_m", origin_m}, {"spacing_m", kSpacing_m}}}, kFirmStiffness_N_per_m,
                    {.heights = std::make_shared<const scene::HeightGrid>(std::move(grid))});
}

/// Soft, 100 mm wide and 40 mm thick on a bed; its top is at z = 0.
/// @param more of its keys
std::shared_ptr<const scene::Scene> soft_pad(const std::string& more = "") {
  return server::parse_scene(R"(
[scene]
name = 'pad'
description = ''
degrees_of_freedom = 3
[[tissue]]
name = 'pad'
shape = { kind = 'block', center_m = [0, 0, -0.02], size_m = [0.1, 0.1, 0.04], cells = [6, 6, 3] }
held = { through_m = [0, 0, -0.039], normal = [0, 0, 1] }
young_Pa = 20000
poisson = 0.4
contact_stiffness_N_per_m = 2000
)" + more,
                             "scene.toml");
}

std::shared_ptr<const scene::Scene> puck(bool stop) {
  return server::parse_scene(R"(
[scene]
name = 'puck'
description = ''
degrees_of_freedom = 3
)" + sim::dragged_puck(stop),
                             "scene.toml");
}

/// Of the firm device.
struct FirmTasks {
  std::vector<RenderingTask> all{};
  device::DeviceDescription device = sim::firm_device();

  void add(const std::string& group, const std::string& name, std::shared_ptr<const scene::Scene> scene,
           const HarmonicMotion& motion, const RenderingGoal& goal = {}) {
    all.push_back({name, group, goal, std::move(scene), device, hand(motion)});
  }
};

void add_shapes(FirmTasks& tasks) {
  const std::string plane = "{ kind = 'half_space', through_m = [0, 0, 0], normal = [0, 0, 1] }";
  const Point origin = Point::Zero();
  const Point top(0, 0, 0.03);
  const std::string shapes = "primitives";
  tasks.add("plane", "plane, pressed at 3 Hz", parsed(plane), press(origin));
  tasks.add("plane", "plane", parsed(plane), slide(origin));
  tasks.add(shapes, "ball", parsed("{ kind = 'sphere', center_m = [0, 0, 0], radius_m = 0.03 }"), slide(top));
  tasks.add(shapes, "cylinder",
            parsed("{ kind = 'cylinder', from_m = [0, -0.05, 0], to_m = [0, 0.05, 0], radius_m = 0.03 }"), slide(top));
  tasks.add(shapes, "torus",
            parsed("{ kind = 'torus', center_m = [0, 0, 0], axis = [0, 1, 0], major_radius_m = 0.02, "
                   "minor_radius_m = 0.01 }"),
            slide(top));
  tasks.add("edge", "edge of a box", parsed("{ kind = 'box', center_m = [0, 0.05, -0.05], size_m = [0.2, 0.1, 0.1] }"),
            slide(Point(0, 0.0003, 0)));
  tasks.add("corner", "corner of a box",
            parsed("{ kind = 'box', center_m = [0.05, 0.05, -0.05], size_m = [0.1, 0.1, 0.1] }"),
            slide(Point(0.005, 0.0003, 0)));
  tasks.add("friction", "friction",
            parsed(plane, ", 'friction'", "[object.friction]\nstatic_coefficient = 0.4\ndynamic_coefficient = 0.3\n"),
            slide(origin));
  tasks.add("friction", "stick-slip",
            parsed(plane, ", 'stick_slip'", "[object.stick_slip]\nstiffness_N_per_m = 2000\nslip_N = 1\n"),
            slide(origin, 0.05));
  tasks.add("height field", "height field", bumps(), slide(origin));
}

void add_what_moves(FirmTasks& tasks) {
  // Beside a node of its surface, where nothing is special.
  tasks.add("tissue", "pad, pressed at 3 Hz", soft_pad(), press(Point(0.004, 0.003, 0)), kGoalOfWhatMoves);
  tasks.add("tissue", "pad", soft_pad(), slide(Point(0.004, 0.003, 0)), kGoalOfWhatMoves);
  constexpr double kBall_m = 0.008;
  for (const double speed_m_per_s : {0.06, 0.1}) {
    tasks.add("tissue", "pad, ball at " + text::to_text(speed_m_per_s) + " m/s",
              soft_pad("probe_radius_m = " + text::to_text(kBall_m) + "\n"),
              slide(Point(0.004, 0.003, kBall_m), speed_m_per_s), kGoalOfWhatMoves);
  }
  if (server::has_bodies()) {
    tasks.add("body by hand only", "free puck", puck(false), press(Point::Zero()), kGoalOfWhatMoves);
    tasks.add("body against a stop", "puck against a stop", puck(true), press(Point::Zero()),
              {.stiffness = 0.9, .error = kGoalOfWhatMoves.error});
    std::ranges::move(body_tasks(), std::back_inserter(tasks.all));
  }
}

}  // namespace

std::vector<RenderingTask> rendering_tasks() {
  const device::DeviceDescription light = device::parse_device(kLightDevice, "light");
  const Point origin = Point::Zero();
  const Point top(0, 0, 0.03);
  const auto fine = bumpy_ball(61, 49);      // 5,856 triangles
  const auto finest = bumpy_ball(200, 176);  // 70,000 triangles
  const auto mesh = [](const std::shared_ptr<const scene::TriangleMesh>& triangles, double stiffness_N_per_m) {
    return scene_with({"mesh", {{"file", triangles->name()}}}, stiffness_N_per_m, {.mesh = triangles});
  };
  FirmTasks firm;
  add_shapes(firm);
  for (const double speed_m_per_s : {0.05, 0.1, 0.5}) {
    firm.add("mesh of 5856", "mesh of 5,856, " + text::to_text(speed_m_per_s) + " m/s",
             mesh(fine, kFirmStiffness_N_per_m), slide(top, speed_m_per_s));
  }
  for (const double speed_m_per_s : {0.05, 0.1, 0.5}) {
    firm.add("mesh of 70000", "mesh of 70,000, " + text::to_text(speed_m_per_s) + " m/s",
             mesh(finest, kFirmStiffness_N_per_m), slide(top, speed_m_per_s));
  }
  firm.all.push_back({"mesh of 181,920 at once, from 1 s on",
                      "mesh at once",
                      {},
                      mesh(bumpy_ball(240, 380), kFirmStiffness_N_per_m),
                      firm.device,
                      hand_at_once(slide(top)),
                      kCoarseLevelHere_s});
  add_what_moves(firm);
  std::vector<RenderingTask> tasks = std::move(firm.all);
  tasks.push_back(
      {"light device, plane",
       "light device",
       {},
       scene_with({"half_space", {{"through_m", origin}, {"normal", Point(Point::UnitZ())}}}, kLightStiffness_N_per_m),
       light,
       hand(press(origin))});
  tasks.push_back(
      {"light device, mesh", "light device", {}, mesh(fine, kLightStiffness_N_per_m), light, hand(slide(top))});
  return tasks;
}

}  // namespace forcebound::lab
