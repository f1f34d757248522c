#include "forcebound/program/log.hpp"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "forcebound/text/terminal.hpp"

namespace forcebound::program {

void log_to_stderr(const std::string& program) {
  const bool coloured = text::colour_for(STDERR_FILENO) != text::Colour::none;
  spdlog::set_default_logger(
      spdlog::stderr_color_mt(program, coloured ? spdlog::color_mode::automatic : spdlog::color_mode::never));
  spdlog::set_pattern("%H:%M:%S.%e %n %^%l%$: %v");
}

}  // namespace forcebound::program
