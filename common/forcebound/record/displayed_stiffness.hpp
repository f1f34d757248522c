#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>

#include "forcebound/record/tick_record.hpp"

namespace forcebound::record {

/// The displayed stiffness of a contact, tick by tick:
///
///     K = (component of the applied force out of the surface) / (depth below it)
///
/// only where that ratio is a stiffness: deeper than `depth_m_min`, where an encoder's step does not dominate, and at
/// rest or quasi-static: in contact with a known depth for the last 20 ms, over which the depth changed at no more than
/// `kSpeed_m_per_s`. While a contact rings or lands, force and depth belong to different moments, and their ratio is no
/// property of the surface.
///
/// Real time: `on_tick` is noexcept and allocates nothing.
class DisplayedStiffness {
 public:
  static constexpr double kSpeed_m_per_s = 5e-3;
  static constexpr Nanoseconds kWindow = std::chrono::milliseconds{20};

  explicit DisplayedStiffness(double depth_m_min) : depth_m_min_(depth_m_min) {}

  /// K [N/m], nothing where it is not defined.
  std::optional<double> on_tick(const TickRecord& tick) noexcept;

  /// Whether the last tick was at rest or quasi-static in contact, however deep.
  [[nodiscard]] bool at_rest() const noexcept { return at_rest_; }

 private:
  static constexpr std::int64_t kSlot_ns = 1'000'000;
  static constexpr std::size_t kSlots = static_cast<std::size_t>(kWindow.count() / kSlot_ns);

  /// The depths of one millisecond.
  struct Slot {
    std::int64_t number = std::numeric_limits<std::int64_t>::min();
    double least_m = 0;
    double most_m = 0;
  };

  void add(std::int64_t number, double depth_m) noexcept;
  [[nodiscard]] double change_m(std::int64_t number, double depth_m) const noexcept;

  double depth_m_min_;
  std::array<Slot, kSlots> slots_{};
  std::optional<Nanoseconds> since_;  ///< when this contact began
  double previous_m_ = 0;
  bool at_rest_ = false;
};

}  // namespace forcebound::record
