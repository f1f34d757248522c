#pragma once

#include <functional>
#include <string>

#include "forcebound/client/app/event_words.hpp"
#include "forcebound/client/app/late_force_log.hpp"
#include "forcebound/client/app/live_line.hpp"
#include "forcebound/client/app/options.hpp"
#include "forcebound/client/runtime/event_queue.hpp"

namespace forcebound::client {

/// The output of a run: log lines for events, and on a terminal a live line.
class Screen {
 public:
  /// Told of each line of the log too.
  using Also = std::function<void(const EventWords& words)>;

  /// All must outlive it.
  Screen(const Options& options, const LiveLine& line, EventQueue& events, Also also = {});

  /// To be called several times a second. @param server as Client::server_in_words
  void refresh(time::Nanoseconds now, time::Nanoseconds elapsed, const std::string& server);

  /// Logs that the recording has become incomplete.
  void report_recording_fault(const std::string& fault) const;

  /// Logs where the server is and what handshakes came to, or why it is not found or lets nobody in.
  void report_news(const std::string& news);
  void report_problem(const std::string& problem);

  /// Erases the live line and logs the remaining events.
  void end(time::Nanoseconds now);

 private:
  void warn_of_no_answer(const std::string& server);
  void log_events(time::Nanoseconds now);
  void say(const EventWords& words) const;
  void log_late_force(const LateForceLog::Line& line) const;
  void clear() const;

  bool live_;
  bool no_answer_reported_ = false;
  bool problem_reported_ = false;  ///< and no news since: why there is no answer is known
  const Options& options_;
  const LiveLine& line_;
  EventQueue& events_;
  Also also_;
  Event event_;
  LateForceLog late_force_;
};

}  // namespace forcebound::client
