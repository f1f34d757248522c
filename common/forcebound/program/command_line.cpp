#include "forcebound/program/command_line.hpp"

#include <unistd.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <new>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "forcebound/program/log.hpp"
#include "forcebound/program/option_file.hpp"
#include "forcebound/text/classic_locale.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/names.hpp"
#include "forcebound/text/printable.hpp"
#include "forcebound/text/terminal.hpp"

namespace forcebound::program {
namespace {

/// CLI11's own shows checks and needs among the types.
class HelpFormatter final : public CLI::Formatter {
 public:
  std::string make_option_opts(const CLI::Option* option) const override {
    if (option->get_type_size() == 0) return {};
    std::string text;
    if (!option->get_positional()) text += " " + option->get_type_name();
    if (!option->get_default_str().empty()) text += "=" + option->get_default_str();
    if (option->get_expected_max() == CLI::detail::expected_max_vector_size) text += " ...";
    return text;
  }

  /// With two blanks at least between name and words, or the words on the next line: the text is broken by that, and
  /// help2man takes a line with one blank for words alone.
  std::string make_option(const CLI::Option* option, bool is_positional) const override {
    const std::string name = "  " + make_option_name(option, is_positional) + make_option_opts(option);
    std::string text = CLI::Formatter::make_option(option, is_positional);
    const bool one_blank = text.size() > name.size() + 1 && text[name.size()] == ' ' && text[name.size() + 1] != ' ';
    if (one_blank) text.replace(name.size(), 1, "\n" + std::string(get_column_width(), ' '));
    return text;
  }

  std::string make_option_desc(const CLI::Option* option) const override {
    return option->get_description() + (option->get_required() ? " (required)" : "");
  }
};

const CLI::App& innermost(const CLI::App& app) {
  const auto chosen = app.get_subcommands();
  return chosen.empty() ? app : innermost(*chosen.front());
}

/// "forcebound-lab trials"
std::string command_of(const CLI::App& app) {
  const CLI::App& chosen = innermost(app);
  return app.get_name() + (&chosen == &app ? "" : " " + chosen.get_name());
}

/// Without the dashes, which all have in common.
std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back(name);
  }
  return names;
}

std::vector<std::string> subcommand_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

std::string unexpected(const CLI::App& app, const std::string& word) {
  const CLI::App& chosen = innermost(app);
  if (word.starts_with('-')) {
    const std::string name = word.substr(std::min(word.find_first_not_of('-'), word.size()));
    const std::string nearest = text::nearest_name(name, option_names(chosen));
    return "unknown option '" + word + "'" + (nearest.empty() ? "" : ", did you mean '--" + nearest + "'?");
  }
  const auto commands = subcommand_names(chosen);
  if (commands.empty()) return "unexpected argument '" + word + "'";
  return "unknown command '" + word + "'" + text::suggestion(word, commands);
}

std::string problem_of(const CLI::App& app, const CLI::Error& error) {
  // A mistyped option explains why another is missing, so it is reported first.
  const auto unknown = app.remaining(true);
  if (!unknown.empty()) return unexpected(app, unknown.front());
  const std::string what = error.what();
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr) {
    const bool too_many = what.find("At Most") != std::string::npos;
    return what.substr(0, what.find(':')) + (too_many ? " is given more than once" : " needs a value");
  }
  if (dynamic_cast<const CLI::ExcludesError*>(&error) != nullptr) {
    constexpr std::string_view kExcludes = " excludes ";
    const std::size_t at = what.find(kExcludes);
    if (at != std::string::npos) return what.substr(0, at) + " does not go with " + what.substr(at + kExcludes.size());
  }
  return what;
}

void set_log_form(const std::vector<std::string>& words) {
  if (std::ranges::find(words, "--log-json") != words.end()) set_logs_json(true);
}

End wrong_use(const std::string& program, const std::string& problem, const std::string& command) {
  return {kWrongUse, program + ": " + problem + " (see " + command + " --help)\n"};
}

/// Prints what ends a program.
int end_with(const std::string& name, const End& end) {
  if (end.exit_code == kDone) {
    std::fputs(text::printable_lines(end.text).c_str(), stdout);
  } else if (logs_json()) {
    const bool has_name = end.text.starts_with(name + ": ");
    const std::string what = has_name ? end.text.substr(name.size() + 2) : end.text;
    std::fputs(json_line_now(name, "error", what.substr(0, what.find_last_not_of('\n') + 1)).c_str(), stderr);
  } else {
    std::fputs(text::printable_lines(end.text).c_str(), stderr);
  }
  return end.exit_code;
}

int run_to_its_end(const std::string& name, const std::function<int()>& work) {
  try {
    return work();
  } catch (const End& end) {
    return end_with(name, end);
  } catch (const std::invalid_argument& error) {
    return end_with(name, wrong_use(name, error.what(), name));
  } catch (const text::WriteError& error) {
    return end_with(name, {kOutputLost, name + ": " + error.what() + "\n"});
  } catch (const std::bad_alloc&) {
    if (logs_json()) {
      // Not by the writer of JSON, which would need memory.
      std::fprintf(stderr,
                   R"({"time":null,"level":"error","program":"%s","version":"%s","pid":%d,"text":"%s"})"
                   "\n",
                   name.c_str(), FORCEBOUND_VERSION, static_cast<int>(getpid()), "there is not enough memory");
    } else {
      std::fprintf(stderr, "%s: there is not enough memory\n", name.c_str());
    }
    return kFailed;
  } catch (const std::exception& error) {
    return end_with(name, {kFailed, name + ": " + error.what() + "\n"});
  }
}

}  // namespace

void set_up(CLI::App& app, const std::string& name) {
  constexpr std::size_t kNameColumns = 32;
  app.name(name);
  app.set_help_flag("-h,--help", "print this help and end");
  app.set_version_flag("--version", name + " " FORCEBOUND_VERSION, "print the version and end");
  app.formatter_fn([](const CLI::App* of, std::string command, CLI::AppFormatMode mode) {
    HelpFormatter formatter;
    formatter.column_width(kNameColumns);
    formatter.label("Positionals", "Arguments");
    return text::wrapped_help(formatter.make_help(of, std::move(command), mode));
  });
}

void parse(CLI::App& app, int argc, const char* const* argv) {
  try {
    // Before anything may be wrong with them: that is told as JSON too.
    set_log_form({argv + 1, argv + argc});
    std::vector<std::string> words = with_option_file(app, argc, argv);
    set_log_form(words);
    // CLI11 takes the last word first.
    std::ranges::reverse(words);
    const text::ClassicLocale with_points;
    app.parse(std::move(words));
  } catch (const CLI::Success& asked) {
    std::ostringstream out;
    app.exit(asked, out, out);
    throw End{kDone, out.str()};
  } catch (const CLI::Error& error) {
    throw wrong_use(app.get_name(), problem_of(app, error), command_of(app));
  } catch (const std::invalid_argument& error) {
    throw wrong_use(app.get_name(), error.what(), command_of(app));
  }
}

int run(const std::string& name, const std::function<int()>& work) noexcept {
  const int ended = run_to_its_end(name, work);
  const bool flushed = std::fflush(stdout) == 0;
  if (flushed && std::ferror(stdout) == 0) return ended;
  // Where an earlier write failed its reason is gone.
  const std::string why = flushed ? "" : ": " + std::generic_category().message(errno);
  const int lost = end_with(name, {kOutputLost, name + ": standard output: cannot be written" + why + "\n"});
  return ended == kDone || ended == kNeverConnected ? lost : ended;
}

void expect_apart(const FileOption& output, const std::vector<FileOption>& others) {
  if (output.file.empty() || text::is_special_file(output.file)) return;
  for (const FileOption& other : others) {
    if (other.file.empty() || !text::is_same_path(output.file, other.file)) continue;
    throw std::invalid_argument(std::string(output.option) + " '" + output.file + "' would replace the file of " +
                                std::string(other.option) + ": give it another name");
  }
}

}  // namespace forcebound::program
