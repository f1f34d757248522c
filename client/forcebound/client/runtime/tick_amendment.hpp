#pragma once

#include "forcebound/record/tick_record.hpp"

namespace forcebound::client {

/// What a program knows of a tick's force beyond its answer, put into the tick's record before anybody gets that: the
/// summary, the recording, all sinks. Called by the tick: noexcept, no allocation, never waits.
class TickAmendment {
 public:
  virtual ~TickAmendment() = default;

  /// An answer that arrived, before the first tick that uses it.
  virtual void on_force(const record::ForceRecord& force) noexcept = 0;

  virtual void amend(record::TickRecord& tick) noexcept = 0;
};

}  // namespace forcebound::client
