#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "forcebound/view/description.hpp"

namespace forcebound::view {

/// Puts together at a client how the scene looks and where its parts are, from pieces of which some are lost, doubled
/// or not meant so: they come from anybody. Its memory is bounded. Not thread-safe.
class Assembly {
 public:
  /// A piece, as the message of the protocol has it.
  struct Piece {
    std::uint64_t session = 0;
    std::uint64_t view = 0;
    std::uint32_t pieces = 0;
    std::uint32_t number = 0;
    std::uint32_t first = 0;
    std::span<const std::byte> content{};
  };

  /// Whether a scene that is another than before is complete now.
  bool add(const Piece& piece);

  /// Null: none is complete.
  [[nodiscard]] const std::optional<Received>& scene() const noexcept { return scene_; }

  /// Somebody else looks: `take_moved` tells all that is known again.
  void report_all_again() noexcept;

  /// The message `moved` of a page for what has moved since the last one; empty: nothing. What of a surface never came
  /// is where it is at rest in the description.
  [[nodiscard]] std::string take_moved(int track);

 private:
  struct Moving {
    std::vector<float> numbers;
    std::vector<bool> known;  ///< of each item
    bool changed = false;
  };

  bool add_description(const Piece& piece);
  void add_movement(const Piece& piece);
  void begin(const Piece& piece);
  void add_surface(std::string& to, std::size_t group);
  void add_solids(std::string& to, std::size_t group);
  void add_values(std::string& to, std::size_t group);

  std::uint64_t session_ = 0;
  std::uint64_t view_ = 0;  // that is put together
  std::string text_;
  std::vector<bool> came_;
  std::size_t missing_ = 0;
  std::uint64_t shown_ = 0;  // the view of `scene_`
  std::optional<Received> scene_;
  std::vector<Moving> moving_;  // of its groups
};

}  // namespace forcebound::view
