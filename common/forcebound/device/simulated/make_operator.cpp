#include "forcebound/device/simulated/make_operator.hpp"

#include <array>
#include <stdexcept>
#include <utility>
#include <vector>

#include "forcebound/device/simulated/motion_operators.hpp"
#include "forcebound/device/simulated/pointer_operator.hpp"
#include "forcebound/device/simulated/replay_operator.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/names.hpp"

namespace forcebound::device {
namespace {

using Made = std::unique_ptr<const Operator>;

struct Entry {
  std::string_view name;
  Made (*make)(OperatorSettings settings, int dof);
};

constexpr std::array<Entry, 7> kOperators = {{
    {"press", [](OperatorSettings s, int dof) -> Made { return std::make_unique<PressOperator>(std::move(s), dof); }},
    {"stroke", [](OperatorSettings s, int dof) -> Made { return std::make_unique<StrokeOperator>(std::move(s), dof); }},
    {"trace-circle",
     [](OperatorSettings s, int dof) -> Made {
       return std::make_unique<TraceOperator>(std::move(s), dof, TraceOperator::Wall::around);
     }},
    {"trace-sphere",
     [](OperatorSettings s, int dof) -> Made {
       return std::make_unique<TraceOperator>(std::move(s), dof, TraceOperator::Wall::inside);
     }},
    {"carry", [](OperatorSettings s, int dof) -> Made { return std::make_unique<CarryOperator>(std::move(s), dof); }},
    {"wave", [](OperatorSettings s, int dof) -> Made { return std::make_unique<WaveOperator>(std::move(s), dof); }},
    {"pointer",
     [](OperatorSettings s, int dof) -> Made { return std::make_unique<PointerOperator>(std::move(s), dof); }},
}};

Made make_replay(const std::string& arguments, int dof, bool tip_turns) {
  const std::string path = arguments.substr(0, arguments.find(','));
  if (path.empty()) throw std::invalid_argument("operator 'replay': expected replay:FILE.csv[,KEY=VALUE...]");
  const std::string settings = path.size() < arguments.size() ? arguments.substr(path.size() + 1) : "";
  OperatorSettings replay("replay:" + path, settings);
  if (tip_turns) replay.hold_a_turning_tip();
  return std::make_unique<ReplayOperator>(std::move(replay), dof, parse_motion(text::read_file(path), path, dof));
}

}  // namespace

Made make_operator(const std::string& specification, int dof, bool tip_turns) {
  const std::string name = specification.substr(0, specification.find(':'));
  const std::string arguments = name.size() < specification.size() ? specification.substr(name.size() + 1) : "";
  if (name == "replay") return make_replay(arguments, dof, tip_turns);
  std::vector<std::string> known;
  for (const Entry& entry : kOperators) {
    if (entry.name == name) {
      OperatorSettings settings(name, arguments);
      if (tip_turns) settings.hold_a_turning_tip();
      return entry.make(std::move(settings), dof);
    }
    known.emplace_back(entry.name);
  }
  known.emplace_back("replay:FILE.csv");
  throw std::invalid_argument("unknown operator '" + name + "'" + text::suggestion(name, known));
}

Made make_operator(const std::string& specification, const control::DeviceFacts& facts) {
  return make_operator(specification, facts.translations(), facts.rotations > 0);
}

std::string recorded_hand(std::string_view specification) {
  constexpr std::string_view kReplay = "replay:";
  if (!specification.starts_with(kReplay)) return {};
  specification.remove_prefix(kReplay.size());
  return std::string(specification.substr(0, specification.find(',')));
}

std::string doubt_of_hand(const std::string& specification, int dof) {
  const std::string file = recorded_hand(specification);
  if (file.empty()) return {};
  const Made hand = make_operator(specification, dof);
  const std::string& doubt = dynamic_cast<const ReplayOperator&>(*hand).doubt();
  return doubt.empty() ? doubt : "the hand of '" + file + "' " + doubt;
}

std::string operators_help() {
  constexpr int kDof = 3;
  std::string text;
  for (const Entry& entry : kOperators)
    text += entry.make(OperatorSettings(std::string(entry.name), ""), kDof)->description() + "\n";
  const std::vector<MotionSample> still = {{0, Vector::Zero(kDof)}, {1e-3, Vector::Zero(kDof)}};
  text += ReplayOperator(OperatorSettings("replay:FILE.csv", ""), kDof, still).description() + "\n";
  text += "each but carry, to press a button of the handle: button=0,button_from_s=0,button_until_s=TIME\n";
  text += "on a device that turns, all: turn_x_rad=0,turn_y_rad=0,turn_z_rad=0,turn_Hz=0.5\n";
  return text;
}

}  // namespace forcebound::device
