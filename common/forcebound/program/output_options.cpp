#include "forcebound/program/output_options.hpp"

#include <CLI/CLI.hpp>
#include <stdexcept>

#include "forcebound/program/command_line.hpp"

namespace forcebound::program {
namespace {

constexpr const char* kBesideIt = "; data and script go beside it, as .csv and .gnuplot";

void add_format(CLI::App& command, CLI::Option& figure, std::vector<std::string>& formats) {
  command.add_option("--format", formats, "draw each figure in this format too, beside its PNG")
      ->needs(&figure)
      ->delimiter(',')
      ->check(one_of("format", {"pdf", "svg"}))
      ->type_name("pdf|svg");
}

}  // namespace

CLI::Option* add_figure(CLI::App& command, std::string& file, std::vector<std::string>& formats,
                        const std::string& what) {
  // Data and script have other extensions.
  const auto check = accepted_by([](const std::string& given) {
    if (!given.ends_with(".png")) throw std::invalid_argument("a figure is a FILE.png, got '" + given + "'");
  });
  CLI::Option* const figure =
      command.add_option("--figure", file, what + " into this file" + kBesideIt)->check(check)->type_name("FILE.png");
  add_format(command, *figure, formats);
  return figure;
}

CLI::Option* add_figures(CLI::App& command, std::string& folder, std::vector<std::string>& formats,
                         const std::string& what) {
  CLI::Option* const figures = command.add_option("--figures", folder, what + " into this folder" + kBesideIt)
                                   ->check(not_empty())
                                   ->type_name("FOLDER");
  add_format(command, *figures, formats);
  return figures;
}

CLI::Option* add_output(CLI::App& command, const std::string& name, std::string& file, const std::string& what) {
  return command.add_option(name, file, what)->check(not_empty());
}

}  // namespace forcebound::program
