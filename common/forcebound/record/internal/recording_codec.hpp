#pragma once

#include <string>
#include <string_view>

#include "forcebound/record/server_records.hpp"
#include "forcebound/record/tick_record.hpp"
#include "forcebound/record/topics.hpp"

/// Records as Protocol Buffers messages of proto/forcebound/v1. Private to this folder.
namespace forcebound::record {

/// Of a force that was sent in recordings of before 0.3; now it is a ForceRecord without a time of receipt.
inline constexpr std::string_view kEarlierSentForceSchema = "forcebound.v1.EnvironmentForce";

inline constexpr const char* kInfoMetadata = "forcebound.run";
inline constexpr const char* kTotalsMetadata = "forcebound.totals";

std::string encode(const TickRecord& tick);
std::string encode(const ForceRecord& force);
std::string encode(const wire::MotionSample& motion);
std::string encode(const SentForceRecord& force);

/// @throws std::invalid_argument saying what is wrong: not that message, a vector of more than six rows, a time beyond
/// 73 years, an unknown state.
void decode(std::string_view bytes, TickRecord& tick);
/// @returns whether it was received; else it was sent, and its times of receipt are zero
bool decode(std::string_view bytes, ForceRecord& force);
void decode(std::string_view bytes, wire::MotionSample& motion);
void decode(std::string_view bytes, wire::EnvironmentForce& force);

}  // namespace forcebound::record
