#pragma once

#include <cstdint>

#include "forcebound/v1/session.pb.h"
#include "forcebound/wire/messages.hpp"

/// Motions and forces as Protocol Buffers messages, in one place for datagrams and recordings: a new field is a line in
/// the schema, in the struct and in each direction here. Private to wire and record.
namespace forcebound::wire {

/// Invalid values in a message: the first field of each kind. All other fields were converted.
struct Flaws {
  struct Flaw {
    const char* field = nullptr;  ///< null: none
    std::int64_t got = 0;
    std::int64_t most = 0;
  };

  Flaw time;                ///< further from zero than kTimeMost; the field stays zero
  Flaw rows;                ///< more rows than allowed; the field stays empty
  bool not_finite = false;  ///< some number
};

/// Clears `to` first, which keeps its memory.
void fill(const MotionSample& from, v1::MotionSample& to) noexcept;
void fill(const EnvironmentForce& from, v1::EnvironmentForce& to) noexcept;

[[nodiscard]] Flaws read(const v1::MotionSample& from, MotionSample& to) noexcept;
[[nodiscard]] Flaws read(const v1::EnvironmentForce& from, EnvironmentForce& to) noexcept;

}  // namespace forcebound::wire
