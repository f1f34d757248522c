#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "forcebound/handover/hash.hpp"
#include "forcebound/scene/scene.hpp"

namespace forcebound::handover {

/// No piece is longer, so that it fits a datagram.
inline constexpr std::size_t kPieceBytesMax = 1100;

/// Sent to a client before the first piece.
struct Announcement {
  /// SHA-256 of the manifest, which has the first 8 bytes of that of each piece or of the list that has them: the same
  /// hash, the same scene, as far as its own server did not search for two pieces of the same 8 bytes.
  Hash hash{};
  std::size_t manifest_bytes = 0;  ///< 0: nothing is handed over
  std::size_t pieces = 0;          ///< all of them, those of the manifest included

  friend bool operator==(const Announcement&, const Announcement&) = default;
};

/// How many pieces a manifest of so many bytes is.
[[nodiscard]] constexpr std::size_t manifest_pieces(std::size_t manifest_bytes) noexcept {
  return (manifest_bytes + kPieceBytesMax - 1) / kPieceBytesMax;
}

/// All of a scene that runs at a client (scene/rendering.hpp), cut into numbered pieces; beside a large mesh its coarse
/// level (coarse_level.hpp), if it has one. Immutable, shared by all sessions.
class PackedScene {
 public:
  /// @throws scene::GeometryError if something of it has no place in a piece
  explicit PackedScene(const scene::Scene& scene);

  [[nodiscard]] const Announcement& announcement() const noexcept { return announcement_; }

  /// From 0; the manifest first.
  [[nodiscard]] std::span<const std::byte> piece(std::size_t number) const noexcept;

  /// Box in which its geometry lies, in the scene's frame; for a piece of the manifest all of space.
  [[nodiscard]] const Eigen::AlignedBox3d& where_m(std::size_t number) const noexcept {
    return pieces_[number].where_m;
  }

  /// To be sent before the others: the manifest, and all that a client can run soon.
  [[nodiscard]] bool comes_first(std::size_t number) const noexcept { return pieces_[number].comes_first; }

  [[nodiscard]] std::size_t bytes() const noexcept { return bytes_.size(); }

 private:
  struct Piece {
    std::size_t begin;
    std::size_t bytes;
    Eigen::AlignedBox3d where_m;
    bool comes_first;
  };

  std::vector<std::byte> bytes_;  // of all pieces, one after the other
  std::vector<Piece> pieces_;
  Announcement announcement_;
};

/// Null if nothing of the scene runs at a client.
[[nodiscard]] std::shared_ptr<const PackedScene> pack(const scene::Scene& scene);

}  // namespace forcebound::handover
