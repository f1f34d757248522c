#include "forcebound/config/toml_section.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "forcebound/text/names.hpp"

namespace forcebound::config {
namespace {

std::string written(const toml::node& node) {
  std::ostringstream text;
  node.visit([&text](const auto& value) { text << value; });
  return text.str();
}

}  // namespace

toml::table parse_toml(std::string_view text, const std::string& place) {
  try {
    return toml::parse(text, place);
  } catch (const toml::parse_error& error) {
    throw std::runtime_error(place + ":" + std::to_string(error.source().begin.line) +
                             ": not TOML: " + std::string(error.description()));
  }
}

void TomlSection::fail(const toml::node& node, const std::string& message) const {
  throw std::runtime_error(place_ + ":" + std::to_string(node.source().begin.line) + ": " + subject_ + ": " + message);
}

void TomlSection::refuse(std::string_view key, const std::string& must_be) const {
  const toml::node& node = *table_.get(key);
  fail(node, std::string(key) + " must be " + must_be + ", got " + written(node));
}

bool TomlSection::has(std::string_view key) {
  if (std::ranges::find(known_, key) == known_.end()) known_.emplace_back(key);
  return table_.contains(key);
}

const toml::node& TomlSection::required(std::string_view key) {
  if (!has(key)) fail(table_, "needs '" + std::string(key) + "'");
  return *table_.get(key);
}

std::string TomlSection::text(std::string_view key) {
  const auto value = required(key).value_exact<std::string>();
  if (!value) refuse(key, "a text in quotes");
  return *value;
}

int TomlSection::integer(std::string_view key, int least, int most) {
  const auto value = required(key).value_exact<std::int64_t>();
  if (!value || *value < least || *value > most) {
    refuse(key, "a whole number from " + std::to_string(least) + " to " + std::to_string(most));
  }
  return static_cast<int>(*value);
}

double TomlSection::number_at(const toml::node& node, const std::string& what, Allowed allowed) const {
  const auto value = node.is_number() ? node.value<double>() : std::nullopt;
  const bool finite = value && std::isfinite(*value);
  if (finite && (allowed == Allowed::any || *value > 0 || (*value == 0 && allowed == Allowed::not_negative))) {
    return *value;
  }
  const char* must = !finite ? "a finite number" : allowed == Allowed::positive ? "> 0" : ">= 0";
  fail(node, what + " must be " + must + ", got " + written(node));
}

double TomlSection::number(std::string_view key, Allowed allowed) {
  return number_at(required(key), std::string(key), allowed);
}

double TomlSection::number_or(std::string_view key, Allowed allowed, double otherwise) {
  return has(key) ? number(key, allowed) : otherwise;
}

bool TomlSection::flag_or(std::string_view key, bool otherwise) {
  if (!has(key)) return otherwise;
  const auto* flag = table_.get(key)->as_boolean();
  if (flag == nullptr) refuse(key, "true or false");
  return flag->get();
}

Vector TomlSection::vector_at(const toml::array& list, std::string_view key, int rows, Allowed allowed) const {
  if (list.size() != static_cast<std::size_t>(rows)) {
    fail(list,
         std::string(key) + " must have " + std::to_string(rows) + " numbers, got " + std::to_string(list.size()));
  }
  Vector result(rows);
  for (int i = 0; i < rows; ++i) {
    const auto at = static_cast<std::size_t>(i);
    result[i] = number_at(list[at], std::string(key) + "[" + std::to_string(i) + "]", allowed);
  }
  return result;
}

Vector TomlSection::vector(std::string_view key, int rows, Allowed allowed) {
  const toml::node& node = required(key);
  if (const toml::array* list = node.as_array()) return vector_at(*list, key, rows, allowed);
  return Vector::Constant(rows, number_at(node, std::string(key), allowed));
}

Vector TomlSection::vector_or(std::string_view key, int rows, Allowed allowed, double otherwise) {
  return has(key) ? vector(key, rows, allowed) : Vector(Vector::Constant(rows, otherwise));
}

Matrix TomlSection::matrix(std::string_view key, int rows) {
  const toml::array* list = required(key).as_array();
  if (!list || list->empty() || !list->front().is_array()) return vector(key, rows, Allowed::positive).asDiagonal();
  if (list->size() != static_cast<std::size_t>(rows)) refuse(key, std::to_string(rows) + " rows");
  Matrix result(rows, rows);
  for (int i = 0; i < rows; ++i) {
    const toml::array* row = (*list)[static_cast<std::size_t>(i)].as_array();
    if (!row) refuse(key, "a list of rows");
    result.row(i) = vector_at(*row, std::string(key) + "[" + std::to_string(i) + "]", rows, Allowed::any).transpose();
  }
  if (result != result.transpose() || Eigen::LLT<Matrix>(result).info() != Eigen::Success) {
    refuse(key, "symmetric and positive definite");
  }
  return result;
}

TomlSection TomlSection::section(std::string_view key) {
  const toml::table* table = required(key).as_table();
  if (!table) refuse(key, "a table [" + std::string(key) + "]");
  return {*table, place_, subject_ + ", [" + std::string(key) + "]"};
}

void TomlSection::refuse_other_keys(const std::string& refusal) const {
  for (const auto& [key, node] : table_) {
    const std::string name(key.str());
    if (std::find(known_.begin(), known_.end(), name) != known_.end()) continue;
    std::string message = refusal;
    message.append(" '").append(name).append("'").append(text::suggestion(name, known_));
    fail(node, message);
  }
}

}  // namespace forcebound::config
