#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/view/shown_scene.hpp"

namespace forcebound::view {

/// A description is cut into pieces of so many bytes. Those that would be longer leave out meshes, and say so.
inline constexpr std::size_t kPieceBytes = 1100;
inline constexpr std::size_t kDescriptionBytesMost = std::size_t{2} << 20U;

/// Of what moves, numbers that one piece holds.
inline constexpr std::size_t kNumbersMost = kPieceBytes / sizeof(float);

/// The surface of a tissue, or the solids of a dynamic model together, as they are told of while they move; or numbers
/// for a panel beside the picture.
struct MovingGroup {
  std::vector<std::string> names{};  ///< of a surface one
  bool deforms = false;              ///< a surface
  std::size_t vertices = 0;          ///< of it
  bool values = false;               ///< numbers, each with its name

  [[nodiscard]] std::size_t items() const noexcept { return deforms ? vertices : names.size(); }
  [[nodiscard]] std::size_t numbers_of_item() const noexcept {
    if (values) return 1;
    return deforms ? scene::kNumbersOfVertex : scene::kNumbersOfSolid;
  }
};

/// How a scene looks, as a server tells a client in pieces.
struct Description {
  std::string text;  ///< JSON
  std::uint64_t hash = 0;
  std::vector<MovingGroup> moving{};  ///< of each dynamic model one; without items: nothing of it is seen

  [[nodiscard]] std::uint32_t pieces() const noexcept;
  [[nodiscard]] std::span<const std::byte> piece(std::uint32_t number) const noexcept;
};

/// @param models what is seen of each dynamic model
/// @param more groups after those, of solids that are among the objects, and of values
[[nodiscard]] Description describe(ShownScene objects, std::span<const std::vector<scene::VisiblePart>> models,
                                   const std::vector<MovingGroup>& more = {});

/// FNV-1a, never 0.
[[nodiscard]] std::uint64_t hash_of(std::string_view text) noexcept;

/// What a client makes of a description.
struct Received {
  ShownScene shown;
  std::vector<MovingGroup> moving{};
};

/// Reads what a server, which may be anybody, sent. Nothing: it is malformed.
[[nodiscard]] std::optional<Received> read_description(std::string_view text);

}  // namespace forcebound::view
