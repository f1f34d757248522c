#include "forcebound/text/table.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "forcebound/text/printable.hpp"

namespace forcebound::text {
namespace {

constexpr std::size_t kIndent = 2;
constexpr std::size_t kGap = 2;

std::string aligned(std::string_view cell, std::size_t width, Table::Align align) {
  const std::string blanks(width - std::min(width, columns_of(cell)), ' ');
  return align == Table::Align::left ? std::string(cell) + blanks : blanks + std::string(cell);
}

void end_line(std::string& out) {
  while (out.ends_with(' ')) out.pop_back();
  out += '\n';
}

std::string with_unit(const Table::Column& column) {
  if (column.unit.empty()) return column.head;
  return column.head + (column.head.empty() ? "[" : " [") + column.unit + "]";
}

std::string csv_cell(const std::string& cell) {
  if (cell.find_first_of(",\"\n") == std::string::npos) return cell;
  std::string quoted = "\"";
  for (const char c : cell) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

std::string markdown_cell(const std::string& cell) {
  std::string escaped;
  for (const char c : cell) escaped += c == '|' ? std::string("\\|") : std::string(1, c);
  return escaped;
}

}  // namespace

Table::Table(std::vector<Column> columns) : columns_(std::move(columns)) {
  if (columns_.empty()) throw std::invalid_argument("a table needs a column");
  columns_.front().align = Align::left;
  for (Column& column : columns_) make_printable(column.head);
}

void Table::add(std::vector<Cell> row) {
  if (row.size() != columns_.size()) {
    throw std::invalid_argument("a row of " + std::to_string(row.size()) + " cells in a table of " +
                                std::to_string(columns_.size()) + " columns");
  }
  for (Cell& cell : row) make_printable(cell.text);
  rows_.push_back({Row::Kind::cells, std::move(row)});
}

void Table::add_remark(const std::string& name, const std::string& words) {
  rows_.push_back({Row::Kind::remark, {printable(name)}, printable(words)});
}

void Table::add_heading(const std::string& words) { rows_.push_back({Row::Kind::heading, {}, printable(words)}); }

Table::Cell Table::cell_of(const Row& row, std::size_t column) {
  if (row.kind == Row::Kind::heading) return column == 0 ? Cell(row.words, Mark::best) : Cell("");
  if (row.kind == Row::Kind::remark && column > 0) return column == 1 ? row.words.c_str() : "";
  return row.cells[column];
}

std::string Table::to_text(Colour colour, std::size_t width) const {
  std::vector<std::size_t> widths;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const std::string& unit = columns_[i].unit;
    std::size_t widest = std::max(columns_of(columns_[i].head), unit.empty() ? 0 : columns_of(unit) + 2);
    for (const Row& row : rows_) {
      if (i < row.cells.size()) widest = std::max(widest, columns_of(row.cells[i].text));
    }
    widths.push_back(widest);
  }
  std::string out;
  for (std::size_t begin = 1; begin <= columns_.size();) {
    std::size_t used = kIndent + widths.front();
    std::size_t end = begin;
    // One column at least, however narrow the page.
    while (end < columns_.size() && (end == begin || used + kGap + widths[end] <= width)) {
      used += kGap + widths[end++];
    }
    append_columns(out, begin, end, widths, colour);
    if (end == columns_.size()) break;
    begin = end;
  }
  return out;
}

/// The names and the columns from `begin` to before `end`.
void Table::append_columns(std::string& out, std::size_t begin, std::size_t end, const std::vector<std::size_t>& widths,
                           Colour colour) const {
  const auto line = [&](auto cell) {
    out += std::string(kIndent, ' ');
    for (std::size_t i = 0; i < end; i = i == 0 ? begin : i + 1)
      out += (i == 0 ? "" : std::string(kGap, ' ')) + cell(i);
    end_line(out);
  };
  const auto in_column = [&](std::string_view text, std::size_t i) {
    return aligned(text, widths[i], columns_[i].align);
  };
  line([&](std::size_t i) { return in_column(columns_[i].head, i); });
  if (std::any_of(columns_.begin(), columns_.end(), [](const Column& column) { return !column.unit.empty(); })) {
    line([&](std::size_t i) {
      const std::string& unit = columns_[i].unit;
      return in_column(unit.empty() ? "" : "[" + unit + "]", i);
    });
  }
  for (const Row& row : rows_) {
    if (row.kind == Row::Kind::remark) {
      const std::string name = std::string(kIndent, ' ') + in_column(row.cells.front().text, 0);
      if (begin == 1) out += wrapped(name + std::string(kGap, ' ') + row.words, 2 * kIndent) + '\n';
      continue;
    }
    if (row.kind == Row::Kind::heading) {
      out += wrapped(std::string(kIndent, ' ') + row.words, 2 * kIndent) + '\n';
      continue;
    }
    line([&](std::size_t i) {
      const std::string cell = in_column(row.cells[i].text, i);
      return row.cells[i].mark == Mark::alarm ? red(cell, colour) : cell;
    });
  }
}

std::string Table::to_markdown() const {
  std::string out = "|";
  std::string rule = "|";
  for (const Column& column : columns_) {
    out += ' ' + markdown_cell(with_unit(column)) + " |";
    rule += "---|";
  }
  out += '\n' + rule + '\n';
  for (const Row& row : rows_) {
    out += '|';
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const Cell cell = cell_of(row, i);
      const char* const bold = cell.mark == Mark::none ? "" : "**";
      if (!cell.text.empty()) out.append(" ").append(bold).append(markdown_cell(cell.text)).append(bold);
      out += " |";
    }
    out += '\n';
  }
  return out;
}

std::string Table::to_csv() const {
  std::string out;
  for (std::size_t i = 0; i < columns_.size(); ++i) out += (i == 0 ? "" : ",") + csv_cell(with_unit(columns_[i]));
  out += '\n';
  for (const Row& row : rows_) {
    if (row.kind == Row::Kind::heading) continue;
    for (std::size_t i = 0; i < columns_.size(); ++i) out += (i == 0 ? "" : ",") + csv_cell(cell_of(row, i).text);
    out += '\n';
  }
  return out;
}

}  // namespace forcebound::text
