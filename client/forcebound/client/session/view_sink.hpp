#pragma once

#include "forcebound/wire/messages.hpp"

namespace forcebound::client {

/// Receives what the server tells of how the scene looks. Called by the tick: noexcept, no allocation, never waits.
class ViewSink {
 public:
  virtual ~ViewSink() = default;
  virtual void on_view(const wire::ViewPiece& piece) noexcept = 0;
};

}  // namespace forcebound::client
