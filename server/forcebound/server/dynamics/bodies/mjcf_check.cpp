#include "forcebound/server/dynamics/bodies/mjcf_check.hpp"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <vector>

#include "forcebound/server/dynamics/bodies/mujoco.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::server {
namespace {

constexpr std::string_view kBlank = " \t\r\n";
constexpr double kTextureBytesMost = 256.0 * 1024 * 1024;

/// An element's name and attributes, which lie in the text.
struct Element {
  std::string_view name{};
  std::map<std::string_view, std::string_view> attributes{};

  [[nodiscard]] std::string_view at(std::string_view key) const {
    const auto found = attributes.find(key);
    return found == attributes.end() ? std::string_view() : found->second;
  }
};

/// The elements of an XML text, in their order and regardless of their depth.
class ElementReader {
 public:
  explicit ElementReader(std::string_view text) : text_(text) {}

  std::optional<Element> next() {
    for (;;) {
      at_ = std::min(text_.find('<', at_), text_.size());
      if (at_ == text_.size()) return std::nullopt;
      const std::string_view rest = text_.substr(at_);
      if (rest.starts_with("<!--")) {
        skip_past("-->");
      } else if (rest.starts_with("<![CDATA[")) {
        skip_past("]]>");
      } else if (rest.starts_with("<?") || rest.starts_with("<!") || rest.starts_with("</")) {
        skip_past(">");
      } else {
        ++at_;
        return element();
      }
    }
  }

 private:
  void skip_past(std::string_view end) {
    const auto found = text_.find(end, at_);
    at_ = found == std::string_view::npos ? text_.size() : found + end.size();
  }

  void skip(std::string_view characters) { at_ = std::min(text_.find_first_not_of(characters, at_), text_.size()); }

  std::string_view word() {
    const auto end = std::min(text_.find_first_of(" \t\r\n/>=", at_), text_.size());
    const std::string_view found = text_.substr(at_, end - at_);
    at_ = end;
    return found;
  }

  Element element() {
    Element found{.name = word()};
    for (;;) {
      skip(kBlank);
      const std::string_view key = word();
      skip(" \t\r\n=");
      if (key.empty() || at_ == text_.size() || (text_[at_] != '"' && text_[at_] != '\'')) return found;
      const auto end = text_.find(text_[at_], at_ + 1);
      if (end == std::string_view::npos) return found;
      found.attributes.emplace(key, text_.substr(at_ + 1, end - at_ - 1));
      at_ = end + 1;
    }
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

std::vector<std::string_view> words_between_blanks(std::string_view text) {
  std::vector<std::string_view> words;
  for (std::size_t at = text.find_first_not_of(kBlank); at < text.size();) {
    const auto end = std::min(text.find_first_of(kBlank, at), text.size());
    words.push_back(text.substr(at, end - at));
    at = text.find_first_not_of(kBlank, end);
  }
  return words;
}

/// As a C++ stream reads it, which is how MuJoCo does.
std::optional<double> number_of(std::string_view word) {
  return text::finite_number(word.starts_with('+') ? word.substr(1) : word);
}

void check_mesh(const Element& mesh) {
  const std::vector<std::string_view> numbers = words_between_blanks(mesh.at("vertex"));
  // MuJoCo reads up to the first that is no number.
  const auto end_of_numbers =
      std::ranges::find_if_not(numbers, [](std::string_view word) { return number_of(word).has_value(); });
  const auto vertices = static_cast<std::size_t>(end_of_numbers - numbers.begin()) / 3;
  // Without vertices of its own they come from a file, and MuJoCo refuses faces beside those of the file.
  if (numbers.empty()) return;
  for (const std::string_view word : words_between_blanks(mesh.at("face"))) {
    std::size_t vertex = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), vertex);
    if (error == std::errc{} && end == word.data() + word.size() && vertex < vertices) continue;
    throw BodiesError("mesh '" + std::string(mesh.at("name")) + "': face must have numbers of its " +
                      std::to_string(vertices) + " vertices, from 0 on, got " + std::string(word));
  }
}

double bytes_of_texture(const Element& texture) {
  const auto size = [&](std::string_view key) {
    const std::vector<std::string_view> words = words_between_blanks(texture.at(key));
    return words.empty() ? 0.0 : number_of(words.front()).value_or(0);
  };
  const double width = size("width");
  const double height = size("height");
  constexpr int kSides = 6;
  constexpr int kColors = 3;
  return kColors * width * (texture.at("type") == "2d" ? height : kSides * width);
}

class MjcfCheck {
 public:
  explicit MjcfCheck(const std::string& folder) : folder_(folder) {}

  void check(std::string_view text) {
    ElementReader reader(text);
    while (const std::optional<Element> element = reader.next()) {
      if (element->name == "mesh") check_mesh(*element);
      if (element->name == "texture") check_texture(*element);
      if (element->name == "include") check_included(std::string(element->at("file")));
    }
  }

 private:
  void check_texture(const Element& texture) {
    texture_bytes_ += std::max(0.0, bytes_of_texture(texture));
    if (texture_bytes_ <= kTextureBytesMost) return;
    throw BodiesError("texture '" + std::string(texture.at("name")) +
                      "': all textures must be at most 268435456 bytes together, got " + text::to_text(texture_bytes_));
  }

  void check_included(const std::string& file) {
    // MuJoCo refuses a file that is included twice, so that none includes itself.
    if (!included_.insert(file).second) return;
    std::string content;
    try {
      content = text::read_file((std::filesystem::path(folder_) / file).string());
    } catch (const std::runtime_error&) {
      return;
    }
    check(content);
  }

  std::string folder_;
  std::set<std::string> included_;
  double texture_bytes_ = 0;
};

}  // namespace

void check_mjcf(std::string_view text, const std::string& folder) { MjcfCheck(folder).check(text); }

}  // namespace forcebound::server
