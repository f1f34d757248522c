#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "forcebound/handover/coverage.hpp"
#include "forcebound/handover/handover_error.hpp"
#include "forcebound/handover/limits.hpp"
#include "forcebound/handover/packed_scene.hpp"
#include "forcebound/scene/registry.hpp"
#include "forcebound/scene/scene.hpp"

namespace forcebound::handover {

/// A scene made of the pieces that have arrived.
struct AssembledScene {
  std::shared_ptr<const scene::Scene> scene{};
  std::vector<Coverage> coverage{};  ///< of each step of the plan; where a coarse level is felt, all is known
  std::vector<Coverage> exact{};     ///< the same without coarse levels
  /// Triangles and heights of the shapes made anew for this one, and what finding their coverage takes of that time.
  std::size_t elements_built = 0;
  bool whole = false;
};

/// Puts the pieces of a scene together, in whatever order they come.
///
/// Trusts nobody: what was announced and what the manifest says is held to the limits before any memory is spent on it,
/// each piece to its hash and to what the manifest says of its geometry. Not thread-safe; allocates.
class SceneAssembly {
 public:
  /// @param registry the shapes and effects that can run here
  /// @throws HandoverError if that is more than the limits let through, or no announcement
  SceneAssembly(const Announcement& announcement, scene::Registry registry, const Limits& limits = {});
  ~SceneAssembly();
  SceneAssembly(SceneAssembly&&) noexcept;
  SceneAssembly& operator=(SceneAssembly&&) noexcept;

  /// A piece that is there already is passed over.
  /// @throws HandoverError if it is not what was announced; nothing more is to be expected of this assembly then.
  void add(std::size_t number, std::span<const std::byte> bytes);

  [[nodiscard]] const Announcement& announcement() const noexcept;
  [[nodiscard]] std::size_t pieces_here() const noexcept;
  [[nodiscard]] bool whole() const noexcept { return pieces_here() == announcement().pieces; }

  /// Whether the manifest has arrived.
  [[nodiscard]] bool can_build() const noexcept;

  /// Coarse levels that are there.
  [[nodiscard]] std::size_t coarse_levels_here() const noexcept;

  /// Everything nearer to the point than this has arrived, of all geometries but coarse levels [m].
  [[nodiscard]] double known_within_m(const Point& point_m) const;

  /// A scene of the pieces that have arrived: shapes, triangles and effects are the server's to the bit; the coverage
  /// tells where pieces are missing. There a mesh that has a coarse level is felt by that, once it has arrived. A
  /// geometry and its coverage are built again only if pieces of it arrived since.
  /// @param ended nobody waits for it any more; it can be built later
  /// @throws HandoverError if no shape or effect can be made so, a coarse level lies off by more than its error, or
  /// nobody waits
  [[nodiscard]] AssembledScene build(const std::stop_token& ended = {});

  /// The pieces as they came, for a cache; of a whole assembly.
  [[nodiscard]] std::vector<std::byte> content() const;

  /// Takes what `content` gave. @throws HandoverError as `add`, and if it is not all
  void add_content(std::span<const std::byte> content);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// Why a client refuses to run what a scene hands over, in one line; empty: it runs it, or there is nothing to run. It
/// is packed and built for that, as at a client.
[[nodiscard]] std::string why_refused(const scene::Scene& scene, const Limits& limits = {});

}  // namespace forcebound::handover
