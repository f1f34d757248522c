#include "forcebound/config/checked_table.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "forcebound/text/file.hpp"
#include "forcebound/text/names.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::config {
namespace {

std::string not_tables(const std::string& kind) { return kind + " must be tables, each [[" + kind + "]]"; }

/// "object 'wall'".
std::string named(const std::string& kind, const std::string& name) { return kind + " '" + name + "'"; }

std::string named_twice(const std::string& one, const std::string& other, const std::string& name) {
  const std::string both = one == other ? "two [[" + one + "]]" : "[[" + one + "]] and [[" + other + "]]";
  return both + " are named '" + name + "'";
}

}  // namespace

TextParameter name_of_part() {
  return {.key = "name", .meaning = "for errors, logs and `--explain`", .form = TextParameter::Form::name};
}

const Node* CheckedTable::find(std::string_view key) {
  if (std::ranges::find(known_, key) == known_.end()) known_.emplace_back(key);
  return table_.find(key);
}

const Node& CheckedTable::at(std::string_view key, std::string_view accepted) {
  const Node* const node = find(key);
  if (node != nullptr) return *node;
  const std::string slip = misspelling_of(key);
  fail("'" + std::string(key) + "' is missing" + (slip.empty() ? "" : ", is '" + slip + "' a misspelling of it?") +
       (accepted.empty() ? "" : accepted_suffix(accepted)));
}

std::string_view CheckedTable::first_given(std::span<const std::string_view> keys) const {
  std::string names;
  std::string question;
  for (const std::string_view key : keys) {
    if (table_.find(key) != nullptr) return key;
    names.append(names.empty() ? "'" : ", '").append(key).append("'");
    const std::string slip = misspelling_of(key);
    if (question.empty() && !slip.empty())
      question = ", is '" + slip + "' a misspelling of '" + std::string(key) + "'?";
  }
  fail("one of " + names + " must be given" + question);
}

std::string CheckedTable::misspelling_of(std::string_view key) const {
  for (const auto& [name, node] : *table_.as<Node::Table>()) {
    const bool is_known = std::ranges::find(known_, name) != known_.end();
    if (!is_known && text::is_slip_of(name, key)) return name;
  }
  return {};
}

void CheckedTable::fail(const Node& where, const std::string& what) const {
  throw ConfigError(text::printable(file_ + ":" + std::to_string(where.line) + ": " + place_ + ": " + what));
}

void CheckedTable::refuse(std::string_view key, const std::string& must_be) const {
  const Node* const node = table_.find(key);
  if (node == nullptr) fail(std::string(key) + " must be " + must_be);
  fail(*node, std::string(key) + " must be " + must_be + ", got " + written(*node));
}

std::string CheckedTable::folder() const { return std::filesystem::path(file_).parent_path().string(); }

std::string CheckedTable::path_at(std::string_view key, const std::string& named) const {
  const Node* const node = table_.find(key);
  return built_at(node == nullptr ? table_ : *node, [&] { return text::path_within(named, folder(), folders_); });
}

const Node& CheckedTable::place_of(const ValueError& error, const Node& otherwise) const noexcept {
  const Node* const node = table_.find(error.key());
  if (node == nullptr) return otherwise;
  const auto* const list = node->as<Node::List>();
  return list != nullptr && error.row() && *error.row() < list->size() ? (*list)[*error.row()] : *node;
}

double CheckedTable::finite(const Node& node, const std::string& what) const {
  const auto* const whole = node.as<std::int64_t>();
  const auto* const number = node.as<double>();
  const double value = whole != nullptr    ? static_cast<double>(*whole)
                       : number != nullptr ? *number
                                           : std::numeric_limits<double>::quiet_NaN();
  if (!std::isfinite(value)) fail(node, what + " must be a finite number, got " + written(node));
  return value;
}

Rows CheckedTable::rows(const Node& list, const std::string& key) const {
  Rows rows;
  for (const Node& node : *list.as<Node::List>()) {
    const std::string what = "row " + std::to_string(rows.size() + 1) + " of " + key;
    const auto* const row = node.as<Node::List>();
    if (row == nullptr) fail(node, what + " must be a list, got " + written(node));
    std::vector<double>& numbers = rows.emplace_back();
    for (const Node& number : *row) numbers.push_back(finite(number, what));
  }
  return rows;
}

Value CheckedTable::value_of(const Parameter& parameter, const Node& node, Eigen::Index axes) const {
  const std::string key(key_of(parameter));
  const auto refuse_type = [&](const char* type) { fail(node, key + " must be " + type + ", got " + written(node)); };
  if (std::holds_alternative<NumberParameter>(parameter)) return finite(node, key);
  if (std::holds_alternative<FlagParameter>(parameter)) {
    if (node.as<bool>() == nullptr) refuse_type("true or false");
    return *node.as<bool>();
  }
  const auto* const point = std::get_if<PointParameter>(&parameter);
  if (point == nullptr && !std::holds_alternative<RowsParameter>(parameter)) {
    if (node.as<std::string>() == nullptr) refuse_type("text");
    return *node.as<std::string>();
  }
  const auto* const list = node.as<Node::List>();
  if (list == nullptr) refuse_type("a list");
  if (point == nullptr) return rows(node, key);
  if (list->size() != static_cast<std::size_t>(axes)) {
    fail(node, key + " must have " + std::to_string(axes) + (axes == 1 ? " number" : " numbers") +
                   " in this scene, got " + written(node));
  }
  Eigen::Vector3d value = Eigen::Vector3d::Constant(point->rest);
  for (Eigen::Index i = 0; i < axes; ++i) value[i] = finite((*list)[static_cast<std::size_t>(i)], key);
  return value;
}

Values CheckedTable::given(std::span<const Parameter> parameters, Eigen::Index axes) {
  Values values;
  // All first, so that none of them is taken for a misspelling of a missing one.
  for (const Parameter& parameter : parameters) (void)find(key_of(parameter));
  for (const Parameter& parameter : parameters) {
    const std::string_view key = key_of(parameter);
    const Node* const node = may_be_left_out(parameter) ? find(key) : &at(key, accepted_text(parameter));
    if (node == nullptr || std::holds_alternative<OtherParameter>(parameter)) continue;
    Value value = value_of(parameter, *node, axes);
    (void)built_at(*node, [&] { return checked(parameter, value); });
    values.set(key, std::move(value));
  }
  return values;
}

Values CheckedTable::all(std::span<const Parameter> parameters, Eigen::Index axes) {
  const Values values = completed(parameters, given(parameters, axes));
  refuse_unknown_keys();
  return values;
}

template <class Type>
Type CheckedTable::value(const Parameter& parameter) {
  return std::get<Type>(completed({&parameter, 1}, given({&parameter, 1})).all().begin()->second);
}

template double CheckedTable::value<double>(const Parameter& parameter);
template bool CheckedTable::value<bool>(const Parameter& parameter);
template std::string CheckedTable::value<std::string>(const Parameter& parameter);

std::string CheckedTable::choice(const ChoiceParameter& parameter) {
  (void)at(parameter.key, accepted_text(parameter));
  return value<std::string>(parameter);
}

int CheckedTable::whole(NumberParameter parameter) {
  parameter.whole = true;
  return static_cast<int>(number(parameter));
}

double CheckedTable::checked_number(const Node& node, NumberParameter parameter, const std::string& what) const {
  parameter.key = what;
  return built_at(node, [&] { return std::get<double>(checked(parameter, finite(node, what))); });
}

Vector CheckedTable::numbers(const Node& list, const NumberParameter& each, Eigen::Index rows) const {
  const auto& nodes = *list.as<Node::List>();
  if (nodes.size() != static_cast<std::size_t>(rows)) {
    fail(list, std::string(each.key) + " must have " + std::to_string(rows) + " numbers, got " +
                   std::to_string(nodes.size()));
  }
  Vector result(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    result[i] =
        checked_number(nodes[static_cast<std::size_t>(i)], each, std::string(each.key) + "[" + std::to_string(i) + "]");
  }
  return result;
}

Vector CheckedTable::vector(const NumberParameter& each, Eigen::Index rows) {
  const Node* const node =
      each.preset ? find(each.key)
                  : &at(each.key, accepted_text(each) + ", one number or a list of " + std::to_string(rows));
  if (node == nullptr) return Vector::Constant(rows, *each.preset);
  if (node->as<Node::List>() != nullptr) return numbers(*node, each, rows);
  return Vector::Constant(rows, checked_number(*node, each, std::string(each.key)));
}

Matrix CheckedTable::matrix(std::string_view key, Eigen::Index rows) {
  const std::string count = std::to_string(rows);
  const auto* const list =
      at(key, "> 0: one number, " + count + " numbers, or " + count + " rows of " + count).as<Node::List>();
  if (list == nullptr || list->empty() || list->front().as<Node::List>() == nullptr) {
    return vector({.key = key, .least = 0, .least_excluded = true}, rows).asDiagonal();
  }
  if (list->size() != static_cast<std::size_t>(rows)) refuse(key, std::to_string(rows) + " rows");
  Matrix result(rows, rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const Node& row = (*list)[static_cast<std::size_t>(i)];
    if (row.as<Node::List>() == nullptr) refuse(key, "a list of rows");
    const std::string what = std::string(key) + "[" + std::to_string(i) + "]";
    result.row(i) = numbers(row, {.key = what}, rows).transpose();
  }
  if (result != result.transpose() || Eigen::LLT<Matrix>(result).info() != Eigen::Success) {
    refuse(key, "symmetric and positive definite");
  }
  return result;
}

CheckedTable CheckedTable::table(std::string_view key, const std::string& place) {
  const Node& node = at(key, "a table");
  if (node.as<Node::Table>() == nullptr) refuse(key, "a table");
  CheckedTable inner(node, file_, place);
  inner.folders_ = folders_;
  return inner;
}

const Node::List& CheckedTable::list(std::string_view key) {
  const auto* const list = at(key, "a list").as<Node::List>();
  if (list == nullptr) refuse(key, "a list");
  return *list;
}

void CheckedTable::each(const std::string& kind,
                        const std::function<void(CheckedTable& part, const std::string& name)>& read) {
  const Node* const all = find(kind);
  if (all == nullptr) return;
  const auto* const tables = all->as<Node::List>();
  if (tables == nullptr) fail(*all, not_tables(kind));
  for (const Node& node : *tables) {
    if (node.as<Node::Table>() == nullptr) fail(node, not_tables(kind));
    const std::string name = CheckedTable(node, file_, kind).text(name_of_part());
    const auto known = std::ranges::find(named_, name, &Named::name);
    if (known != named_.end()) fail(node, named_twice(known->kind, kind, name));
    named_.push_back({kind, name});
    CheckedTable part(node, file_, named(kind, name));
    part.folders_ = folders_;
    (void)part.find("name");
    read(part, name);
  }
}

void CheckedTable::refuse_unknown_keys(const std::string& refusal) const {
  for (const auto& [name, node] : *table_.as<Node::Table>()) {
    if (std::ranges::find(known_, name) != known_.end()) continue;
    fail(node, named(refusal, name) + text::suggestion(name, known_));
  }
}

}  // namespace forcebound::config
