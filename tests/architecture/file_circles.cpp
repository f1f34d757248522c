#include "tests/architecture/file_circles.hpp"

#include <algorithm>
#include <set>
#include <string_view>

#include "tests/architecture/source_text.hpp"

namespace forcebound::architecture {
namespace {

/// What a header and its source have in common: "forcebound/wire/codec".
std::string unit_of(std::string_view include_path) {
  std::string unit(include_path.substr(0, include_path.rfind('.')));
  constexpr std::string_view kInternal = "/internal/";
  if (const auto at = unit.find(kInternal); at != std::string::npos) unit.replace(at, kInternal.size(), "/");
  return unit;
}

/// Units by name; of each those that it includes, and where.
using Graph = std::map<std::string, std::map<std::string, std::string>>;

Graph graph_of(const std::map<std::string, std::string>& texts) {
  Graph graph;
  for (const auto& [file, text] : texts) {
    const std::string unit = unit_of(include_path_of(file));
    for_each_line(text, [&, &path = file](int number, const std::string& code) {
      const auto header = included(code);
      if (!header || unit_of(*header) == unit) return;
      graph[unit].emplace(unit_of(*header), path + ":" + std::to_string(number) + " includes '" + *header + "'");
    });
  }
  return graph;
}

class CircleSearch {
 public:
  explicit CircleSearch(const Graph& graph) : graph_(graph) {}

  [[nodiscard]] std::vector<std::string> circles() {
    for (const auto& [unit, includes] : graph_) visit(unit);
    return circles_;
  }

 private:
  void visit(const std::string& unit) {
    const auto here = graph_.find(unit);
    if (here == graph_.end() || !seen_.insert(unit).second) return;
    for (const auto& [next, where] : here->second) {
      way_.push_back({unit, where});
      const auto first = std::ranges::find(way_, next, &Step::from);
      if (first != way_.end()) {
        std::string circle = first->where;
        for (auto step = first + 1; step != way_.end(); ++step) circle += ", " + step->where;
        circles_.push_back(circle);
      }
      visit(next);
      way_.pop_back();
    }
  }

  struct Step {
    std::string from;
    std::string where;
  };

  const Graph& graph_;
  std::set<std::string> seen_;
  std::vector<Step> way_;
  std::vector<std::string> circles_;
};

}  // namespace

std::vector<std::string> file_circles(const std::map<std::string, std::string>& texts) {
  const Graph graph = graph_of(texts);
  return CircleSearch(graph).circles();
}

}  // namespace forcebound::architecture
