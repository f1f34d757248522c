#include "forcebound/program/log.hpp"

#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <chrono>
#include <cstdint>
#include <ctime>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <utility>

#include "forcebound/text/printable.hpp"
#include "forcebound/text/terminal.hpp"

namespace forcebound::program {
namespace {

/// The message of a line, which may have words of clients, files and recordings.
class PrintableMessage final : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& line, const std::tm& /*time*/, spdlog::memory_buf_t& out) override {
    const std::string message = text::printable({line.payload.data(), line.payload.size()});
    out.append(message.data(), message.data() + message.size());
  }

  [[nodiscard]] std::unique_ptr<spdlog::custom_flag_formatter> clone() const override {
    return std::make_unique<PrintableMessage>();
  }
};

bool as_json = false;

constexpr long long kMicro = 1'000'000;

/// "2026-11-24T10:12:13.123456Z"
std::string utc(long long time_us) {
  const auto seconds = static_cast<std::time_t>(time_us / kMicro);
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  std::array<char, 32> text{};
  const std::size_t length = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S.", &parts);
  const std::string digits = std::to_string(kMicro + time_us % kMicro);
  return std::string(text.data(), length) + digits.substr(1) + "Z";
}

/// As the text log calls it.
std::string_view name_of(spdlog::level::level_enum level) {
  if (level >= spdlog::level::err) return "error";
  return level == spdlog::level::warn ? "warning" : "info";
}

long long since_1970_us(std::chrono::system_clock::time_point time) {
  return std::chrono::duration_cast<std::chrono::microseconds>(time.time_since_epoch()).count();
}

class JsonFormatter final : public spdlog::formatter {
 public:
  void format(const spdlog::details::log_msg& line, spdlog::memory_buf_t& out) override {
    const std::string text = json_line({line.logger_name.data(), line.logger_name.size()}, name_of(line.level),
                                       {line.payload.data(), line.payload.size()}, since_1970_us(line.time));
    out.append(text.data(), text.data() + text.size());
  }

  [[nodiscard]] std::unique_ptr<spdlog::formatter> clone() const override { return std::make_unique<JsonFormatter>(); }
};

}  // namespace

class LogListener::Sink final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  using Listener = std::function<void(const std::string&, const std::string&)>;
  explicit Sink(Listener listener) : listener_(std::move(listener)) {}

 private:
  void sink_it_(const spdlog::details::log_msg& line) override {
    listener_(std::string(name_of(line.level)), text::printable({line.payload.data(), line.payload.size()}));
  }
  void flush_() override {}

  Listener listener_;
};

LogListener::LogListener(std::function<void(const std::string& level, const std::string& text)> listener)
    : sink_(std::make_shared<Sink>(std::move(listener))) {
  spdlog::default_logger()->sinks().push_back(sink_);
}

LogListener::~LogListener() { std::erase(spdlog::default_logger()->sinks(), sink_); }

void add_log_option(CLI::App& app) {
  app.add_flag_function(
      "--log-json", [](std::int64_t) { set_logs_json(true); },
      "write the log as lines of JSON, and nothing else to standard error");
}

bool logs_json() noexcept { return as_json; }

void set_logs_json(bool json) noexcept { as_json = json; }

std::string json_line(std::string_view program, std::string_view level, std::string_view text, long long time_us) {
  const nlohmann::ordered_json line{{"time", utc(time_us)}, {"level", level},
                                    {"program", program},   {"version", FORCEBOUND_VERSION},
                                    {"pid", getpid()},      {"text", text::printable(text)}};
  return line.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

std::string json_line_now(std::string_view program, std::string_view level, std::string_view text) {
  return json_line(program, level, text, since_1970_us(std::chrono::system_clock::now()));
}

void log_to_stderr(const std::string& program) {
  if (as_json) {
    spdlog::set_default_logger(spdlog::stderr_logger_mt(program));
    spdlog::set_formatter(std::make_unique<JsonFormatter>());
    return;
  }
  const bool coloured = text::colour_for(STDERR_FILENO) != text::Colour::none;
  spdlog::set_default_logger(
      spdlog::stderr_color_mt(program, coloured ? spdlog::color_mode::automatic : spdlog::color_mode::never));
  auto formatter = std::make_unique<spdlog::pattern_formatter>();
  formatter->add_flag<PrintableMessage>('*').set_pattern("%H:%M:%S.%e %n %^%l%$: %*");
  spdlog::set_formatter(std::move(formatter));
}

}  // namespace forcebound::program
