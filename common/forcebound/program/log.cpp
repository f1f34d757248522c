#include "forcebound/program/log.hpp"

#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <ctime>
#include <memory>
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

}  // namespace

void log_to_stderr(const std::string& program) {
  const bool coloured = text::colour_for(STDERR_FILENO) != text::Colour::none;
  spdlog::set_default_logger(
      spdlog::stderr_color_mt(program, coloured ? spdlog::color_mode::automatic : spdlog::color_mode::never));
  auto formatter = std::make_unique<spdlog::pattern_formatter>();
  formatter->add_flag<PrintableMessage>('*').set_pattern("%H:%M:%S.%e %n %^%l%$: %*");
  spdlog::set_formatter(std::move(formatter));
}

}  // namespace forcebound::program
