#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "tests/support/drivers/stand_in.hpp"

namespace forcebound::test {

/// What Haply's Inverse service says and does, with a simulated device in place of an Inverse3: its side of the JSON
/// messages, without their transport. Version 3.1 takes a force by `values` alone; 3.5 takes `vector` too and numbers
/// its sessions. As the real one it tells a state for each message, and lets go of a force when the session ends or
/// once no other came for the device's hold time. Any thread may call anything.
class InverseService {
 public:
  InverseService(StandIn& device, bool numbers_sessions) : device_(device), numbers_sessions_(numbers_sessions) {}

  [[nodiscard]] std::string begin_session();
  void end_session();
  [[nodiscard]] std::string answer(std::string_view message);

  /// `plug`, `unplug`, `press MASK`, `mute`, `talk` (the end of mute and say), `say TEXT` and `say-bytes N` in place of
  /// each message, `grip none|wired|wireless`, `turn W X Y Z`, `look TEXT`, `keep` the last force when a session ends.
  /// False: none of these.
  bool obey(const std::string& line);

  void wait_while_muted() const { muted_.wait(true); }

 private:
  [[nodiscard]] nlohmann::json inventory();
  [[nodiscard]] nlohmann::json states();
  void add_grip(nlohmann::json& message, std::uint32_t buttons) const;
  void obey(const nlohmann::json& command);
  [[nodiscard]] std::string instead_of(const nlohmann::json& message) const;
  void look(const std::string& text);

  std::mutex guard_;
  StandIn& device_;
  bool numbers_sessions_;
  bool enabled_ = false;
  bool keeps_ = false;
  std::atomic<bool> muted_{false};
  std::string said_{};
  std::string grip_ = "wireless";
  std::array<double, 4> turn_{1, 0, 0, 0};
  std::string spelling_ = "none";
  std::string basis_ = "none";
  int sessions_ = 0;
};

}  // namespace forcebound::test
