#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace forcebound::client::commands::identify {

/// One tick of a slide. Joint quantities: [m] and [N], or [rad] and [N m].
struct SlideSample {
  double latched_s = 0;    ///< stamp of the reading
  double progress = 0;     ///< of the joint, along the slide's direction since its beginning
  double commanded_s = 0;  ///< time of the command
  double force = 0;        ///< commanded from then on, along the slide's direction
};

/// One joint pushed by a constant force from rest, then let go. The first sample is the tick of the first push.
struct Slide {
  enum class End : std::uint8_t {
    zero,     ///< let go by a command of zero force
    silence,  ///< by sending no command any more: the device has to let go
  };
  int joint = 0;
  double direction = 1;  ///< 1 or -1
  double begin = 0;      ///< position of the joint at the beginning, from the middle of its range
  End end = End::zero;
  std::size_t released = 0;   ///< sample at which zero was commanded, or the first without a command
  bool still_pushed = false;  ///< let go by silence, but the force did not end while that could be watched
  std::vector<SlideSample> samples{};

  /// When the last command before the release, or that of the release, was sent: what delays are counted from.
  [[nodiscard]] double released_s() const noexcept {
    return samples[end == End::zero ? released : released - 1].commanded_s;
  }
  /// The constant force before the release.
  [[nodiscard]] double push() const noexcept { return samples[released - 1].force; }
};

}  // namespace forcebound::client::commands::identify
