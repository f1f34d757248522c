#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/server/environment/scene_parser.hpp"

namespace forcebound::lab {

/// One key, and what is to be tried for it.
struct Sweep {
  std::string key;                    ///< "tissue.pad.shape.cells"; a "[[tissue]]" is found by its name
  std::vector<std::string> values{};  ///< each as TOML writes it, "[4, 4, 2]"
};

/// "KEY=V1,V2,..." with values as TOML writes them; commas within brackets and quotes do not separate.
/// @throws std::invalid_argument
Sweep parse_sweep(std::string_view sweep);

/// A sweep that shows what the scene has to offer: the levels it may be picked from, a tissue's cells, a distance
/// field's cell, a mesh's level of detail, the bodies' time step.
/// @param scene_text of a scene that can be compiled
/// @throws std::invalid_argument if there is nothing of the kind
Sweep usual_sweep(const std::string& scene_text);

/// The scene itself with what finds its bodies' forces at its best, twice by different ways: Newton's method and
/// conjugate gradients, as far as they go. Nothing for a key that is not about that.
struct TightSolvers {
  std::vector<server::SceneChange> newton;
  std::vector<server::SceneChange> cg;
};
std::optional<TightSolvers> tight_solvers(const std::string& key);

/// What the tight solvers are, for people: "1000 iterations at most, ...".
std::string tight_text();

/// Whether a key is a mesh's level of detail, whose 1 is the mesh as its file has it.
bool is_level_of_detail(const std::string& key);

/// How coarse a value is, in any unit: of a list the inverse of its first number, of a number whose key ends in _m or
/// _s itself, of a share of a mesh's triangles the length of their edges, of another number its inverse. Nothing for
/// what is no number.
std::optional<double> spacing_of(const std::string& key, const std::string& value);

/// Of the sweep's values, which are put in order from coarse to fine if they came the other way round.
/// @throws std::invalid_argument if there is no such order
std::vector<double> sort_to_fine(Sweep& sweep);

}  // namespace forcebound::lab
