#include "forcebound/view/assembly.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <utility>

#include "forcebound/page/json_number.hpp"

namespace forcebound::view {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kPiecesMost = kDescriptionBytesMost / kPieceBytes + 1;

std::string json_text(const std::string& text) {
  return Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

bool Assembly::add(const Piece& piece) {
  if (piece.content.size() > kPieceBytes) return false;
  if (piece.session != session_) {
    *this = {};
    session_ = piece.session;
  }
  if (piece.pieces > 0) return add_description(piece);
  add_movement(piece);
  return false;
}

void Assembly::begin(const Piece& piece) {
  view_ = piece.view;
  text_.assign(piece.pieces * kPieceBytes, ' ');
  came_.assign(piece.pieces, false);
  missing_ = piece.pieces;
}

bool Assembly::add_description(const Piece& piece) {
  if (piece.view == shown_ || piece.pieces > kPiecesMost || piece.number >= piece.pieces) return false;
  if (piece.view != view_ || piece.pieces != came_.size()) begin(piece);
  // All but the last one are full.
  const bool last = piece.number + 1 == piece.pieces;
  if (came_[piece.number] || (!last && piece.content.size() != kPieceBytes)) return false;
  came_[piece.number] = true;
  const auto text = std::as_writable_bytes(std::span(text_)).subspan(piece.number * kPieceBytes);
  std::ranges::copy(piece.content, text.begin());
  if (last) text_.resize((piece.pieces - 1) * kPieceBytes + piece.content.size());
  if (--missing_ > 0) return false;
  const std::uint64_t view = std::exchange(view_, 0);
  const std::string whole = std::exchange(text_, {});
  came_.clear();
  if (hash_of(whole) != view) return false;
  auto received = read_description(whole);
  if (!received) return false;
  shown_ = view;
  scene_ = std::move(received);
  moving_.clear();
  for (const MovingGroup& group : scene_->moving) {
    const std::size_t items = group.items();
    moving_.push_back(
        {.numbers = std::vector<float>(items * group.numbers_of_item()), .known = std::vector<bool>(items)});
  }
  return true;
}

void Assembly::add_movement(const Piece& piece) {
  if (!scene_ || piece.view != shown_ || piece.number >= moving_.size()) return;
  const MovingGroup& group = scene_->moving[piece.number];
  const std::size_t each = group.numbers_of_item();
  const std::size_t count = piece.content.size() / sizeof(float) / each;
  if (count == 0 || piece.content.size() != count * each * sizeof(float) || piece.first > group.items() ||
      count > group.items() - piece.first) {
    return;
  }
  std::vector<float> numbers(count * each);
  std::memcpy(numbers.data(), piece.content.data(), piece.content.size());
  if (!std::ranges::all_of(numbers, [](float number) { return std::isfinite(number); })) return;
  Moving& moving = moving_[piece.number];
  const auto to = moving.numbers.begin() + static_cast<std::ptrdiff_t>(piece.first * each);
  const std::size_t end = piece.first + count;
  for (std::size_t item = piece.first; item < end; ++item) {
    if (moving.known[item]) continue;
    moving.known[item] = true;
    moving.changed = true;
  }
  if (std::equal(numbers.begin(), numbers.end(), to)) return;
  std::ranges::copy(numbers, to);
  moving.changed = true;
}

void Assembly::report_all_again() noexcept {
  for (Moving& moving : moving_) moving.changed = true;
}

std::string Assembly::take_moved(int track) {
  std::string meshes;
  std::string bodies;
  std::string values;
  for (std::size_t group = 0; group < moving_.size(); ++group) {
    if (!std::exchange(moving_[group].changed, false)) continue;
    if (scene_->moving[group].values) {
      add_values(values, group);
    } else if (scene_->moving[group].deforms) {
      add_surface(meshes, group);
    } else {
      add_solids(bodies, group);
    }
  }
  if (meshes.empty() && bodies.empty() && values.empty()) return {};
  return "{\"kind\":\"moved\",\"track\":" + std::to_string(track) + ",\"meshes\":[" + meshes + "],\"bodies\":[" +
         bodies + "]" + (values.empty() ? "" : ",\"values\":{" + values + "}") + "}";
}

void Assembly::add_surface(std::string& to, std::size_t group) {
  const Moving& moving = moving_[group];
  // At first, until all of it has come.
  if (!std::ranges::all_of(moving.known, [](bool known) { return known; })) return;
  to += (to.empty() ? "" : ",") + std::string("{\"name\":") + json_text(scene_->moving[group].names.front()) +
        ",\"vertices_m\":";
  page::add_numbers(to, std::span<const float>(moving.numbers));
  to += '}';
}

void Assembly::add_solids(std::string& to, std::size_t group) {
  const Moving& moving = moving_[group];
  for (std::size_t i = 0; i < moving.known.size(); ++i) {
    if (!moving.known[i]) continue;
    const auto numbers = std::span<const float>(moving.numbers).subspan(i * scene::kNumbersOfSolid);
    to += (to.empty() ? "" : ",") + std::string("{\"name\":") + json_text(scene_->moving[group].names[i]);
    to += ",\"position_m\":";
    page::add_numbers(to, numbers.first(3));
    to += ",\"orientation\":";
    page::add_numbers(to, numbers.subspan(3, 4));
    to += '}';
  }
}

void Assembly::add_values(std::string& to, std::size_t group) {
  const Moving& moving = moving_[group];
  for (std::size_t i = 0; i < moving.known.size(); ++i) {
    if (!moving.known[i]) continue;
    to += (to.empty() ? "" : ",") + json_text(scene_->moving[group].names[i]) + ':';
    page::add_number(to, moving.numbers[i]);
  }
}

}  // namespace forcebound::view
