#include "forcebound/client/app/screen.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>
#include <string>
#include <utility>

#include "forcebound/text/terminal.hpp"

namespace forcebound::client {
namespace {

constexpr Nanoseconds kNoAnswerTold = std::chrono::seconds{2};

const char* const kClearLine = "\r\033[K";

/// The terminal's columns, which may change: a longer line would wrap, and could not be overwritten.
std::size_t columns() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : text::kColumns;
}

std::string in_words(Nanoseconds duration) {
  const double seconds = time::to_seconds(duration);
  return seconds < 1 ? fmt::format("{:.0f} ms", seconds * 1e3) : fmt::format("{:.2f} s", seconds);
}

}  // namespace

Screen::Screen(const Options& options, const LiveLine& line, EventQueue& events)
    : live_(!options.quiet && isatty(STDERR_FILENO) != 0), options_(options), line_(line), events_(events) {}

void Screen::refresh(Nanoseconds now, Nanoseconds elapsed) {
  if (elapsed > kNoAnswerTold && !options_.once) warn_of_no_answer();
  log_events(now);
  if (live_) std::fprintf(stderr, "%s%s", kClearLine, line_.text(columns() - 1).c_str());
}

void Screen::end(Nanoseconds now) {
  clear();
  live_ = false;
  log_events(now);
  if (const auto line = late_force_.take_rest()) log_late_force(*line);
}

void Screen::tell_recording_fault(const std::string& fault) const {
  clear();
  spdlog::error("{}; the run goes on", fault);
}

void Screen::tell_security(const std::string& news) const {
  clear();
  spdlog::info("{}", news);
}

void Screen::tell_security_problem(const std::string& problem) const {
  clear();
  spdlog::warn("{}; retrying", problem);
}

void Screen::clear() const {
  if (live_) std::fputs(kClearLine, stderr);
}

void Screen::warn_of_no_answer() {
  if (line_.state() != record::SessionState::connecting || std::exchange(no_answer_told_, true)) return;
  clear();
  spdlog::warn("no answer from {} yet; retrying", options_.server);
}

void Screen::log_events(Nanoseconds now) {
  const auto log_due = [&] {
    if (const auto line = late_force_.take(now)) log_late_force(*line);
  };
  while (events_.take(event_)) {
    if (LateForceLog::concerns(event_.kind)) {
      late_force_.note(event_);
      log_due();
    } else {
      log_connection();
    }
  }
  log_due();
}

void Screen::log_connection() const {
  clear();
  switch (event_.kind) {
    case Event::Kind::welcomed:
      return spdlog::info("connected; simulated: {}", event_.words());
    case Event::Kind::refused:
      return spdlog::error("refused by the server: {}", event_.words());
    case Event::Kind::session_unknown:
      return spdlog::warn("the server does not know this session (any more); requesting another");
    case Event::Kind::server_left:
      return spdlog::warn("the server ended the session; requesting another");
    case Event::Kind::scene_here:
      return spdlog::info("the scene has arrived: its static parts run at the client");
    case Event::Kind::scene_refused:
      return spdlog::error("the server's scene is refused, its forces are held instead: {}", event_.words());
    case Event::Kind::limited_for_safety:
      return spdlog::warn("{}", event_.words());
    case Event::Kind::device_gone:
      return spdlog::warn("no readings of the device, and no force until there are: {}",
                          event_.words().empty() ? "no reason given" : event_.words());
    case Event::Kind::device_back:
      return spdlog::info("the device is back after {}", in_words(event_.duration));
    case Event::Kind::force_fading:
    case Event::Kind::force_dropped:
    case Event::Kind::force_fresh:
      return;  // logged apart
  }
}

void Screen::log_late_force(const LateForceLog::Line& line) const {
  clear();
  const std::string duration = in_words(line.duration);
  const std::string others =
      line.left_out == 0 ? "" : fmt::format(" (changes before it, not shown: {})", line.left_out);
  switch (line.kind) {
    case Event::Kind::force_fading:
      return spdlog::warn("forces are {} old: fading{}", duration, others);
    case Event::Kind::force_dropped:
      return spdlog::warn("forces are {} old: zero force{}", duration, others);
    case Event::Kind::force_fresh:
      return spdlog::info("forces are fresh again after {}{}", duration, others);
    default:
      return;  // logged apart
  }
}

}  // namespace forcebound::client
