#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/server/environment/scene_parser.hpp"

namespace forcebound::lab {

/// One key, and its values.
struct Sweep {
  std::string key;                    ///< "tissue.pad.shape.cells"; a "[[tissue]]" is found by its name
  std::vector<std::string> values{};  ///< each in TOML, "[4, 4, 2]"
};

/// "KEY=V1,V2,..." with values in TOML; commas within brackets and quotes do not separate.
/// @throws std::invalid_argument
Sweep parse_sweep(std::string_view sweep);

/// A default sweep for the scene: its levels of accuracy, a tissue's cells, a distance field's cell, a mesh's level of
/// detail, the bodies' time step.
/// @param scene_text of a scene that can be compiled
/// @throws std::invalid_argument if the scene has none of these
Sweep usual_sweep(const std::string& scene_text);

/// The scene with the tightest solver of its bodies' forces, by two different methods: Newton's and conjugate
/// gradients. Nothing for a key that is not of the solver.
struct TightSolvers {
  std::vector<server::SceneChange> newton;
  std::vector<server::SceneChange> cg;
};
std::optional<TightSolvers> tight_solvers(const std::string& key);

/// The tight solvers' settings, as text: "1000 iterations at most, ...".
std::string tight_text();

/// Whether a key is a mesh's level of detail, whose 1 is the mesh as its file has it.
bool is_level_of_detail(const std::string& key);

/// Coarseness of a value, in any unit: of a list the inverse of its first number, of a number whose key ends in _m or
/// _s itself, of a share of a mesh's triangles the length of their edges, of another number its inverse. Nothing for a
/// value that is not a number.
std::optional<double> spacing_of(const std::string& key, const std::string& value);

/// Coarseness of the sweep's values, which are reversed if they go from fine to coarse.
/// @throws std::invalid_argument if there is no such order
std::vector<double> sort_to_fine(Sweep& sweep);

}  // namespace forcebound::lab
