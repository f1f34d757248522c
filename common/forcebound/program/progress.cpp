#include "forcebound/program/progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "forcebound/text/numbers.hpp"
#include "forcebound/text/terminal.hpp"

namespace forcebound::program {
namespace {

constexpr std::chrono::milliseconds kBetween{200};

std::string in_words(double seconds) {
  return seconds < 99.5 ? text::fixed(std::ceil(seconds), 0) + " s" : text::fixed(std::ceil(seconds / 60), 0) + " min";
}

}  // namespace

bool Progress::on_terminal() { return isatty(STDERR_FILENO) != 0; }

std::string Progress::line(double share, const std::string& words, double elapsed_s) {
  const double done = std::clamp(share, 0.0, 1.0);
  std::string line = words + ", " + text::fixed(100 * done, 0) + " %";
  if (done > 0) line += ", about " + in_words(elapsed_s / done * (1 - done)) + " left";
  return line.substr(0, text::kColumns - 1);
}

void Progress::report(double share, const std::string& words) {
  const auto now = Clock::now();
  if (!live_ || now < next_) return;
  next_ = now + kBetween;
  shown_ = true;
  const double elapsed_s = std::chrono::duration<double>(now - begin_).count();
  std::fprintf(stderr, "\r%s\033[K", line(share, words, elapsed_s).c_str());
}

void Progress::clear() {
  if (!shown_) return;
  shown_ = false;
  std::fputs("\r\033[K", stderr);
}

}  // namespace forcebound::program
