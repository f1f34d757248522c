#include "tests/tools/lab/trials/experiment.hpp"

#include <stdexcept>

#include "forcebound/control/classic_text.hpp"
#include "forcebound/device/load_device.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "forcebound/text/names.hpp"

namespace forcebound::lab {
namespace {

constexpr double kEncoder = 15e-6;

std::vector<Experiment> walls() {
  const auto wall = [](double stiffness, std::vector<PaperFigure> paper) {
    return Experiment{.name = "wall",
                      .device = "wall-1dof",
                      .hand = "press",
                      .encoder_m = kEncoder,
                      .stiffness_N_per_m = stiffness,
                      .settle_s = 2,
                      .paper = std::move(paper)};
  };
  return {wall(50e3, {{"none", "stable"}, {"fba-less", "50 N/mm"}, {"fba-more", "50 N/mm"}}),
          wall(80e3, {{"none", "unstable"}}),
          wall(150e3, {{"none", "unstable"}, {"fba-less", "93 N/mm, 0.2 s"}, {"fba-more", "60 N/mm, no ringing"}})};
}

std::vector<Experiment> delays() {
  const auto delay = [](double encoder) {
    return Experiment{.name = "delay",
                      .device = "wall-1dof",
                      .hand = "press",
                      .encoder_m = encoder,
                      .stiffness_N_per_m = 10e3,
                      .one_way_delay_s = 50e-3,
                      .settle_s = 2,
                      .paper = {{"none", "unstable"}, {"fba-less", "stable"}, {"fba-more", "stable"}}};
  };
  return {delay(kEncoder), delay(0)};
}

std::vector<Experiment> circle() {
  return {{.name = "circle",
           .device = "cartesian-2dof",
           .hand = "trace-circle",
           .encoder_m = 55e-6,
           .stiffness_N_per_m = 10e3,
           .duration_s = 10,
           .settle_s = 1,
           .paper = {{"none", "unstable"}, {"fba-less", "1.63 N^2, 6.61 N/mm"}, {"fba-more", "0.13 N^2, 5.80 N/mm"}}}};
}

std::vector<Experiment> sphere() {
  return {{.name = "sphere",
           .device = "cartesian-3dof",
           .hand = "trace-sphere",
           .encoder_m = 55e-6,
           .stiffness_N_per_m = 10e3,
           .duration_s = 10,
           .settle_s = 1,
           .paper = {{"none", "unstable"}, {"fba-less", "1.75 N^2, 3.62 N/mm"}, {"fba-more", "0.23 N^2, 3.47 N/mm"}}}};
}

std::shared_ptr<const scene::Scene> scene_of(const Experiment& experiment) {
  control::ClassicText toml;
  if (experiment.name == "circle") {
    toml << "scene = { name = 'circle', description = 'the inside of a circle', degrees_of_freedom = 2 }\n"
            "[[object]]\nname = 'rim'\nshape = { kind = 'cavity', center_m = [0, 0], radius_m = 0.04 }\n";
  } else if (experiment.name == "sphere") {
    toml << "scene = { name = 'sphere', description = 'the outside of a ball', degrees_of_freedom = 3 }\n"
            "[[object]]\nname = 'ball'\nshape = { kind = 'sphere', center_m = [0, 0, 0], radius_m = 0.02 }\n";
  } else {
    toml << "scene = { name = 'wall', description = 'a wall at x = 0', degrees_of_freedom = 'any' }\n"
            "[[object]]\nname = 'wall'\nshape = { kind = 'half_space', through_m = [0], normal = [-1] }\n";
  }
  toml << "effects = ['surface']\n[object.surface]\nstiffness_N_per_m = " << experiment.stiffness_N_per_m
       << "\ndamping_N_s_per_m = 0\n";
  return server::parse_scene(toml.str(), experiment.name);
}

}  // namespace

sim::ClosedLoop::Settings Experiment::settings(const std::string& law) const {
  sim::ClosedLoop::Settings settings{
      .device = device::load_device(device), .hand = hand, .law = law, .scene = scene_of(*this), .settle_s = settle_s};
  settings.device.facts.encoder_step.setConstant(encoder_m);
  settings.network.up.delay.mean = time::from_seconds(one_way_delay_s);
  settings.network.down.delay.mean = time::from_seconds(one_way_delay_s);
  settings.renders_locally = renders_locally;
  return settings;
}

std::string Experiment::title() const {
  control::ClassicText text;
  text << name << ", K " << stiffness_N_per_m * 1e-3 << " N/mm, ";
  if (one_way_delay_s > 0) text << one_way_delay_s * 1e3 << " ms each way, ";
  text << (encoder_m > 0 ? "encoder " + std::to_string(static_cast<int>(encoder_m * 1e6 + 0.5)) + " um"
                         : std::string("ideal encoder"));
  return text.str();
}

std::vector<std::string> experiment_names() { return {"wall", "delay", "circle", "sphere"}; }

std::vector<Experiment> experiments(const std::string& name) {
  std::vector<Experiment> chosen;
  const auto add = [&](const char* group, std::vector<Experiment> runs) {
    if (name == group || name == "all") chosen.insert(chosen.end(), runs.begin(), runs.end());
  };
  add("wall", walls());
  add("delay", delays());
  add("circle", circle());
  add("sphere", sphere());
  if (chosen.empty()) {
    std::vector<std::string> known = experiment_names();
    known.emplace_back("all");
    throw std::invalid_argument("unknown experiment '" + name + "'" + text::suggestion(name, known));
  }
  return chosen;
}

}  // namespace forcebound::lab
