#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tests/process/programs.hpp"
#include "tests/tools/temporary_folder.hpp"

/// Clients that lead a robot, and what is told of it.
namespace forcebound::test {

/// A hand that waits, goes 44 mm down within two seconds, which is 4 mm into the wall, stays and comes back; again and
/// again, since a robot does not follow what the hand did while a busy machine kept its leader silent.
class RecordedHand {
 public:
  RecordedHand() {
    constexpr int kCycles = 50;
    constexpr double kCycle_s = 12;
    std::string csv = "time_s,x_m,y_m,z_m\n";
    for (int i = 0; i < kCycles; ++i) {
      // Pauses begin and end with two rows, since between rows the hand moves smoothly: with one it would drift.
      const double begin_s = i * kCycle_s;
      csv += row(begin_s, 0) + row(begin_s + 1.9, 0) + moved(begin_s + 2, 0, kDown_m) + row(begin_s + 7.9, kDown_m) +
             moved(begin_s + 8, kDown_m, 0);
    }
    write_file(folder_.file("hand.csv"), csv);
  }

  [[nodiscard]] Words options() const {
    return {"--device", "firm-3dof", "--operator",
            "replay:" + folder_.file("hand.csv") + ",mass_kg=0.2,stiffness_N_per_m=2000,damping_N_s_per_m=25"};
  }

 private:
  static constexpr double kDown_m = -0.044;

  static std::string row(double time_s, double z_m) {
    return std::to_string(time_s) + ",0,0," + std::to_string(z_m) + "\n";
  }

  /// Two seconds from one height to another, and a tenth at it.
  static std::string moved(double begin_s, double from_m, double to_m) {
    constexpr int kRows = 20;
    std::string rows;
    for (int i = 0; i <= kRows; ++i) rows += row(begin_s + 0.1 * i, from_m + (to_m - from_m) * i / kRows);
    return rows + row(begin_s + 2.1, to_m);
  }

  TemporaryFolder folder_;
};

inline Words and_also(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// Whether `text` has all of them, each after the one before.
inline testing::AssertionResult has_in_order(const std::string& text, const std::vector<std::string_view>& parts) {
  std::size_t at = 0;
  for (const std::string_view part : parts) {
    const std::size_t found = text.find(part, at);
    if (found == std::string::npos) return testing::AssertionFailure() << "no '" << part << "' in order in:\n" << text;
    at = found + part.size();
  }
  return testing::AssertionSuccess();
}

/// Whether the robot followed without a break: a leader that the machine gives no time is silent, and what its hand
/// moved meanwhile is not followed.
inline bool was_led_all_the_time(const Server& server) {
  const std::string output = server.err();
  return output.find("-> holding") == std::string::npos && output.find("the leader is silent") == std::string::npos &&
         output.find("stopped by itself") == std::string::npos;
}

/// The least P of the robot's port, as the server's totals have it.
inline std::optional<double> least_port_millijoules(const std::string& totals) {
  constexpr std::string_view kBefore = "passivity: least P and store ";
  const std::size_t at = totals.find(kBefore);
  if (at == std::string::npos) return std::nullopt;
  return std::stod(totals.substr(at + kBefore.size()));
}

inline constexpr double kPassiveLeast_mJ = -1e-6;
inline constexpr double kPassiveLeast_J = -1e-9;

}  // namespace forcebound::test
