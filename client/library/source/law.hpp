#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include "forcebound/baselines/running_law.hpp"
#include "library/forcebound.h"

/// What fb_law points at.
struct fb_law {
  fb_law(const forcebound::control::DeviceFacts& facts, const std::string& name,
         forcebound::control::LawOptions options)
      : running(facts, name, std::move(options)),
        force_N(forcebound::control::Vector::Zero(facts.degrees_of_freedom())) {}

  forcebound::baselines::RunningLaw running;
  forcebound::control::Vector force_N;  ///< that the last tick gave
  std::uint64_t calls_refused = 0;
};
