#pragma once

#include <memory>
#include <string>

#include "forcebound/record/run_info.hpp"
#include "forcebound/record/tick_record.hpp"
#include "tests/tools/lab/soak/soak_case.hpp"

namespace forcebound::lab {

class LedgerInLongDouble;

/// Checks the invariants on every tick of a run, and keeps the first violation.
///
///     everything finite;  |f| <= f_max;  torque likewise, of which the lines below hold too
///     f along the request and not longer, for a law that guarantees it, where motors do not round
///     P(t) >= -1e-9 J, for a law that guarantees it for this device and this clock
///     the energy that such a law may spend never exceeds P(t)
///     the ledger equals its recomputation in long double, where the record has all that it needs
class Invariants final : public record::TickSink {
 public:
  explicit Invariants(const SoakCase& drawn);
  ~Invariants() override;
  Invariants(const Invariants&) = delete;
  Invariants& operator=(const Invariants&) = delete;

  void on_tick(const record::TickRecord& tick) noexcept override;
  void on_force(const record::ForceRecord&) noexcept override { ++forces_; }

  /// At the end: the client's counts agree with the ticks and with the server's, and the session came back after the
  /// last fault.
  void finish(const record::RunTotals& totals, bool active, const server::ServerCounters& server);

  /// Empty: no violation.
  [[nodiscard]] const std::string& broken() const noexcept { return broken_; }

  [[nodiscard]] double least_P_J() const noexcept { return least_P_J_; }
  [[nodiscard]] std::uint64_t ticks() const noexcept { return ticks_; }
  [[nodiscard]] std::uint64_t recomputed() const noexcept { return recomputed_; }

 private:
  void check_force(const record::TickRecord& tick);
  void check_energy(const record::TickRecord& tick);
  template <typename... Parts>
  void fail(const record::TickRecord& tick, const Parts&... parts);

  const SoakCase& case_;
  std::unique_ptr<LedgerInLongDouble> ledger_;
  std::string broken_;
  double least_P_J_ = 0;
  std::uint64_t ticks_ = 0;
  std::uint64_t motions_ = 0;
  std::uint64_t forces_ = 0;
  std::uint64_t recomputed_ = 0;
};

}  // namespace forcebound::lab
