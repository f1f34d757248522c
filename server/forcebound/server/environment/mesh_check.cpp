#include "forcebound/server/environment/mesh_check.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "forcebound/text/lines.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::server {
namespace {

using Words = std::vector<std::string_view>;

constexpr std::string_view kSolid = "solid";
constexpr std::size_t kStlHead = 84;
constexpr std::size_t kStlTriangle = 50;

std::string quoted(std::string_view word) {
  constexpr std::size_t kMost = 40;
  return "'" + text::printable(word.substr(0, kMost)) + "'";
}

/// The lines of a text; errors name the line.
class Lines {
 public:
  Lines(const std::string& path, const std::string& content) : stream_(content), reader_(stream_, path) {}

  /// The words of the next line that has any, without comments ('#'); none at the end.
  const Words& next() {
    words_.clear();
    while (words_.empty() && reader_.next()) {
      words_ = text::split_at_blanks(reader_.line().substr(0, reader_.line().find('#')));
    }
    return words_;
  }

  [[noreturn]] void refuse(const std::string& what) const { reader_.refuse(what); }

  void expect_coordinates(std::size_t from) const {
    if (words_.size() < from + 3)
      refuse("a point needs three coordinates, got " + std::to_string(words_.size() - from));
    for (std::size_t i = from; i < from + 3; ++i) {
      const std::string_view word = words_[i].starts_with('+') ? words_[i].substr(1) : words_[i];
      const auto number = text::finite_number(word);
      if (!number) refuse(quoted(words_[i]) + " is not a finite number");
      if (std::abs(*number) > std::numeric_limits<float>::max()) {
        refuse(quoted(words_[i]) + " is more than single precision holds");
      }
    }
  }

 private:
  std::istringstream stream_;
  text::LineReader reader_;
  Words words_;
};

std::int64_t count_at(const Lines& lines, std::string_view word, const char* what) {
  const auto count = text::whole_number<std::int64_t>(word);
  if (!count || *count < 0) lines.refuse(std::string("expected the number of ") + what + ", got " + quoted(word));
  return *count;
}

/// In small letters: a text STL may be written in any.
std::string lowered(std::string_view word) {
  std::string small(word);
  std::ranges::transform(small, small.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
  return small;
}

/// What a line of a text STL begins with: its first word, and `end solid` as `endsolid`.
std::string stl_keyword(const Words& words) {
  const std::string first = lowered(words.front());
  return first == "end" && words.size() > 1 ? first + lowered(words[1]) : first;
}

bool is_text_stl(std::string_view content) {
  // Binary files may begin with "solid" as well; no text has a zero byte.
  if (content.find('\0') != std::string_view::npos) return false;
  content.remove_prefix(std::min(content.find_first_not_of(" \t\r\n"), content.size()));
  return lowered(content.substr(0, kSolid.size())) == kSolid;
}

/// The triangles that a binary STL says it has.
std::uint32_t binary_stl_triangles(std::string_view content) {
  std::uint32_t triangles = 0;
  std::memcpy(&triangles, content.data() + kStlHead - sizeof triangles, sizeof triangles);
  return triangles;
}

void check_binary_stl(const std::string& path, const std::string& content) {
  const auto fail = [&](const std::string& what) { throw std::runtime_error(path + ": " + what); };
  if (content.size() < kStlHead)
    fail("ends after " + std::to_string(content.size()) + " bytes, in the head of an STL file");
  const std::uint32_t triangles = binary_stl_triangles(content);
  const std::size_t whole = (content.size() - kStlHead) / kStlTriangle;
  if (whole < triangles) {
    fail("ends after " + std::to_string(whole) + " of " + std::to_string(triangles) + " triangles");
  }
  for (std::size_t i = 0; i < triangles; ++i) {
    std::array<float, 9> corners{};
    std::memcpy(corners.data(), content.data() + kStlHead + i * kStlTriangle + 3 * sizeof(float), sizeof corners);
    if (!std::ranges::all_of(corners, [](float value) { return std::isfinite(value); })) {
      fail("triangle " + std::to_string(i + 1) + " has a coordinate that is not finite");
    }
  }
}

}  // namespace

void check_obj(const std::string& path, const std::string& content) {
  Lines lines(path, content);
  std::int64_t vertices = 0;
  bool goes_on = false;
  const auto check_corner = [&](std::string_view word) {
    const auto index = text::whole_number<std::int64_t>(word.substr(0, word.find('/')));
    if (!index) lines.refuse(quoted(word) + " is not the index of a vertex");
    if (*index == 0 || std::abs(*index) > vertices) {
      lines.refuse("vertex " + quoted(word) + " is not one of the " + std::to_string(vertices) + " before this line");
    }
  };
  std::size_t corners = 0;
  while (true) {
    const Words& words = lines.next();
    if (words.empty()) break;
    const bool more = words.back() == "\\";
    const bool in_face = goes_on || words.front() == "f";
    if (!in_face) {
      if (words.front() == "v") {
        lines.expect_coordinates(1);
        ++vertices;
      }
      continue;
    }
    if (!goes_on) corners = 0;
    for (std::size_t i = goes_on ? 0 : 1; i < words.size() - (more ? 1 : 0); ++i, ++corners) check_corner(words[i]);
    goes_on = more;
    if (!more && corners < 3) lines.refuse("a face needs three corners, got " + std::to_string(corners));
  }
  if (goes_on) lines.refuse("the file ends within a face");
}

void check_off(const std::string& path, const std::string& content) {
  Lines lines(path, content);
  Words words = lines.next();
  if (words.empty() || !words.front().ends_with("OFF")) lines.refuse("expected OFF in the first line");
  words.erase(words.begin());
  if (words.empty()) words = lines.next();
  if (words.size() < 2) lines.refuse("expected the numbers of vertices, faces and edges");
  const std::int64_t vertices = count_at(lines, words[0], "vertices");
  const std::int64_t faces = count_at(lines, words[1], "faces");
  const auto next = [&](const char* what, std::int64_t have, std::int64_t of) -> const Words& {
    const Words& line = lines.next();
    if (line.empty()) {
      lines.refuse("the file ends after " + std::to_string(have) + " of " + std::to_string(of) + " " + what);
    }
    return line;
  };
  for (std::int64_t i = 0; i < vertices; ++i) {
    (void)next("vertices", i, vertices);
    lines.expect_coordinates(0);
  }
  for (std::int64_t i = 0; i < faces; ++i) {
    const Words& face = next("faces", i, faces);
    const std::int64_t corners = count_at(lines, face[0], "corners");
    if (corners < 3) lines.refuse("a face needs three corners, got " + std::to_string(corners));
    if (static_cast<std::int64_t>(face.size()) <= corners) {
      lines.refuse("a face of " + std::to_string(corners) + " corners has only " + std::to_string(face.size() - 1));
    }
    for (std::int64_t k = 1; k <= corners; ++k) {
      const auto word = face[static_cast<std::size_t>(k)];
      const auto index = text::whole_number<std::int64_t>(word);
      if (!index || *index < 0 || *index >= vertices) {
        lines.refuse("vertex " + quoted(word) + " is not one of 0 to " + std::to_string(vertices - 1));
      }
    }
  }
}

void check_stl(const std::string& path, const std::string& content) {
  if (!is_text_stl(content)) {
    check_binary_stl(path, content);
    return;
  }
  Lines lines(path, content);
  std::size_t corners = 0;
  bool in_solid = false;
  while (true) {
    const Words& words = lines.next();
    if (words.empty()) break;
    const std::string keyword = stl_keyword(words);
    if (keyword == kSolid) in_solid = true;
    if (keyword == "endsolid") in_solid = false;
    if (keyword == "facet") corners = 0;
    if (keyword == "vertex") {
      lines.expect_coordinates(1);
      ++corners;
    }
    if (keyword == "endfacet" && corners != 3) {
      lines.refuse("a facet needs three vertices, got " + std::to_string(corners));
    }
  }
  if (in_solid) lines.refuse("the file ends without endsolid");
}

std::string plain_stl(const std::string& content) {
  if (!is_text_stl(content)) return content.substr(0, kStlHead + kStlTriangle * binary_stl_triangles(content));
  std::string plain;
  Lines lines({}, content);
  while (true) {
    const Words& words = lines.next();
    if (words.empty()) return plain;
    const std::string keyword = stl_keyword(words);
    plain += keyword;
    // Without the names of solids, in which any letter may be.
    if (!keyword.ends_with(kSolid)) {
      for (std::size_t i = 1; i < words.size(); ++i) plain.append(" ").append(lowered(words[i]));
    }
    plain += '\n';
  }
}

}  // namespace forcebound::server
