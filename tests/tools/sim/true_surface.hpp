#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "forcebound/device/simulated/simulated_device.hpp"
#include "forcebound/record/tick_record.hpp"
#include "forcebound/scene/scene_state.hpp"

namespace forcebound::sim {

/// Stands between the session and what looks at its ticks, and tells these how deep the device truly is: in the scene
/// itself, at the device's true position, now. What the session knows is the plane of an answer that crossed the
/// network.
///
/// A scene with tissue or bodies has its surface where its past has put it, which nobody but the server knows: there
/// the ticks stay as the session wrote them down.
class TrueSurface final : public record::TickSink {
 public:
  /// @param device must outlive this
  TrueSurface(const std::shared_ptr<const scene::Scene>& scene, const device::SimulatedDevice& device);

  /// @param sinks must outlive this
  void hand_on_to(const std::vector<record::TickSink*>& sinks);

  [[nodiscard]] bool known() const noexcept { return scene_.has_value(); }

  void on_tick(const record::TickRecord& tick) noexcept override;
  void on_force(const record::ForceRecord& force) noexcept override;

 private:
  const device::SimulatedDevice& device_;
  std::optional<scene::SceneState> scene_;
  std::vector<record::TickSink*> sinks_;
  record::TickRecord tick_;
};

}  // namespace forcebound::sim
