#pragma once

#include <string>

namespace forcebound::program {

/// Sends log lines to stderr, stdout being for results, in the pattern of all programs: time, program, level, and one
/// event a line however long it is, so that grep finds it whole; control characters in it are made printable.
/// "10:12:13.123 forcebound-server info: listening on
/// ..."
void log_to_stderr(const std::string& program);

}  // namespace forcebound::program
