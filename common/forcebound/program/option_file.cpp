#include "forcebound/program/option_file.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "forcebound/config/node.hpp"
#include "forcebound/program/option_checks.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/names.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::program {
namespace {

using config::Node;

constexpr const char* kConfig = "--config";
constexpr std::size_t kBytesMost = std::size_t{1} << 20U;

bool is_flag(const CLI::Option& option) { return option.get_items_expected_max() == 0; }

/// Whether `word` gives the option, as "--listen", "--listen=..." or "-v".
bool gives(const std::string& word, const CLI::Option& option) {
  const auto named = [&](const std::string& dashed) { return word == dashed || word.starts_with(dashed + "="); };
  return std::ranges::any_of(option.get_lnames(), [&](const std::string& name) { return named("--" + name); }) ||
         std::ranges::any_of(option.get_snames(), [&](const std::string& name) { return word == "-" + name; });
}

/// What may stand in a file: all but what is about the command line itself.
std::vector<std::string> keys_of(const CLI::App& app) {
  std::vector<std::string> keys;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) keys.push_back(name);
  }
  std::erase_if(keys, [](const std::string& key) { return key == "help" || key == "version" || key == "config"; });
  return keys;
}

/// As on a command line; nothing: it has no single value.
std::optional<std::string> word_of(const Node& value) {
  if (const auto* text = value.as<std::string>()) return *text;
  if (const auto* number = value.as<double>()) return text::to_text(*number);
  if (const auto* whole = value.as<std::int64_t>()) return std::to_string(*whole);
  return std::nullopt;
}

class OptionFile {
 public:
  OptionFile(const CLI::App& app, std::string file) : app_(app), file_(std::move(file)) {}

  [[nodiscard]] std::vector<std::string> words_beside(const std::vector<std::string>& given) const {
    const Node root = config::parse_toml(text::read_file(file_, kBytesMost), file_);
    const std::vector<std::string> keys = keys_of(app_);
    std::vector<std::string> words;
    for (const auto& [key, value] : *root.as<Node::Table>()) {
      if (std::ranges::find(keys, key) == keys.end()) {
        fail(value, "unknown key '" + key + "'" + text::suggestion(key, keys) + "; known are the options of --help");
      }
      const CLI::Option& option = *app_.get_option("--" + key);
      const auto given_too = [&](const std::string& word) { return gives(word, option); };
      if (std::ranges::any_of(given, given_too)) continue;
      add(key, value, option, words);
    }
    return words;
  }

 private:
  void add(const std::string& key, const Node& value, const CLI::Option& option,
           std::vector<std::string>& words) const {
    if (is_flag(option)) {
      const bool* const wanted = value.as<bool>();
      if (wanted == nullptr) fail(value, key + " must be true or false, got " + config::written(value));
      if (*wanted) words.push_back("--" + key);
      return;
    }
    if (const auto* list = value.as<Node::List>(); list != nullptr && takes_several(option)) {
      for (const Node& each : *list) add_one(key, each, words);
    } else {
      add_one(key, value, words);
    }
  }

  void add_one(const std::string& key, const Node& value, std::vector<std::string>& words) const {
    const auto word = word_of(value);
    if (!word) fail(value, key + " must be a text or a number, got " + config::written(value));
    words.push_back("--" + key + "=" + *word);
  }

  static bool takes_several(const CLI::Option& option) {
    return option.get_expected_max() == CLI::detail::expected_max_vector_size;
  }

  [[noreturn]] void fail(const Node& where, const std::string& what) const {
    throw std::invalid_argument(file_ + ":" + std::to_string(where.line) + ": " + what);
  }

  const CLI::App& app_;
  std::string file_;
};

/// The file that the words name; nothing: none. The last one, as CLI11 reports that there are two.
std::optional<std::string> named_file(const std::vector<std::string>& words) {
  const std::string with_value = std::string(kConfig) + "=";
  std::optional<std::string> file;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i].starts_with(with_value)) file = words[i].substr(with_value.size());
    if (words[i] == kConfig && i + 1 < words.size()) file = words[i + 1];
  }
  return file;
}

}  // namespace

void add_option_file(CLI::App& app) {
  app.add_option(kConfig,
                 "file with options, by their names without the dashes: record = \"run.mcap\"; those given here "
                 "come before")
      ->type_name("FILE.toml")
      ->check(not_empty());
}

std::vector<std::string> with_option_file(const CLI::App& app, int argc, const char* const* argv) {
  std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  if (app.get_option_no_throw(kConfig) == nullptr) return words;
  const auto file = named_file(words);
  if (!file || file->empty()) return words;
  const std::vector<std::string> more = OptionFile(app, *file).words_beside(words);
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

}  // namespace forcebound::program
