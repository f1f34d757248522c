#pragma once

#include <cstdint>
#include <optional>

namespace forcebound::client::commands::identify {

/// Finds the distance of an encoder's neighbouring readings: all readings of a grid lie whole steps apart.
class EncoderGrid {
 public:
  void add(double reading) noexcept;

  /// The largest step that explains all readings; nothing before two distinct ones, or if they lie on no grid.
  [[nodiscard]] std::optional<double> step() const noexcept;

  /// Readings that were not the same as the one before.
  [[nodiscard]] std::uint64_t changes() const noexcept { return changes_; }

 private:
  bool any_ = false;
  bool no_grid_ = false;
  double last_ = 0;
  double first_ = 0;
  double step_ = 0;
  double farthest_ = 0;
  std::uint64_t changes_ = 0;
};

}  // namespace forcebound::client::commands::identify
