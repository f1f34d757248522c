#pragma once

#include <chrono>
#include <string>

namespace forcebound::program {

/// Progress and remaining time of long work, in a line on stderr that overwrites itself and is erased at the end. Only
/// on a terminal, and only once the work has taken half a second.
class Progress {
 public:
  Progress() : Progress(on_terminal()) {}
  explicit Progress(bool live) : live_(live) {}
  ~Progress() { clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// @param share done, 0 to 1
  /// @param words the state: "12 of 48 runs"
  void report(double share, const std::string& words);

  /// Erases the line, so that something else can be printed; the next `report` writes it again.
  void clear();

  /// "12 of 48 runs, 25 %, about 40 s left", cut to the columns of a terminal.
  [[nodiscard]] static std::string line(double share, const std::string& words, double elapsed_s);

 private:
  using Clock = std::chrono::steady_clock;
  static bool on_terminal();

  bool live_;
  bool shown_ = false;
  Clock::time_point begin_ = Clock::now();
  Clock::time_point next_ = begin_ + std::chrono::milliseconds{500};
};

}  // namespace forcebound::program
