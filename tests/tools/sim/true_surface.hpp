#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "forcebound/device/simulated/simulated_device.hpp"
#include "forcebound/record/tick_record.hpp"
#include "forcebound/scene/scene_state.hpp"

namespace forcebound::sim {

/// Passes ticks from the session to its sinks with the true depth of the device: in the scene itself, at the device's
/// true position, now. The session knows only the plane of an answer that crossed the network.
///
/// In a scene with tissue or bodies the surface depends on the past, which only the server knows: there ticks are
/// passed on unchanged.
class TrueSurface final : public record::TickSink {
 public:
  /// @param scene null: the surface is not known
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
