#pragma once

#include <string>
#include <vector>

#include "forcebound/control/vector.hpp"

namespace forcebound::client {

/// What a client knows of a scene that ships, to offer it on a page. The scene itself is the server's.
struct KnownScene {
  std::string name;
  int degrees_of_freedom = 0;  ///< 0: any
  std::string device{};        ///< that its author suggests; empty: none
  std::string hand{};          ///< likewise
  bool shared = false;         ///< all clients are in the same one

  /// Whether a device with so many may be in it.
  [[nodiscard]] bool accepts(int device_degrees_of_freedom) const noexcept;
};

/// In the order of their names. A server of another version may have others; it refuses what it does not have.
[[nodiscard]] const std::vector<KnownScene>& known_scenes();

/// The device for it: its author's, or one of its degrees of freedom; in space also where any may be.
[[nodiscard]] std::string device_for(const KnownScene& scene);

/// Where a hand begins [m], outside of everything: where the suggested one does, else to the left of x = 0 and above
/// z = 0, where the scenes without one have nothing. @param scene null: an unknown one
[[nodiscard]] control::Vector start_in(const KnownScene* scene, int device_degrees_of_freedom);

/// Null: it does not ship.
[[nodiscard]] const KnownScene* find_known_scene(const std::string& name);

}  // namespace forcebound::client
