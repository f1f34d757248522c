#include <unistd.h>
#include <CLI/CLI.hpp>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "forcebound/control/damping.hpp"
#include "forcebound/control/diagonal_bound.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/table.hpp"
#include "forcebound/text/terminal.hpp"
#include "tests/tools/lab/commands.hpp"

namespace forcebound::lab {
namespace {

using control::Matrix;
using control::Vector;

/// A planar arm of links of 1 m with a damping of 1 N m s/rad at each joint, and what couples it beside that.
struct CoupledArm {
  std::string name;
  int links = 2;
  bool on_base = false;         ///< joint damping acts on each link's angle to the base, as where belts drive the links
  double at_tip_N_s_per_m = 0;  ///< damping of the tip's motion
};

/// Columns: velocity of the tip for each joint angle's.
Matrix tip_jacobian(const std::vector<double>& angles) {
  const auto links = static_cast<Eigen::Index>(angles.size());
  Matrix jacobian = Matrix::Zero(2, links);
  double direction = 0;
  for (Eigen::Index link = 0; link < links; ++link) {
    direction += angles[static_cast<std::size_t>(link)];
    for (Eigen::Index joint = 0; joint <= link; ++joint) {
      jacobian(0, joint) -= std::sin(direction);
      jacobian(1, joint) += std::cos(direction);
    }
  }
  return jacobian;
}

Matrix damping_of(const CoupledArm& arm, const Matrix& jacobian) {
  Matrix damping = Matrix::Identity(arm.links, arm.links);
  if (arm.on_base) {
    // Link k turns by the sum of the joints up to k.
    const Matrix sums = Matrix::Ones(arm.links, arm.links).triangularView<Eigen::Lower>();
    damping = sums.transpose() * sums;
  }
  return damping + arm.at_tip_N_s_per_m * jacobian.transpose() * jacobian;
}

/// All angles between links in steps of 10 degrees, but for folded ones; the first joint turns the arm as a whole.
std::vector<std::vector<double>> configurations(int links) {
  constexpr double kStep_rad = std::numbers::pi / 18;
  std::vector<std::vector<double>> all{{0.0}};
  for (int link = 1; link < links; ++link) {
    std::vector<std::vector<double>> longer;
    for (const auto& angles : all) {
      for (int i = -17; i <= 17; ++i) {
        longer.push_back(angles);
        longer.back().push_back(i * kStep_rad);
      }
    }
    all = std::move(longer);
  }
  return all;
}

/// Displayed stiffness of a static stiff wall, times the hold time and halved: F = 2 x/(T n'J b^-1 J'n).
double shown_by_wall(const Matrix& jacobian, const Vector& bound, double normal_rad) {
  const Eigen::Vector2d normal(std::cos(normal_rad), std::sin(normal_rad));
  const Vector torque = jacobian.transpose() * normal;
  return 1 / torque.cwiseAbs2().cwiseQuotient(bound).sum();
}

/// "least / median / most"
std::string spread_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return text::fixed(values.front(), 2) + " / " + text::fixed(values[values.size() / 2], 2) + " / " +
         text::fixed(values.back(), 2);
}

void compare_bounds(bool markdown) {
  constexpr int kNormals = 18;
  text::Table table({{"damping"},
                     {"arms"},
                     {"sum, over n lambda_min"},
                     {"sum, over scaled lambda_min"},
                     {"wall, over scaled lambda_min"}});
  for (const int links : {2, 3}) {
    const std::string name = std::to_string(links) + " links, ";
    for (const CoupledArm& arm : {CoupledArm{name + "each joint and the tip, 1 : 0.1", links, false, 0.1},
                                  CoupledArm{name + "each joint and the tip, 1 : 1", links, false, 1},
                                  CoupledArm{name + "each joint and the tip, 1 : 10", links, false, 10},
                                  CoupledArm{name + "each link to the base", links, true, 0}}) {
      std::vector<double> sums;
      std::vector<double> scaled_sums;
      std::vector<double> walls;
      const auto all = configurations(links);
      for (const auto& angles : all) {
        const Matrix jacobian = tip_jacobian(angles);
        const Matrix damping = damping_of(arm, jacobian);
        const Vector best = control::largest_diagonal_below(damping);
        const Vector scaled = control::diagonal_below(damping);
        const double least = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(damping).eigenvalues()[0];
        sums.push_back(best.sum() / (links * least));
        scaled_sums.push_back(best.sum() / scaled.sum());
        for (int i = 0; i < kNormals; ++i) {
          const double normal_rad = i * std::numbers::pi / kNormals;
          walls.push_back(shown_by_wall(jacobian, best, normal_rad) / shown_by_wall(jacobian, scaled, normal_rad));
        }
      }
      table.add({arm.name, std::to_string(all.size()), spread_of(sums), spread_of(scaled_sums), spread_of(walls)});
    }
  }
  std::cout << (markdown ? table.to_markdown() : table.to_text(text::colour_for(STDOUT_FILENO)));
}

}  // namespace

void add_coupled_damping(CLI::App& app) {
  auto markdown = std::make_shared<bool>(false);
  CLI::App* command = app.add_subcommand(
      "coupled-damping",
      "What fba-exact's diagonal below a coupled damping is worth on planar arms, over lambda_min: least / median / "
      "most over the arms' configurations; 'wall' is a static wall's displayed stiffness, over 18 normals too");
  command->add_flag("--markdown", *markdown, "as a Markdown table");
  command->footer("Example:\n  forcebound-lab coupled-damping --markdown");
  command->callback([markdown] { compare_bounds(*markdown); });
}

}  // namespace forcebound::lab
