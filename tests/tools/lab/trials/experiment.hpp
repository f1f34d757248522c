#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "tests/tools/sim/closed_loop.hpp"

namespace forcebound::lab {

/// The paper's figures of one law in one experiment [Kim 2015, section VI], for the table.
struct PaperFigure {
  std::string law;
  std::string text;
};

/// One experiment of the paper, without the law.
///
/// The paper gives neither masses nor hands, so each experiment has one plausible device mass and hand, the same for
/// all laws; the curves cannot match the paper's, the laws' figures can.
struct Experiment {
  std::string name;
  std::string device;
  std::string hand;
  double encoder_m = 0;
  double stiffness_N_per_m = 0;
  double one_way_delay_s = 0;
  double duration_s = 4;
  double settle_s = 0;           ///< contact statistics begin this long after the first contact
  bool renders_locally = false;  ///< what can be at the client; the paper knew forces of the server only
  std::vector<PaperFigure> paper{};

  [[nodiscard]] sim::ClosedLoop::Settings settings(const std::string& law) const;

  /// "wall, K 150 N/mm, encoder 15 um".
  [[nodiscard]] std::string title() const;
};

/// The runs of `wall`, `delay`, `circle` or `sphere`; of all of them for `all`.
std::vector<Experiment> experiments(const std::string& name);

/// wall, delay, circle, sphere.
std::vector<std::string> experiment_names();

}  // namespace forcebound::lab
