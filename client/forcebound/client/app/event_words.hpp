#pragma once

#include <spdlog/common.h>

#include <string>

#include "forcebound/client/session/event.hpp"

namespace forcebound::client {

/// An event as a line of the log, and how grave it is.
struct EventWords {
  spdlog::level::level_enum level = spdlog::level::info;
  std::string text;
  std::string simulated{};  ///< what the server simulates, if it is what the event tells
};

[[nodiscard]] EventWords words_of(const Event& event);

/// "250 ms", "1.20 s".
[[nodiscard]] std::string in_words(time::Nanoseconds duration);

}  // namespace forcebound::client
