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

/// A hand that waits, goes 44 mm down within two seconds, which is 4 mm into the wall, and stays.
class RecordedHand {
 public:
  RecordedHand() {
    std::string csv = "time_s,x_m,y_m,z_m\n0,0,0,0\n2,0,0,0\n";
    constexpr int kRows = 20;
    for (int i = 1; i <= kRows; ++i) {
      csv += std::to_string(2 + 0.1 * i) + ",0,0," + std::to_string(-0.044 * i / kRows) + "\n";
    }
    // Two rows, since between rows the hand moves smoothly: with one it would drift for a minute.
    write_file(folder_.file("hand.csv"), csv + "4.1,0,0,-0.044\n600,0,0,-0.044\n");
  }

  [[nodiscard]] Words options() const {
    return {"--device", "firm-3dof", "--operator",
            "replay:" + folder_.file("hand.csv") + ",mass_kg=0.2,stiffness_N_per_m=2000,damping_N_s_per_m=25"};
  }

 private:
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
  constexpr std::string_view kBefore = "passivity: least P ";
  const std::size_t at = totals.find(kBefore);
  if (at == std::string::npos) return std::nullopt;
  return std::stod(totals.substr(at + kBefore.size()));
}

inline constexpr double kPassiveLeast_mJ = -1e-6;
inline constexpr double kPassiveLeast_J = -1e-9;

}  // namespace forcebound::test
