#include "forcebound/tissue/set_up.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <stdexcept>
#include <string>

#include "forcebound/text/numbers.hpp"
#include "forcebound/tissue/elasticity.hpp"

namespace forcebound::tissue {
namespace {

/// Which free nodes are coupled, both triangles; the values mean nothing.
using NodeGraph = Eigen::SparseMatrix<double>;

// Of an operation; many solves at once take less.
constexpr double kFactorising_s = 1.5e-9;
constexpr double kSolving_s = 0.2e-9;

NodeGraph graph_of(const TetrahedralMesh& mesh, const FreeCoordinates& free) {
  const ElasticElements elements(mesh, {.young_Pa = 1});
  std::vector<Eigen::Triplet<double>> pairs;
  pairs.reserve(elements.nodes_each() * elements.nodes_each() * elements.count());
  for (std::size_t element = 0; element < elements.count(); ++element) {
    const std::vector<int> nodes = elements.nodes_of(element);
    for (const int a : nodes) {
      for (const int b : nodes) {
        if (free.first_of(a) == FreeCoordinates::kHeld || free.first_of(b) == FreeCoordinates::kHeld) continue;
        pairs.emplace_back(free.first_of(a) / 3, free.first_of(b) / 3, 1.0);
      }
    }
  }
  NodeGraph graph(free.count() / 3, free.count() / 3);
  graph.setFromTriplets(pairs.begin(), pairs.end());
  return graph;
}

/// Of the factor L of a matrix of three rows and columns for each node.
struct Fill {
  double entries = 0;
  double operations = 0;  ///< that factorising takes
};

/// By the elimination tree [Davis, Direct Methods for Sparse Linear Systems, 2006, section 4.1].
Fill fill_of(const NodeGraph& graph) {
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(graph, order);
  const auto nodes = static_cast<std::size_t>(graph.cols());
  constexpr int kRoot = -1;
  std::vector<int> place(nodes);
  for (std::size_t k = 0; k < nodes; ++k) place[static_cast<std::size_t>(order.indices()[k])] = static_cast<int>(k);
  std::vector<int> parent(nodes, kRoot);
  std::vector<int> seen(nodes, kRoot);
  std::vector<double> below(nodes, 0);
  for (std::size_t k = 0; k < nodes; ++k) {
    const int row = static_cast<int>(k);
    seen[k] = row;
    for (NodeGraph::InnerIterator entry(graph, order.indices()[k]); entry; ++entry) {
      auto column = static_cast<std::size_t>(place[static_cast<std::size_t>(entry.row())]);
      while (column < k && seen[column] != row) {
        if (parent[column] == kRoot) parent[column] = row;
        below[column] += 1;
        seen[column] = row;
        column = static_cast<std::size_t>(parent[column]);
      }
    }
  }
  Fill fill;
  for (const double nodes_below : below) {
    fill.entries += 9 * nodes_below + 6;
    fill.operations += 27 * (nodes_below + 1) * (nodes_below + 1);
  }
  return fill;
}

/// Two triangles for each force on one coordinate.
double solves(const Fill& fill, double forces) { return 2 * fill.entries * forces; }

}  // namespace

double predicted_set_up_s(const TetrahedralMesh& mesh, const std::vector<int>& held_nodes, bool large_motion) {
  const FreeCoordinates free(static_cast<int>(mesh.nodes_m().size()), held_nodes);
  const NodeGraph graph = graph_of(mesh, free);
  if (graph.cols() == 0) return 0;
  const Fill fill = fill_of(graph);
  const double factorising_s = kFactorising_s * fill.operations;
  if (large_motion) return factorising_s;
  const auto forces = 3 * std::ranges::count_if(mesh.surface_nodes(), [&](int node) {
                        return free.first_of(node) != FreeCoordinates::kHeld;
                      });
  return factorising_s + kSolving_s * solves(fill, static_cast<double>(forces));
}

void check_set_up(const TetrahedralMesh& mesh, double set_up_s) {
  if (set_up_s <= kSetUpMost_s) return;
  throw std::runtime_error(mesh.name() + ": its set-up would take about " + text::rounded(set_up_s, 2) +
                           " s: expected at most " + text::to_text(kSetUpMost_s) + " s, so a coarser mesh");
}

void check_tetrahedra(double tetrahedra) {
  if (tetrahedra <= static_cast<double>(kTetrahedraMost)) return;
  throw std::runtime_error("has " + text::fixed(tetrahedra, 0) + " tetrahedra: expected at most " +
                           std::to_string(kTetrahedraMost));
}

}  // namespace forcebound::tissue
