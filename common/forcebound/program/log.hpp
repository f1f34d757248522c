#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace CLI {
class App;
}

namespace forcebound::program {

/// Sends log lines to stderr, stdout being for results, in the pattern of all programs: time, program, level, and one
/// event a line however long it is, so that grep finds it whole; control characters in it are made printable.
/// "10:12:13.123 forcebound-server info: listening on
/// ..."
///
/// With --log-json each is a line of JSON instead, and stderr has nothing else:
///
///     {"time":"2026-11-24T10:12:13.123456Z","level":"info","program":"forcebound-server","version":"0.2.0","pid":7,
///      "text":"listening on ..."}
///
/// `level` is one of info, warning and error; `time` is UTC. What ends a program is such a line too.
void log_to_stderr(const std::string& program);

/// Is told each line of the log too, printable, on the thread that logs it, until it is destroyed. It must begin and
/// end while no other thread logs.
class LogListener {
 public:
  /// @param told level is info, warning or error
  explicit LogListener(std::function<void(const std::string& level, const std::string& text)> told);
  ~LogListener();
  LogListener(const LogListener&) = delete;
  LogListener& operator=(const LogListener&) = delete;

 private:
  class Sink;
  std::shared_ptr<Sink> sink_;
};

/// Gives a program --log-json.
void add_log_option(CLI::App& app);

/// Whether this process writes its log as JSON: from when its command line is read on.
[[nodiscard]] bool logs_json() noexcept;
void set_logs_json(bool json) noexcept;

/// One line of the log as JSON, with its line feed. @param time_us since 1970
[[nodiscard]] std::string json_line(std::string_view program, std::string_view level, std::string_view text,
                                    long long time_us);

/// The same of now.
[[nodiscard]] std::string json_line_now(std::string_view program, std::string_view level, std::string_view text);

}  // namespace forcebound::program
