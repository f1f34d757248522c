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

constexpr Nanoseconds kNoAnswerReported = std::chrono::seconds{2};

const char* const kClearLine = "\r\033[K";

/// The terminal's columns, which may change: a longer line would wrap, and could not be overwritten.
std::size_t columns() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : text::kColumns;
}

}  // namespace

Screen::Screen(const Options& options, const LiveLine& line, EventQueue& events, Also also)
    : live_(!options.quiet && isatty(STDERR_FILENO) != 0),
      options_(options),
      line_(line),
      events_(events),
      also_(std::move(also)) {}

void Screen::refresh(Nanoseconds now, Nanoseconds elapsed, const std::string& server) {
  if (elapsed > kNoAnswerReported && !options_.client.once) warn_of_no_answer(server);
  log_events(now);
  if (live_) std::fprintf(stderr, "%s%s", kClearLine, line_.text(columns() - 1).c_str());
}

void Screen::end(Nanoseconds now) {
  clear();
  live_ = false;
  log_events(now);
  if (const auto line = late_force_.take_rest()) log_late_force(*line);
}

void Screen::report_recording_fault(const std::string& fault) const {
  say({spdlog::level::err, fault + "; the run goes on"});
}

void Screen::report_news(const std::string& news) {
  problem_reported_ = false;
  say({spdlog::level::info, news});
}

void Screen::report_problem(const std::string& problem) {
  problem_reported_ = true;
  say({spdlog::level::warn, problem + "; retrying"});
}

void Screen::clear() const {
  if (live_) std::fputs(kClearLine, stderr);
}

void Screen::warn_of_no_answer(const std::string& server) {
  if (line_.state() != record::SessionState::connecting || problem_reported_) return;
  if (std::exchange(no_answer_reported_, true)) return;
  say({spdlog::level::warn, "no answer from " + server + " yet; retrying"});
}

void Screen::log_events(Nanoseconds now) {
  const auto log_due = [&] {
    if (const auto line = late_force_.take(now)) log_late_force(*line);
  };
  while (events_.take(event_)) {
    if (LateForceLog::concerns(event_.kind)) {
      late_force_.store(event_);
      log_due();
    } else {
      say(words_of(event_));
    }
  }
  log_due();
}

void Screen::say(const EventWords& words) const {
  clear();
  spdlog::log(words.level, "{}", words.text);
  if (also_) also_(words);
}

void Screen::log_late_force(const LateForceLog::Line& line) const {
  Event event;
  event.kind = line.kind;
  event.duration = line.duration;
  EventWords words = words_of(event);
  if (line.left_out > 0) words.text += fmt::format(" (changes before it, not shown: {})", line.left_out);
  say(words);
}

}  // namespace forcebound::client
