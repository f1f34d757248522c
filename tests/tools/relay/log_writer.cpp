#include "tests/tools/relay/log_writer.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace forcebound::relay {

LogWriter::LogWriter(const std::string& file, Nanoseconds start, std::function<void(const std::string&)> incomplete)
    : file_(open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644)),
      rows_(start),
      incomplete_(std::move(incomplete)) {
  if (file_ < 0) throw std::runtime_error(file + ": cannot write the log: " + std::strerror(errno));
  text_ = PacketRows::kHeader;
  // Exceeding the allowed file size counts as a full disk; it must not end the program.
  std::signal(SIGXFSZ, SIG_IGN);
  thread_ = std::thread([this] { run(); });
}

LogWriter::~LogWriter() {
  if (thread_.joinable()) finish();
}

void LogWriter::on_verdict(Direction direction, const netem::Verdict& verdict) noexcept {
  if (!events_.push({verdict, direction, false})) verdicts_refused_.fetch_add(1, std::memory_order_relaxed);
}

void LogWriter::on_departure(Direction direction, const netem::Verdict& verdict) noexcept {
  // If there is no room, the row stays "waiting": it is written, but without its delay.
  static_cast<void>(events_.push({verdict, direction, true}));
}

LogResult LogWriter::finish() {
  stop_ = true;
  thread_.join();
  drain();
  write(rows_.take_all(text_));
  if (close(file_) != 0 && result_.problem.empty()) result_.problem = std::strerror(errno);
  result_.problem = problem();
  result_.missing += verdicts_refused_;
  return result_;
}

void LogWriter::run() {
  using namespace std::chrono_literals;
  while (!stop_) {
    drain();
    report_if_incomplete();
    std::this_thread::sleep_for(20ms);
  }
}

std::string LogWriter::problem() const {
  if (!result_.problem.empty() || verdicts_refused_ == 0) return result_.problem;
  return "the disk was slower than the network";
}

void LogWriter::report_if_incomplete() {
  if (!incomplete_) return;
  const std::string why = problem();
  if (!why.empty()) std::exchange(incomplete_, {})(why);
}

void LogWriter::drain() {
  Event event;
  while (events_.pop(event)) {
    if (event.departed) {
      rows_.on_departure(event.direction, event.verdict);
    } else {
      rows_.on_verdict(event.direction, event.verdict);
    }
  }
  write(rows_.take_ready(text_));
}

void LogWriter::write(std::size_t rows) {
  if (result_.problem.empty() && !write_text()) result_.problem = std::strerror(errno);
  (result_.problem.empty() ? result_.written : result_.missing) += rows;
  text_.clear();
}

bool LogWriter::write_text() {
  for (std::size_t done = 0; done < text_.size();) {
    const ssize_t written = ::write(file_, text_.data() + done, text_.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    done += static_cast<std::size_t>(written);
  }
  text_.clear();
  return true;
}

}  // namespace forcebound::relay
