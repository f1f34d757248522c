#include "forcebound/server/environment/checked_table.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "forcebound/server/environment/scene_parser.hpp"
#include "forcebound/text/names.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::server {
namespace {

constexpr std::size_t kNameBytesMax = 64;

}  // namespace

std::string as_written(const toml::node& node) {
  // The library would give all 17 digits.
  if (const auto* number = node.as_floating_point()) return text::to_text(number->get());
  std::ostringstream text;
  node.visit([&text](const auto& value) { text << value; });
  return text.str();
}

CheckedTable::CheckedTable(const toml::table& table, std::string file, std::string place)
    : table_(table), file_(std::move(file)), place_(std::move(place)) {}

const toml::node* CheckedTable::find(std::string_view key) {
  if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.emplace_back(key);
  return table_.get(key);
}

const toml::node& CheckedTable::at(std::string_view key) {
  const toml::node* node = find(key);
  if (node == nullptr) fail("'" + std::string(key) + "' is missing" + misspelling_of(key));
  return *node;
}

std::string CheckedTable::misspelling_of(std::string_view key) const {
  for (const auto& [name, node] : table_) {
    if (text::is_slip_of(name.str(), key)) return ", is '" + std::string(name.str()) + "' meant to be it?";
  }
  return {};
}

std::string CheckedTable::text(std::string_view key) {
  const toml::node& node = at(key);
  const auto value = node.value_exact<std::string>();
  if (!value) fail(node, std::string(key) + " must be text, got " + as_written(node));
  return *value;
}

std::string CheckedTable::name(std::string_view key) {
  std::string value = text(key);
  const bool printable =
      std::none_of(value.begin(), value.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; });
  if (value.empty() || value.size() > kNameBytesMax || !printable) {
    fail(at(key), std::string(key) + " must have 1 to " + std::to_string(kNameBytesMax) +
                      " printable characters, got " + as_written(at(key)));
  }
  return value;
}

const toml::table& CheckedTable::table(std::string_view key) {
  const toml::node& node = at(key);
  if (!node.is_table()) fail(node, std::string(key) + " must be a table, got " + as_written(node));
  return *node.as_table();
}

const toml::array& CheckedTable::array(std::string_view key) {
  const toml::node& node = at(key);
  if (!node.is_array()) fail(node, std::string(key) + " must be a list, got " + as_written(node));
  return *node.as_array();
}

double CheckedTable::number(const scene::NumberParameter& parameter) {
  const toml::node* node = parameter.preset ? find(parameter.key) : &at(parameter.key);
  const double value = node == nullptr ? *parameter.preset : finite(*node, parameter.key);
  const bool above = parameter.least_excluded ? value > parameter.least : value >= parameter.least;
  if (node != nullptr && !(above && value <= parameter.most)) {
    fail(*node, std::string(parameter.key) + " must be " + scene::range_text(parameter) + ", got " + as_written(*node));
  }
  if (node != nullptr) note(parameter.key, text::to_text(value));
  return value;
}

int CheckedTable::whole(const scene::NumberParameter& parameter) {
  const double value = number(parameter);
  if (value != std::floor(value)) {
    fail(at(parameter.key), std::string(parameter.key) + " must be a whole number, got " + text::to_text(value));
  }
  return static_cast<int>(value);
}

scene::Point CheckedTable::point(std::string_view key, Eigen::Index rows, double rest) {
  const toml::array& values = array(key);
  if (values.size() != static_cast<std::size_t>(rows)) {
    fail(values, std::string(key) + " must have " + std::to_string(rows) + (rows == 1 ? " number" : " numbers") +
                     " in this scene, got " + as_written(values));
  }
  scene::Point point = scene::Point::Constant(rest);
  std::string text;
  for (Eigen::Index i = 0; i < rows; ++i) {
    point[i] = finite(values[static_cast<std::size_t>(i)], key);
    text += (i == 0 ? "" : ", ") + text::to_text(point[i]);
  }
  note(key, "[" + text + "]");
  return point;
}

scene::Point CheckedTable::direction(std::string_view key, Eigen::Index rows) {
  const scene::Point direction = point(key, rows);
  if (direction.isZero(0)) fail(at(key), std::string(key) + " must not be zero");
  return direction.stableNormalized();
}

std::string CheckedTable::choice(std::string_view key, std::span<const std::string_view> choices) {
  if (find(key) == nullptr) return std::string(choices.front());
  std::string word = text(key);
  if (std::find(choices.begin(), choices.end(), word) == choices.end()) {
    fail(at(key), "unknown " + std::string(key) + " '" + word + "'" +
                      text::suggestion(word, std::vector<std::string>(choices.begin(), choices.end())));
  }
  note(key, word);
  return word;
}

std::string CheckedTable::path(std::string_view key) {
  const std::string name = text(key);
  note(key, name);
  return (std::filesystem::path(file_).parent_path() / name).string();
}

bool CheckedTable::flag(std::string_view key, bool preset) {
  const toml::node* node = find(key);
  if (node == nullptr) return preset;
  const auto value = node->value_exact<bool>();
  if (!value) fail(*node, std::string(key) + " must be true or false, got " + as_written(*node));
  return *value;
}

void CheckedTable::each(std::string_view what, const std::function<std::string(const toml::table&)>& read) {
  if (find(what) == nullptr) return;
  const std::string kind(what);
  const std::string not_a_table = kind + " must be a table, [[" + kind + "]]";
  for (const toml::node& node : array(what)) {
    if (!node.is_table()) fail(node, not_a_table);
    Named part{kind, read(*node.as_table())};
    const auto known = std::ranges::find(named_, part.name, &Named::name);
    if (known != named_.end()) {
      const std::string both =
          known->kind == kind ? "two [[" + kind + "]]" : "[[" + known->kind + "]] and [[" + kind + "]]";
      fail(node, both + " are named '" + part.name + "'");
    }
    named_.push_back(std::move(part));
  }
}

void CheckedTable::refuse_unknown_keys() const {
  for (const auto& [key, node] : table_) {
    const std::string name{key.str()};
    if (std::find(known_.begin(), known_.end(), name) != known_.end()) continue;
    fail(node, "unknown key '" + name + "'" + text::suggestion(name, known_));
  }
}

void CheckedTable::fail(const toml::node& where, const std::string& what) const {
  throw SceneError(file_ + ":" + std::to_string(where.source().begin.line) + ": " + place_ + ": " + what);
}

double CheckedTable::finite(const toml::node& node, std::string_view key) const {
  const auto value = node.value<double>();
  if (!value || !std::isfinite(*value)) {
    fail(node, std::string(key) + " must be a finite number, got " + as_written(node));
  }
  return *value;
}

void CheckedTable::note(std::string_view key, const std::string& value) {
  values_text_ += (values_text_.empty() ? "" : ", ") + std::string(key) + " " + value;
}

}  // namespace forcebound::server
