#include "tests/tools/lab/soak/soak_case.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/control/classic_text.hpp"
#include "forcebound/device/load_device.hpp"
#include "forcebound/scene/geometry/triangle_mesh.hpp"
#include "forcebound/scene/part.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "tests/tools/sim/draw.hpp"
#include "tests/tools/sim/restless_hand.hpp"

namespace forcebound::lab {
namespace {

using namespace std::chrono_literals;
using sim::ClosedLoop;
using sim::Draw;
using time::Nanoseconds;

constexpr Nanoseconds kDuration = 5s;
/// Time without faults at the end, so that a session can come back.
constexpr Nanoseconds kQuiet = 2500ms;

device::DeviceDescription draw_device(Draw& draw, SoakTip tip) {
  auto device = device::load_device(tip == SoakTip::tool ? draw.one_of({"arm-6dof", "premium-6dof"})
                                                         : draw.one_of({"wall-1dof", "wall-1dof", "cartesian-2dof",
                                                                        "cartesian-3dof", "cartesian-3dof", "omni"}));
  control::DeviceFacts& facts = device.facts;
  const auto dof = facts.damping.rows();
  // Joint for joint the omni has about a thousandth of a Cartesian device's friction and steps of its own.
  const double unit = !device.facts.cartesian ? 1e-2 : 1;
  facts.friction.setConstant(draw.one_of({0.0, 0.0, 0.05, 0.5}) * unit);
  if (facts.cartesian) facts.encoder_step.setConstant(draw.one_of({0.0, 15e-6, 55e-6}));
  if (!facts.cartesian && draw.chance(0.25)) facts.encoder_step.setZero();
  facts.damping *= draw.one_of({0.2, 1.0, 1.0, 3.0});
  if (dof > 1 && draw.chance(0.25)) {
    control::Matrix mix(dof, dof);
    for (Eigen::Index i = 0; i < dof; ++i) mix.col(i) = draw.vector(dof, std::sqrt(facts.damping(i, i)));
    facts.damping += mix * mix.transpose();
  }
  const double stronger = draw.one_of({1.0, 1.0, 5.0});
  facts.force_N_max *= stronger;
  facts.torque_N_m_max *= stronger;
  facts.actuator_step.setConstant(draw.one_of({0.0, 0.0, 1.0 / 2048}) * facts.force_N_max *
                                  (!device.facts.cartesian ? 0.1 : 1));
  facts.latency_s = draw.one_of({0.0, 0.0, 20e-6, 100e-6, 300e-6});
  facts.hold_s_max = draw.one_of({1e-3, 2e-3, 2e-3, 5e-3});
  facts.release_share = facts.hold_s_max == 5e-3 ? 0.3 : 0;
  facts.release_s = 2e-3;
  return device;
}

sim::TickTiming draw_timing(Draw& draw) {
  sim::TickTiming timing;
  timing.late_share = draw.one_of({0.0, 0.0, 0.2});
  timing.late_max = draw.one_of<Nanoseconds>({1ms, 1ms, 5ms, 30ms});
  timing.measured = draw.chance(0.3);
  timing.choosing_max = draw.one_of<Nanoseconds>({0ns, 0ns, 15us, 200us});
  return timing;
}

sim::RestlessHand::Settings draw_hand(Draw& draw, int degrees_of_freedom) {
  sim::RestlessHand::Settings hand;
  hand.seed = draw.seed();
  hand.degrees_of_freedom = degrees_of_freedom;
  hand.hand = {.mass_kg = draw.one_of({0.02, 0.1, 0.3}),
               .stiffness_N_per_m = draw.one_of({20.0, 200.0, 1000.0}),
               .damping_N_s_per_m = draw.one_of({0.0, 0.5, 5.0})};
  hand.reach_m = draw.one_of({1e-3, 1e-2, 3e-2});
  hand.duration_s = time::to_seconds(kDuration);
  return hand;
}

/// What the hand does with a tool, whose tip it holds about where the scene begins.
void draw_turns(sim::RestlessHand::Settings& hand, const scene::Scene& scene, Draw draw) {
  hand.hand.inertia_kg_m2 = draw.one_of({1e-4, 5e-4});
  hand.hand.rotation_stiffness_N_m_per_rad = draw.one_of({0.1, 1.0, 3.0});
  hand.hand.rotation_damping_N_m_s_per_rad = draw.one_of({0.0, 0.01, 0.05});
  hand.turn_rad = draw.one_of({0.01, 0.1, 0.5});
  hand.middle_m = -scene.facts().tool_m;
}

std::string draw_way(Draw& draw) {
  return draw.one_of({"", "", "delay 1ms", "delay 10ms 5ms", "delay 50ms 10ms loss 5%", "loss 20%",
                      "delay 5ms duplicate 10% reorder 25% 50%", "delay 2ms loss gemodel 1% 10%",
                      "delay 10ms rate 2mbit", "delay 1ms slot 5ms 20ms", "delay 2ms corrupt 3%",
                      "delay 200ms 100ms distribution pareto"});
}

std::vector<ClosedLoop::Fault> draw_faults(Draw& draw) {
  using Kind = ClosedLoop::Fault::Kind;
  std::vector<ClosedLoop::Fault> faults(draw.index(3));
  for (auto& fault : faults) {
    fault.kind =
        draw.one_of({Kind::stall, Kind::blackout_up, Kind::blackout_down, Kind::blackout, Kind::server_killed});
    fault.length = draw.duration(0.005, draw.one_of({0.05, 0.5, 1.2}));
    fault.at = draw.duration(0.3, time::to_seconds(kDuration - kQuiet - fault.length));
  }
  return faults;
}

sim::ClockSkew draw_skew(Draw& draw) {
  sim::ClockSkew skew;
  skew.offset = draw.duration(4000, draw.one_of({4000.0, 5000.0, 1e6}));  // no jump leads before its origin
  skew.rate_error = draw.one_of({0.0, 1e-4, -1e-4});
  if (draw.chance(0.2)) {
    skew.jumps.push_back({draw.duration(1, 4), draw.duration(-3600, 3600)});
  }
  return skew;
}

std::shared_ptr<const scene::Scene> draw_scene(Draw& draw, SoakTip tip) {
  if (tip == SoakTip::tool) return server::load_scene(draw.one_of({"peg_in_hole", "blade"}));
  control::ClassicText toml;
  toml << "scene = { name = 'wall', description = 'a wall at x = 0', degrees_of_freedom = 'any' }\n"
          "[[object]]\nname = 'wall'\nshape = { kind = 'half_space', through_m = [0], normal = [-1] }\n"
          "effects = ['surface']\n[object.surface]\nstiffness_N_per_m = "
       << draw.one_of({1e3, 1e4, 1.5e5, 1e9}) << "\ndamping_N_s_per_m = " << draw.one_of({0, 0, 100}) << '\n';
  return server::parse_scene(toml.str(), "soak");
}

/// A jagged sheet of triangles, of one side, about the place where the hand is; or as many in a tenth of a millimetre.
std::shared_ptr<const scene::Scene> draw_lying_mesh(Draw& draw) {
  constexpr std::uint32_t kRows = 24;
  const double half_m = draw.one_of({5e-5, 0.01, 0.05});
  const double jagged_m = draw.one_of({0.0, 0.1, 3.0}) * half_m / kRows;
  std::vector<scene::Point> vertices_m;
  vertices_m.reserve(std::size_t{kRows + 1} * (kRows + 1));
  for (std::uint32_t j = 0; j <= kRows; ++j) {
    for (std::uint32_t i = 0; i <= kRows; ++i) {
      vertices_m.emplace_back(draw.number(-1, 1) * jagged_m, half_m * (2.0 * i / kRows - 1),
                              half_m * (2.0 * j / kRows - 1));
    }
  }
  std::vector<scene::Triangle> triangles;
  triangles.reserve(std::size_t{2} * kRows * kRows);
  const bool inside_out = draw.chance(0.5);
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    triangles.push_back(inside_out ? scene::Triangle{a, c, b} : scene::Triangle{a, b, c});
  };
  for (std::uint32_t j = 0; j < kRows; ++j) {
    for (std::uint32_t i = 0; i < kRows; ++i) {
      const std::uint32_t corner = j * (kRows + 1) + i;
      add(corner, corner + 1, corner + kRows + 2);
      add(corner, corner + kRows + 2, corner + kRows + 1);
    }
  }
  const scene::PartDescription object{.name = "sheet",
                                      .shape = scene::NamedValues{"mesh", {{"file", std::string("sheet.obj")}}},
                                      .effects = {{"surface", {{"stiffness_N_per_m", draw.one_of({1e3, 1e9})}}}}};
  scene::SceneParts parts;
  parts.objects.push_back(
      scene::make_part(object, scene::Registry::standard(), 3, {},
                       {.mesh = std::make_shared<const scene::TriangleMesh>("sheet.obj", vertices_m, triangles)}));
  return std::make_shared<const scene::Scene>(scene::SceneFacts{.name = "sheet", .description = ""}, std::move(parts));
}

/// What a server may hand over in place of its scene.
std::shared_ptr<const scene::Scene> draw_lie(Draw& draw) {
  control::ClassicText toml;
  toml << "scene = { name = 'lie', description = '', degrees_of_freedom = 'any' }\n";
  switch (draw.index(4)) {
    case 0:  // a wall where there is none, stiffer than anything
      toml << "[[object]]\nname = 'wall'\nshape = { kind = 'half_space', through_m = [" << draw.number(-0.02, 0.02)
           << "], normal = [" << draw.one_of({-1, 1}) << "] }\neffects = ['surface', 'friction']\n"
           << "[object.surface]\nstiffness_N_per_m = 1e9\n"
           << "[object.friction]\nstatic_coefficient = 100\ndynamic_coefficient = 50\n";
      break;
    case 1:  // a field that drives the device
      toml << "[[field]]\nname = 'drive'\neffects = ['constant_force']\n[field.constant_force]\nforce_N = ["
           << draw.number(-1e6, 1e6) << "]\n";
      break;
    case 2:
      return draw_lying_mesh(draw);
    default:  // a spring to somewhere else
      toml << "[[field]]\nname = 'spring'\neffects = ['spring_to_point']\n[field.spring_to_point]\ncenter_m = ["
           << draw.number(-0.1, 0.1) << "]\nstiffness_N_per_m = " << draw.one_of({1e3, 1e6}) << '\n';
  }
  return server::parse_scene(toml.str(), "lie");
}

/// Where the forces are computed, and whether what is handed over for it is a lie.
void draw_rendering(SoakCase& drawn, Draw draw) {
  ClosedLoop::Settings& settings = drawn.settings;
  settings.renders_locally = draw.chance(0.5);
  if (draw.chance(0.3)) settings.handed_over = draw_lie(draw);
  if (draw.chance(0.2)) settings.force_slew_N_per_s = draw.one_of({100.0, 5000.0});
  drawn.pieces_changed = draw.chance(0.1);
  drawn.models_lie = settings.renders_locally && draw.chance(0.5);
  if (draw.chance(0.2)) settings.server_turn = draw.one_of<Nanoseconds>({300us, 3ms, 20ms});
}

/// Of a lever at which the device's largest torque is its largest force; 0 where it shows none.
sim::EnvironmentSetting environment_on(const control::DeviceFacts& facts, std::string name) {
  return {
      .name = std::move(name), .force_N_max = facts.force_N_max, .lever_m = facts.torque_N_m_max / facts.force_N_max};
}

/// The forces received by a client on such a device from an active environment.
std::vector<control::Vector> forces_of_another_run(ClosedLoop::Settings settings, std::uint64_t seed) {
  class Forces final : public record::TickSink {
   public:
    explicit Forces(double lever_m) : lever_m_(lever_m) {}
    void on_tick(const record::TickRecord& tick) noexcept override {
      forces.push_back(sim::with_turn(tick.request, tick.request_torque_N_m, 1 / lever_m_));
    }
    std::vector<control::Vector> forces;

   private:
    double lever_m_;
  };
  settings.environment = environment_on(settings.device.facts, "bang-bang");
  settings.seed = seed;
  settings.faults.clear();
  Forces sink(settings.environment->lever_m);
  ClosedLoop loop(std::move(settings), {&sink});
  loop.run(500ms);
  return sink.forces;
}

/// The assumptions of the published laws' proofs: exact readings, punctual ticks, immediate forces.
void make_ideal(ClosedLoop::Settings& settings) {
  settings.device.facts.encoder_step.setZero();
  settings.device.facts.latency_s = 0;
  settings.device.facts.uncertainty = {};
  settings.device.facts.release_share = 0;
  settings.flaws = {};
  settings.timing = {};
  std::erase_if(settings.faults, [](const auto& fault) { return fault.kind == ClosedLoop::Fault::Kind::stall; });
}

/// Half of the devices are not exactly as their facts say; most of these facts have bounds that hold the truth.
void draw_flaws(SoakCase& drawn, Draw draw) {
  if (draw.chance(0.5)) return;
  device::DeviceFlaws& flaws = drawn.settings.flaws;
  flaws.seed = draw.seed();
  flaws.stamp_s = {-draw.one_of({0.0, 0.0, 5e-6, 30e-6}), draw.one_of({0.0, 0.0, 5e-6, 30e-6})};
  flaws.latency_s = {0, draw.one_of({0.0, 20e-6, 100e-6})};
  flaws.hold_s = {-draw.one_of({0.0, 0.02, 0.5}) * drawn.settings.device.facts.hold_s_max, draw.one_of({0.0, 5e-5})};
  flaws.clock_share = draw.one_of({0.0, 5e-4, -5e-4});
  flaws.frame = draw.one_of<Nanoseconds>({0ns, 0ns, 125us, 1ms});
  flaws.encoder_steps = draw.one_of({0.0, 0.1, 0.5});
  flaws.damping_share = draw.one_of({0.0, 0.01, 0.2});
  flaws.friction_share = draw.one_of({0.0, 0.2});
  flaws.torque_gain_share = {-draw.one_of({0.0, 0.0, 0.03, 0.1}), draw.one_of({0.0, 0.03, 0.1})};
  flaws.torque_ripple_share = draw.one_of({0.0, 0.01, 0.05});
  flaws.actuator_lag_s = draw.one_of({0.0, 0.0, 1e-4, 5e-4});
  flaws.latency_offset_s = {0, draw.one_of({0.0, 5e-5, 3e-4})};
  flaws.failed_writes = draw.one_of({0.0, 0.0, 0.01});
  flaws.failures_reported = draw.chance(0.8);
  flaws.releases_reported = draw.chance(0.5);
  flaws.effects_reported = draw.chance(0.3);
  flaws.lost_counts = draw.one_of({0.0, 0.0, 0.0, 0.01});
  const bool told = draw.chance(0.75);
  if (told) drawn.settings.device.facts.uncertainty = device::bounds_of(flaws);
  const bool has_no_bound = flaws.lost_counts > 0 || (flaws.failed_writes > 0 && !flaws.failures_reported);
  drawn.beyond_bounds = !told || has_no_bound;
}

/// Notes the law's guarantees for this case; may first make the device ideal, so that there are some.
void set_promises(SoakCase& drawn, const control::LawDescription& law, Draw draw) {
  using control::LawClaim;
  // An arm holds torques while its tip moves, so that the task-space force is not held.
  const bool straight = drawn.settings.device.facts.cartesian;
  const bool ideal = law.claim == LawClaim::passive_if_ideal && straight && draw.chance(0.5);
  if (ideal) make_ideal(drawn.settings);
  if (ideal) drawn.beyond_bounds = false;
  drawn.passive = ideal || (law.claim == LawClaim::passive && !drawn.beyond_bounds);
  drawn.shortens = law.shortens;
}

std::string name_of(ClosedLoop::Fault::Kind kind) {
  switch (kind) {
    case ClosedLoop::Fault::Kind::stall:
      return "client stalls";
    case ClosedLoop::Fault::Kind::blackout_up:
      return "blackout up";
    case ClosedLoop::Fault::Kind::blackout_down:
      return "blackout down";
    case ClosedLoop::Fault::Kind::blackout:
      return "blackout both ways";
    case ClosedLoop::Fault::Kind::server_killed:
      return "server killed";
  }
  return {};
}

}  // namespace

SoakCase draw_soak_case(std::uint64_t seed, const std::string& law, SoakTip tip) {
  const control::LawRegistry laws = baselines::shipped_laws();
  const control::LawDescription& description = laws.find(law);
  Draw draw(seed);
  SoakCase drawn;
  drawn.seed = seed;
  ClosedLoop::Settings& settings = drawn.settings;
  settings.law = law;
  settings.seed = draw.seed();
  settings.device = draw_device(draw, tip);
  if (const std::string refused = laws.refusal(law, settings.device.facts); !refused.empty()) {
    if (tip == SoakTip::tool) throw std::invalid_argument(refused);
    // Of as many axes, so that nothing else changes.
    settings.device = device::load_device("cartesian-3dof");
  }
  settings.timing = draw_timing(draw);
  settings.law_options.memory = draw.chance(0.3) ? control::EnergyMemory::full : control::EnergyMemory::capped;
  sim::RestlessHand::Settings hand = draw_hand(draw, settings.device.facts.translations());
  settings.scene = draw_scene(draw, tip);
  if (tip == SoakTip::tool) draw_turns(hand, *settings.scene, Draw(settings.seed ^ 0x2545f4914f6cdd1d));
  settings.make_hand = [hand] { return std::make_unique<sim::RestlessHand>(hand); };
  drawn.network_up = draw_way(draw);
  drawn.network_down = draw_way(draw);
  if (!drawn.network_up.empty()) settings.network.up = netem::parse_netem(drawn.network_up);
  if (!drawn.network_down.empty()) settings.network.down = netem::parse_netem(drawn.network_down);
  settings.network.seed = draw.seed();
  settings.faults = draw_faults(draw);
  draw_flaws(drawn, Draw(settings.seed ^ 0x5bd1e995));
  set_promises(drawn, description, Draw(~settings.seed));
  for (const auto& fault : settings.faults) drawn.last_fault = std::max(drawn.last_fault, fault.at + fault.length);
  settings.server_clock = draw_skew(draw);
  drawn.duration = kDuration;

  const auto names = sim::environment_names();
  sim::EnvironmentSetting environment = environment_on(settings.device.facts, names[draw.index(names.size())]);
  environment.seed = draw.seed();
  drawn.environment = environment.name;
  if (environment.name == "replayed") environment.other_run = forces_of_another_run(settings, draw.seed());
  settings.environment = environment;
  // Another stream, so that the rest of a seed's case stays what it was; and no other seed's.
  draw_rendering(drawn, Draw(settings.seed ^ 0x9e3779b97f4a7c15));
  return drawn;
}

std::string SoakCase::description() const {
  const auto ms = [](Nanoseconds t) { return time::to_seconds(t) * 1e3; };
  control::ClassicText text;
  text << "  seed         " << seed << "\n  law          " << settings.law << ", memory "
       << (settings.law_options.memory == control::EnergyMemory::full ? "full" : "capped") << "\n  device       "
       << describe(settings.device) << ", latency " << settings.device.facts.latency_s * 1e6 << " us\n  hand         "
       << settings.make_hand()->description() << "\n  environment  " << environment << ", scene '"
       << settings.scene->facts().name << "'\n  ticks        " << settings.timing.late_share * 100
       << " % late by up to " << ms(settings.timing.late_max) << " ms"
       << (settings.timing.measured ? ", and as measured" : "") << "; command up to "
       << ms(settings.timing.choosing_max) * 1e3 << " us after the reading\n  network      up \"" << network_up
       << "\", down \"" << network_down << "\"\n  server       clock off by " << ms(settings.server_clock.offset)
       << " ms, rate " << settings.server_clock.rate_error * 1e6 << " ppm, " << settings.server_clock.jumps.size()
       << " jumps\n  truth        "
       << (settings.flaws == device::DeviceFlaws{} ? "as the facts say"
           : beyond_bounds                         ? "beyond the facts' bounds"
                                                   : "within the facts' bounds")
       << '\n';
  text << "  rendering    " << (settings.renders_locally ? "local" : "remote")
       << (settings.handed_over ? ", scene '" + settings.handed_over->facts().name + "' is handed over instead" : "")
       << (pieces_changed ? ", pieces are changed or lost on the way" : "")
       << (models_lie ? ", answers have lying models and clocks" : "") << ", the server computes for "
       << ms(settings.server_turn) << " ms, slew bound " << settings.force_slew_N_per_s << " N/s\n";
  for (const auto& fault : settings.faults) {
    text << "  fault        at " << ms(fault.at) << " ms for " << ms(fault.length) << " ms: " << name_of(fault.kind)
         << '\n';
  }
  return text.str();
}

}  // namespace forcebound::lab
