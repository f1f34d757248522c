#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "forcebound/text/terminal.hpp"

namespace forcebound::text {

/// Rows of cells under heads, to be printed as aligned text, as Markdown or as comma-separated values.
///
///     Table table({{"law"}, {"least P", "J"}, {"remark", "", Table::Align::left}});
///     table.add({"none", {"-0.651", Table::Mark::alarm}, "gives energy away"});
///     std::cout << table.to_text();
///
/// Cells are UTF-8 text in one line, which may come from a file: see `printable`. The first column names the rows and
/// is aligned left.
class Table {
 public:
  enum class Align : std::uint8_t { left, right };

  struct Column {
    std::string head;
    std::string unit = {};  ///< printed in brackets: below the head in text, behind it in Markdown and CSV
    Align align = Align::right;
  };

  /// How a cell stands out: an alarm is red on a terminal that wants colours; both are bold in Markdown.
  enum class Mark : std::uint8_t { none, best, alarm };

  struct Cell {
    Cell(std::string words, Mark marked = Mark::none) : text(std::move(words)), mark(marked) {}  // NOLINT: converts
    Cell(const char* words) : text(words) {}                                                     // NOLINT: converts
    std::string text;
    Mark mark = Mark::none;
  };

  /// @throws std::invalid_argument without columns
  explicit Table(std::vector<Column> columns);

  /// @throws std::invalid_argument unless there is a cell for each column
  void add(std::vector<Cell> row);

  /// A row of which there is only something to say, such as why it has no numbers. Markdown and CSV have it as the
  /// name and the words in the second column.
  void add_remark(const std::string& name, const std::string& words);

  /// A line above the rows that follow, as wide as it likes; a bold row in Markdown, not in CSV.
  void add_heading(const std::string& words);

  /// At most `width` characters wide: columns that do not fit follow below, with the names again. Every line is
  /// indented by two blanks; the last ends with a line feed.
  [[nodiscard]] std::string to_text(Colour colour = Colour::none, std::size_t width = kColumns) const;

  [[nodiscard]] std::string to_markdown() const;

  /// As RFC 4180 has it, but with line feeds alone.
  [[nodiscard]] std::string to_csv() const;

 private:
  struct Row {
    enum class Kind : std::uint8_t { cells, remark, heading };
    Kind kind;
    std::vector<Cell> cells;  ///< of a remark the name alone, of a heading none
    std::string words{};      ///< of a remark or heading
  };

  /// What Markdown and CSV have in a column.
  [[nodiscard]] static Cell cell_of(const Row& row, std::size_t column);

  void append_columns(std::string& out, std::size_t begin, std::size_t end, const std::vector<std::size_t>& widths,
                      Colour colour) const;

  std::vector<Column> columns_;
  std::vector<Row> rows_;
};

}  // namespace forcebound::text
