#include "forcebound/tissue/gmsh_file.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <unordered_map>

#include "forcebound/text/file.hpp"
#include "forcebound/text/lines.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::tissue {
namespace {

using Words = std::vector<std::string_view>;
using Tag = std::uint64_t;

constexpr Tag kTetrahedron = 4;
constexpr Tag kQuadraticTetrahedron = 11;

std::string with_unit(Tag count, const std::string& unit) {
  return std::to_string(count) + " " + unit + (count == 1 ? "" : "s");
}

[[noreturn]] void refuse_at(const std::string& name, std::size_t line, const std::string& what) {
  throw std::runtime_error(name + ":" + std::to_string(line) + ": " + what);
}

/// The nodes and tetrahedra as they are read, by the file's own numbers.
class Soup {
 public:
  explicit Soup(std::string name) { soup_.name = std::move(name); }

  [[nodiscard]] bool has_node(Tag tag) const { return index_.contains(tag); }
  void add_node(Tag tag, const scene::Point& position) {
    index_.emplace(tag, soup_.nodes.size());
    soup_.nodes.push_back(position);
  }
  void add_tetrahedron(const std::array<Tag, 4>& tags, std::size_t line) { tetrahedra_.push_back({tags, line}); }

  // Only now, since elements may come before the nodes they name.
  TetrahedralSoup finish() && {
    for (const auto& [tags, line] : tetrahedra_) {
      TetrahedralSoup::Tetrahedron tetrahedron{.line = line};
      for (std::size_t corner = 0; corner < tags.size(); ++corner) {
        const auto found = index_.find(tags[corner]);
        if (found == index_.end()) refuse_node(tags[corner], line);
        tetrahedron.nodes[corner] = found->second;
      }
      soup_.tetrahedra.push_back(tetrahedron);
    }
    return std::move(soup_);
  }

  [[nodiscard]] std::size_t tetrahedra() const { return tetrahedra_.size(); }

 private:
  [[noreturn]] void refuse_node(Tag tag, std::size_t line) const {
    refuse_at(soup_.name, line,
              "node " + std::to_string(tag) + " does not exist: expected one of the " +
                  with_unit(soup_.nodes.size(), "node") + " of this file");
  }

  struct Tagged {
    std::array<Tag, 4> nodes;
    std::size_t line;
  };

  TetrahedralSoup soup_;
  std::unordered_map<Tag, std::size_t> index_;
  std::vector<Tagged> tetrahedra_;
};

class GmshReader {
 public:
  GmshReader(std::istream& text, const std::string& name) : name_(name), lines_(text, name), soup_(name) {}

  TetrahedralSoup read() {
    if (!next()) lines_.refuse("the file is empty: expected $MeshFormat");
    do {
      const std::string_view line = lines_.line();
      if (!line.empty()) section(std::string(line));
    } while (next());
    if (!nodes_read_) lines_.refuse("the file ends without nodes: expected a section $Nodes");
    if (soup_.tetrahedra() == 0) {
      lines_.refuse("the file has no tetrahedra: expected at least one element of type 4 in a section $Elements");
    }
    return std::move(soup_).finish();
  }

 private:
  bool next() {
    if (!lines_.next()) return false;
    ++number_;
    return true;
  }

  // The next line with something on it, which must be there.
  Words row(const std::string& expected) {
    Words words;
    while (words.empty()) {
      if (!next()) lines_.refuse("the file ends here: expected " + expected);
      words = text::split_at_blanks(lines_.line());
    }
    return words;
  }

  [[noreturn]] void refuse_line(const std::string& expected) const {
    constexpr std::size_t kLongest = 60;
    lines_.refuse("'" + text::printable(lines_.line().substr(0, kLongest)) + "': expected " + expected);
  }

  std::vector<Tag> whole_numbers(const Words& words, const std::string& expected) const {
    std::vector<Tag> numbers;
    for (const std::string_view word : words) {
      const auto number = text::whole_number<Tag>(word);
      if (!number) refuse_line(expected);
      numbers.push_back(*number);
    }
    return numbers;
  }

  // Tags of entities, physical groups and partitions, which may be negative (a ghost cell's partition is), say nothing
  // about the shape.
  void leave_out_tags(Words& words, std::size_t from, Tag count, const std::string& expected) const {
    if (from > words.size() || count > words.size() - from) refuse_line(expected);
    const auto first = words.begin() + static_cast<std::ptrdiff_t>(from);
    const auto last = first + static_cast<std::ptrdiff_t>(count);
    for (auto word = first; word != last; ++word) {
      if (!text::whole_number<std::int64_t>(*word)) refuse_line(expected);
    }
    words.erase(first, last);
  }

  // Of version 4.1: dimension, then without the entity two numbers more.
  std::vector<Tag> block_header(const std::string& expected) {
    Words words = row(expected);
    if (words.size() != 4) refuse_line(expected);
    leave_out_tags(words, 1, 1, expected);
    return whole_numbers(words, expected);
  }

  std::vector<Tag> header(std::size_t count, const std::string& expected) {
    const auto numbers = whole_numbers(row(expected), expected);
    if (numbers.size() != count) refuse_line(expected);
    return numbers;
  }

  scene::Point point(const Words& words, std::size_t from, const std::string& expected) const {
    scene::Point position;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto value = from + axis < words.size() ? text::finite_number(words[from + axis]) : std::nullopt;
      if (!value) refuse_line(expected);
      position[static_cast<Eigen::Index>(axis)] = *value;
    }
    return position;
  }

  void section(const std::string& title) {
    if (title == "$MeshFormat") return mesh_format();
    if (title == "$NOD" && version_ == 0) {
      version_ = 1;
      return nodes("$ENDNOD");
    }
    if (title == "$ELM" && version_ == 1) return elements("$ENDELM");
    if (!title.starts_with('$')) refuse_line("a section such as $Nodes");
    if (version_ == 0) refuse_line("$MeshFormat (or $NOD, version 1) first");
    if (title == "$Nodes" && version_ != 1) return version_ == 4 ? node_blocks() : nodes("$EndNodes");
    if (title == "$Elements" && version_ != 1) return version_ == 4 ? element_blocks() : elements("$EndElements");
    pass_over(title);
  }

  void mesh_format() {
    const std::string expected = "version, 0 for ASCII, and 8: 2.2 0 8 or 4.1 0 8";
    const Words words = row(expected);
    if (version_ != 0 || words.size() != 3) refuse_line(expected);
    const auto version = text::finite_number(words[0]);
    if (!version) refuse_line(expected);
    if (words[1] == "1") lines_.refuse("the file is binary: expected ASCII, as Gmsh writes it with Mesh.Binary = 0");
    if (words[1] != "0" || words[2] != "8") refuse_line(expected);
    if (*version >= 2 && *version < 3) version_ = 2;
    if (*version == 4.1) version_ = 4;
    if (version_ == 0) {
      lines_.refuse("version " + std::string(words[0]) +
                    " is not read: expected 2.2 or 4.1 (Gmsh writes them with -format msh22 or msh41)");
    }
    end("$EndMeshFormat");
  }

  void end(const std::string& title) {
    static_cast<void>(row(title));
    if (lines_.line() != title) refuse_line(title);
  }

  void pass_over(const std::string& title) {
    const std::string last = "$End" + title.substr(1);
    do {
      if (!next()) lines_.refuse("the file ends within " + text::printable(title) + ": expected " + last);
    } while (lines_.line() != last);
  }

  void begin_nodes() {
    if (nodes_read_) lines_.refuse("nodes for the second time: expected one section of them");
    nodes_read_ = true;
  }

  void add_node(Tag tag, const scene::Point& position) {
    if (soup_.has_node(tag)) {
      lines_.refuse("node " + std::to_string(tag) + " for the second time: expected each number once");
    }
    soup_.add_node(tag, position);
  }

  void nodes(const std::string& last) {
    begin_nodes();
    const Tag count = header(1, "the number of nodes")[0];
    for (Tag i = 1; i <= count; ++i) {
      const std::string expected =
          "node " + std::to_string(i) + " of " + std::to_string(count) + ": its number and x y z";
      const Words words = row(expected);
      const auto tag = text::whole_number<Tag>(words[0]);
      if (!tag || words.size() != 4) refuse_line(expected);
      add_node(*tag, point(words, 1, expected));
    }
    end(last);
  }

  void elements(const std::string& last) {
    const Tag count = header(1, "the number of elements")[0];
    for (Tag i = 1; i <= count; ++i) {
      const std::string expected = "element " + std::to_string(i) + " of " + std::to_string(count) +
                                   (version_ == 1 ? ": number, type, two tags, number of nodes, nodes"
                                                  : ": number, type, number of tags, tags, nodes");
      Words words = row(expected);
      if (words.size() < 4) refuse_line(expected);
      const Tag tags = version_ == 1 ? 2 : whole_numbers({words[2]}, expected)[0];
      leave_out_tags(words, version_ == 1 ? 2 : 3, tags, expected);
      // Before the nodes: number, type, and in version 1 how many nodes follow; later ones leave that to the type.
      const auto numbers = whole_numbers(words, expected);
      if (version_ == 1 && (numbers.size() < 3 || numbers[2] != numbers.size() - 3)) refuse_line(expected);
      add_element(numbers[1], {numbers.begin() + 3, numbers.end()});
    }
    end(last);
  }

  void add_element(Tag type, const std::vector<Tag>& nodes) {
    if (type == kQuadraticTetrahedron) {
      lines_.refuse("a tetrahedron of second order (type 11): expected linear ones, type 4 (Mesh.ElementOrder = 1)");
    }
    if (type != kTetrahedron) return;
    if (nodes.size() != 4) refuse_line("a tetrahedron's four nodes, got " + std::to_string(nodes.size()));
    soup_.add_tetrahedron({nodes[0], nodes[1], nodes[2], nodes[3]}, number_);
  }

  // What the header of version 4.1 announces, and what then came.
  struct Announced {
    const char* unit;
    std::size_t line;
    Tag blocks, count, smallest, largest;
    Tag seen = 0, least = std::numeric_limits<Tag>::max(), most = 0;

    void add(Tag tag) {
      ++seen;
      least = std::min(least, tag);
      most = std::max(most, tag);
    }
  };

  Announced announced(const char* unit) {
    const std::string expected =
        std::string("number of blocks, number of ") + unit + "s, their smallest and largest number, such as 1 14 1 14";
    const auto numbers = header(4, expected);
    return {unit, number_, numbers[0], numbers[1], numbers[2], numbers[3]};
  }

  void check(const Announced& declared) const {
    if (declared.seen == declared.count &&
        (declared.seen == 0 || (declared.least == declared.smallest && declared.most == declared.largest))) {
      return;
    }
    const auto text_of = [&](Tag count, Tag least, Tag most) {
      return with_unit(count, declared.unit) + " with numbers from " + std::to_string(least) + " to " +
             std::to_string(most);
    };
    refuse_at(name_, declared.line,
              text_of(declared.count, declared.smallest, declared.largest) + ": expected what the blocks below have, " +
                  text_of(declared.seen, declared.least, declared.most));
  }

  void node_blocks() {
    begin_nodes();
    Announced declared = announced("node");
    for (Tag block = 1; block <= declared.blocks; ++block) {
      const std::string expected = "block " + std::to_string(block) + " of " + std::to_string(declared.blocks) +
                                   ": dimension, entity, 0 or 1 (parametric), number of nodes";
      const auto numbers = block_header(expected);
      if (numbers[0] > 3 || numbers[1] > 1) refuse_line(expected);
      node_block(numbers[2], numbers[1] == 1 ? numbers[0] : 0, declared);
    }
    end("$EndNodes");
    check(declared);
  }

  void node_block(Tag count, std::size_t parameters, Announced& declared) {
    std::vector<Tag> tags;
    for (Tag i = 1; i <= count; ++i) {
      const std::string of = std::to_string(i) + " of " + std::to_string(count);
      tags.push_back(header(1, "the number of node " + of + " of this block")[0]);
      declared.add(tags.back());
    }
    for (std::size_t i = 0; i < tags.size(); ++i) {
      const std::string expected = "x y z of node " + std::to_string(tags[i]);
      const Words words = row(expected);
      if (words.size() != 3 + parameters) refuse_line(expected);
      add_node(tags[i], point(words, 0, expected));
    }
  }

  void element_blocks() {
    Announced declared = announced("element");
    for (Tag block = 1; block <= declared.blocks; ++block) {
      const std::string expected = "block " + std::to_string(block) + " of " + std::to_string(declared.blocks) +
                                   ": dimension, entity, type, number of elements";
      const auto numbers = block_header(expected);
      for (Tag i = 1; i <= numbers[2]; ++i) {
        const std::string row_expected =
            "element " + std::to_string(i) + " of " + std::to_string(numbers[2]) + ": number, nodes";
        const auto element = whole_numbers(row(row_expected), row_expected);
        if (element.size() < 2) refuse_line(row_expected);
        declared.add(element[0]);
        add_element(numbers[1], {element.begin() + 1, element.end()});
      }
    }
    end("$EndElements");
    check(declared);
  }

  std::string name_;
  text::LineReader lines_;
  Soup soup_;
  std::size_t number_ = 0;  // of the line
  int version_ = 0;
  bool nodes_read_ = false;
};

}  // namespace

TetrahedralSoup read_gmsh(std::istream& text, const std::string& name) { return GmshReader(text, name).read(); }

TetrahedralSoup load_gmsh(const std::string& path) {
  std::istringstream text(text::read_file(path));
  return read_gmsh(text, path);
}

}  // namespace forcebound::tissue
