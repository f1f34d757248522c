#include "tests/tools/lab/accuracy/sweep.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "forcebound/config/node.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/split.hpp"

namespace forcebound::lab {
namespace {

// Settings of the tightest solver.
constexpr int kTightIterations = 1000;
constexpr const char* kTightTolerance = "1e-14";

using config::Node;

/// The tables of an array; none where there is no such array.
const Node::List& tables_of(const Node& scene, std::string_view name) {
  static const Node::List kNone;
  const Node* const node = scene.find(name);
  const auto* const list = node == nullptr ? nullptr : node->as<Node::List>();
  return list == nullptr ? kNone : *list;
}

Sweep levels_of(const Node& accuracy) {
  Sweep sweep{.key = accuracy.text_at("key")};
  for (const Node& level : tables_of(accuracy, "levels")) sweep.values.push_back(written(*level.find("value")));
  return sweep;
}

/// The name of the first of a kind that has such a shape; empty: there is none.
std::string first_with(const Node& scene, const char* kind, const char* shape) {
  for (const Node& table : tables_of(scene, kind)) {
    const Node* const own = table.find("shape");
    if (own != nullptr && own->text_at("kind") == shape) return table.text_at("name");
  }
  return {};
}

}  // namespace

Sweep parse_sweep(std::string_view sweep) {
  const auto equals = sweep.find('=');
  if (equals == std::string_view::npos || equals == 0 || equals + 1 == sweep.size()) {
    throw std::invalid_argument("a sweep must be KEY=VALUE,VALUE,..., got '" + std::string(sweep) + "'");
  }
  return {std::string(sweep.substr(0, equals)), text::split_outside_brackets(sweep.substr(equals + 1), ',')};
}

Sweep usual_sweep(const std::string& scene_text) {
  const Node scene = config::parse_toml(scene_text, "scene");
  if (const Node* const accuracy = scene.find("accuracy")) return levels_of(*accuracy);
  if (const std::string name = first_with(scene, "tissue", "block"); !name.empty()) {
    return {"tissue." + name + ".shape.cells", {"[4, 4, 2]", "[6, 6, 3]", "[9, 9, 4]"}};
  }
  if (const std::string name = first_with(scene, "object", "distance_field"); !name.empty()) {
    return {"object." + name + ".shape.spacing_m", {"0.008", "0.004", "0.002", "0.001"}};
  }
  if (const std::string name = first_with(scene, "object", "mesh"); !name.empty()) {
    return {"object." + name + ".shape.detail", {"0.03", "0.1", "0.3", "1"}};
  }
  if (const Node::List& bodies = tables_of(scene, "body"); !bodies.empty()) {
    const Node& body = bodies.front();
    if (body.find("shape") != nullptr) return {"bodies.timestep_s", {"0.004", "0.002", "0.001", "0.0005", "0.00025"}};
    return {"body." + body.text_at("name") + ".iterations", {"1", "2", "3", "5", "10", "100"}};
  }
  throw std::invalid_argument("the scene has no key with levels of its own: give one with --sweep KEY=V1,V2,...");
}

std::optional<TightSolvers> tight_solvers(const std::string& key) {
  const std::size_t dot = key.rfind('.');
  if (dot == std::string::npos) return std::nullopt;
  const std::string table = key.substr(0, dot);
  const std::string last = key.substr(dot + 1);
  const bool is_bodies = table == "bodies" || table.starts_with("body.");
  if (!is_bodies || (last != "solver" && last != "iterations" && last != "tolerance")) return std::nullopt;
  const auto with = [&](const std::string& solver) -> std::vector<server::SceneChange> {
    return {{table + ".iterations", std::to_string(kTightIterations)},
            {table + ".tolerance", kTightTolerance},
            {table + ".solver", "\"" + solver + "\""}};
  };
  return TightSolvers{.newton = with("newton"), .cg = with("cg")};
}

std::string tight_text() {
  return std::to_string(kTightIterations) + " iterations at most, tolerance " + kTightTolerance;
}

bool is_level_of_detail(const std::string& key) { return key.ends_with(".detail"); }

std::optional<double> spacing_of(const std::string& key, const std::string& value) {
  const bool is_list = value.starts_with('[');
  const std::size_t begin = is_list ? value.find_first_not_of(' ', 1) : 0;
  if (begin == std::string::npos) return std::nullopt;
  const std::string first = is_list ? value.substr(begin, value.find_first_of(" ,]", begin) - begin) : value;
  const auto number = text::finite_number(first);
  if (!number || !(*number > 0)) return std::nullopt;
  const auto is_in = [&](const std::string& unit) {
    return key.ends_with("_" + unit) && !key.ends_with("_per_" + unit);
  };
  if (is_level_of_detail(key)) return 1 / std::sqrt(*number);
  const bool is_size = !is_list && (is_in("m") || is_in("s"));
  return is_size ? *number : 1 / *number;
}

std::vector<double> sort_to_fine(Sweep& sweep) {
  if (sweep.values.size() < 2) {
    throw std::invalid_argument("a reference needs two values or more of " + sweep.key + ", or a scene that is exact");
  }
  std::vector<double> spacings;
  for (const std::string& value : sweep.values) {
    const auto spacing = spacing_of(sweep.key, value);
    if (!spacing) {
      throw std::invalid_argument(sweep.key + " has no order from coarse to fine (" + value +
                                  "): name an exact scene with --reference");
    }
    spacings.push_back(*spacing);
  }
  if (spacings.front() < spacings.back()) {
    std::ranges::reverse(spacings);
    std::ranges::reverse(sweep.values);
  }
  const auto wrong = std::ranges::adjacent_find(spacings, std::ranges::less_equal());
  if (wrong != spacings.end()) {
    const auto at = static_cast<std::size_t>(std::distance(spacings.begin(), wrong));
    throw std::invalid_argument("values of " + sweep.key + " must go from coarse to fine or back, got " +
                                sweep.values[at + 1] + " beside " + sweep.values[at]);
  }
  return spacings;
}

}  // namespace forcebound::lab
