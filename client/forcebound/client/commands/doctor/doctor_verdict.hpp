#pragma once

#include <string>
#include <vector>

#include "forcebound/client/commands/doctor/findings.hpp"

namespace forcebound::client::commands {

/// What to change, and why.
struct Advice {
  enum class Where { network, machine, server };
  Where where = Where::network;
  double urgency = 0;  ///< what was found over what does no harm yet; below 1 it did none in this run
  std::string change;
  std::string why;
};

/// How much of its stiffness a class of scenes displays here, 0 to 1.
struct FeltHere {
  std::string name;
  std::string words;
  double at_client = 1;
  double at_server = 1;
};

/// An examination in words.
struct DoctorVerdict {
  enum class Grade { good, fair, poor };
  Grade network = Grade::good;  ///< the server with it
  Grade machine = Grade::good;
  std::string summary;          ///< one sentence
  std::vector<FeltHere> felt;   ///< behind the median round trip
  std::string scene;            ///< what holds for the scene of this session
  std::vector<Advice> changes;  ///< the most urgent first; empty: nothing needs to change
};

/// Limits below which nothing is felt, by the results in client/README.md and the client's defaults.
struct DoctorLimits {
  double loss = 0.05;            ///< of one way: with as much, every class reached its goal
  double gap_ms = 250;           ///< without a new force: the late-force policy's hold time
  double round_trip_ms = 200;    ///< the longest that was measured with local rendering
  double held_ms = 5;            ///< round trip, where forces are held
  double jitter_ms = 20;         ///< p99 of the round trip above its median
  double at_server_ms = 1;       ///< p99: a tick
  double late_share = 1e-3;      ///< of the ticks
  double exit_latency_us = 100;  ///< of a sleep state: a tenth of a tick
  double drift_ppm = 200;        ///< what the client allows for (client::ClockOffset)
};

[[nodiscard]] const char* name_of(DoctorVerdict::Grade grade) noexcept;
[[nodiscard]] const char* name_of(Advice::Where where) noexcept;

[[nodiscard]] DoctorVerdict doctor_verdict(const DoctorFindings& findings, const DoctorLimits& limits = {});

}  // namespace forcebound::client::commands
