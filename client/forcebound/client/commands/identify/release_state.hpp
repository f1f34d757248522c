#pragma once

namespace forcebound::client::commands::identify {

/// Of one slide, where its force ended.
struct ReleaseState {
  bool used = false;    ///< too short around the release, or not released
  double progress = 0;  ///< where the force ended
  double speed = 0;     ///< and how fast it was there
};

}  // namespace forcebound::client::commands::identify
