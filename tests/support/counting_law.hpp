#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/control/law_registry.hpp"
#include "forcebound/control/transparent_law.hpp"

namespace forcebound::test {

/// What a CountingLaw and its server-side law received from each other.
struct CountLog {
  std::vector<double> ticks_received;          ///< at the server: number of ticks of the device
  std::vector<double> intervals_s;             ///< at the server
  std::vector<double> answers_received;        ///< at the device: number of the server's answers in this session
  std::vector<double> ticks_confirmed;         ///< at the device: the tick count last received by the server
  std::vector<std::size_t> server_side_began;  ///< the device's count at each start
};

/// A law without a bound that exchanges counts with its server-side law, which asks the scene `kShift_m` beyond the
/// device and doubles the force.
class CountingLaw final : public control::PassivityLaw {
 public:
  static constexpr double kShift_m = 1e-3;

  CountingLaw(const control::DeviceFacts& facts, CountLog& log)
      : none_(facts.degrees_of_freedom(), facts.period_s), log_(log) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "counting"; }
  [[nodiscard]] std::string_view server_law() const noexcept override { return "counting"; }
  void credit(const control::Motion& motion) noexcept override {
    ++ticks_;
    none_.credit(motion);
  }
  void lose(const control::Motion& motion) noexcept override { none_.lose(motion); }
  [[nodiscard]] control::Vector bound(const control::Vector& request_N) noexcept override { return request_N; }
  void commit(const control::Vector& force_N) noexcept override { none_.commit(force_N); }
  [[nodiscard]] double energy_J() const noexcept override { return none_.energy_J(); }
  [[nodiscard]] control::ServerLawNumbers outgoing() const noexcept override {
    return control::ServerLawNumbers::Constant(1, ticks_);
  }
  void incoming(const control::ServerLawNumbers& numbers) noexcept override {
    if (numbers.rows() != 2) return;
    log_.answers_received.push_back(numbers[0]);
    log_.ticks_confirmed.push_back(numbers[1]);
  }
  void begin_server_side() noexcept override { log_.server_side_began.push_back(log_.answers_received.size()); }

 private:
  control::TransparentLaw none_;
  CountLog& log_;
  double ticks_ = 0;
};

class CountingServerSideLaw final : public control::ServerSideLaw {
 public:
  explicit CountingServerSideLaw(CountLog& log) : log_(log) {}

  [[nodiscard]] control::Vector place(const Received& received) noexcept override {
    if (received.numbers.rows() > 0) ticks_ = received.numbers[0];
    log_.ticks_received.push_back(ticks_);
    log_.intervals_s.push_back(received.interval_s);
    return received.position + control::Vector::Constant(received.position.rows(), CountingLaw::kShift_m);
  }
  [[nodiscard]] Reply answer(const control::Vector& force_N) noexcept override {
    control::ServerLawNumbers numbers(2);
    numbers << ++answers_, ticks_;
    return {.force = 2 * force_N, .numbers = numbers};
  }

 private:
  CountLog& log_;
  double ticks_ = 0;
  double answers_ = 0;
};

/// The shipped laws and "counting". The log must outlive the laws made, and holds some hundreds of thousands of ticks
/// before it allocates.
inline control::LawRegistry laws_with_counting(CountLog& log) {
  constexpr std::size_t kTicks = 100'000;
  for (auto* numbers : {&log.ticks_received, &log.intervals_s, &log.answers_received, &log.ticks_confirmed})
    numbers->reserve(kTicks);
  log.server_side_began.reserve(100);
  control::LawRegistry laws = baselines::shipped_laws();
  laws.add({.name = "counting",
            .summary = "exchanges counts",
            .make = [&log](const control::DeviceFacts& facts,
                           const control::LawOptions&) { return std::make_unique<CountingLaw>(facts, log); },
            .make_server_side = [&log](int) { return std::make_unique<CountingServerSideLaw>(log); }});
  return laws;
}

}  // namespace forcebound::test
