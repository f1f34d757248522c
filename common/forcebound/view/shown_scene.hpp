#pragma once

#include <string>
#include <vector>

#include "forcebound/scene/scene.hpp"
#include "forcebound/scene/visible_part.hpp"

/// How a scene looks: what a live page draws, in the JSON of its message `scene` (page/README.md).
namespace forcebound::view {

/// Triangles of a mesh, or squares of a relief, that are shown at most; larger ones are only named.
inline constexpr std::size_t kTrianglesShownMost = 60000;

/// Elements of the lists of a message `scene`, separated by commas.
struct ShownScene {
  std::string name;
  std::string shapes{};
  std::string meshes{};
  std::string more{};         ///< what is not drawn, in words, not JSON
  std::string robot{};        ///< of a robot at work: an object of texts, numbers and flags; empty: there is none
  control::Vector tool_m{};   ///< in the hand, from the grip to its tip in the handle's axes; no rows: none
  control::Vector begin_m{};  ///< where a hand begins, outside of everything; no rows: nobody says

  [[nodiscard]] bool empty() const noexcept { return shapes.empty() && meshes.empty(); }
};

enum class Which : std::uint8_t {
  all,
  not_handed_over,  ///< what a client that renders locally is not handed over
};

/// The objects of a scene and the tool in the hand: shapes with all their values, presets included; reliefs and other
/// shapes of triangles as meshes. Fields, which have no shape, are named in `more`.
[[nodiscard]] ShownScene shown(const scene::Scene& scene, Which which);

/// What moves or deforms, as it begins, with `"moves":true`.
void add_part(ShownScene& to, const scene::VisiblePart& part);

/// Where the frame of the client's device is, which is not the scene's: it moves, and is no solid.
/// @param scale how long a metre of the device is in the scene
void add_frame(ShownScene& to, const std::string& name, double scale);

/// Puts words behind those that are there.
void add_words(std::string& to, const std::string& words);

/// What both show; the name is the first one's.
[[nodiscard]] ShownScene joined(ShownScene first, const ShownScene& second);

/// `,"key":[...]`; empty for no rows.
[[nodiscard]] std::string place_member(const std::string& key, const control::Vector& place_m);

/// The message `scene` of a page.
[[nodiscard]] std::string scene_message(int track, const ShownScene& shown);

}  // namespace forcebound::view
