#pragma once

#include <cstddef>

#include "forcebound/client/commands/identify/slide.hpp"

namespace forcebound::client::commands::identify {

/// phi and psi of s: v phi + u psi is the way in the time s from speed v under u = v' + rate v.
struct Response {
  double decay = 0;
  double phi = 0;
  double psi = 0;
};

[[nodiscard]] Response response(double s, double rate) noexcept;

/// When friction has stopped what moves freely with this speed; it does not start again.
[[nodiscard]] double stopped_s(double speed, double slowing, double rate) noexcept;

/// The samples of a slide that are used for what happens around its release; none: begin == end.
struct Part {
  std::size_t begin = 0;
  std::size_t end = 0;
};

[[nodiscard]] Part part_of(const Slide& slide) noexcept;

/// Mean speed between two samples.
[[nodiscard]] double speed_between(const Slide& slide, std::size_t from, std::size_t to) noexcept;

}  // namespace forcebound::client::commands::identify
